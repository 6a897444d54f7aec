// Momentum of one group of rows: how far ahead of its last two iterates p, q the next sweep of W starts, y = p + beta (p - q).
//
// beta = (t - 1)/(t + 1/2) with t growing by 1/2 a sweep (Nesterov 1983 in the form of Chambolle & Dossal 2015, J. Optim. Theory Appl. 166, eq. 5,
// a = 2). Where a sweep turns back against the momentum of the group, t is halved, and every third time begins anew. Each group for itself,
// unlike the bodies' form, whose velocities ask for one beta: a few contacts whose friction makes them swing then cost the others nothing.
// Measured in sweeps to 1e-4 and 1e-6 with groups in five ways, Siconos's problem of 7002 contacts: plain 525 and 1360; one momentum for all
// 1245 and 1560; always anew 115 and 315; always halved 105 and 210, or caught in a swing at 1e-4 in two of the five; as here 90 to 185 and 225
// to 515. Dense packings of 4000 disks to 1e-4: 1.0 to 1.4 times the sweeps of one momentum for all; lattices with walls 0.3 to 1.1 times.
#pragma once

#include <algorithm>

namespace cd {

class RowMomentum {
    public:
	// The beta after a sweep; against: (y - p+) . (p+ - p) of the group, p+ after the sweep.
	double next(double against)
	{
		const bool turned = against > 0;
		turns += turned;
		const double shorter = turns % 3 == 0 ? 1 : std::max(1., 0.5 * t);
		t = turned ? shorter : t + 0.5;
		return std::min(largest, (t - 1) / (t + 0.5));
	}

    private:
	static constexpr double largest = 0.995;
	double t = 1;
	unsigned turns = 0;
};

} // namespace cd
