// Momentum for sweeps over W, for each group of rows separately. The next sweep starts from y = p + beta (p - q); q, p are the last two iterates.
//
// beta = (t - 1)/(t + 1/2), and t grows by 1/2 a sweep (Nesterov 1983 in the form of Chambolle & Dossal 2015, J. Optim. Theory Appl. 166, a = 2). If
// a sweep moves a group back against its momentum, t of the group is halved, and every third time reset to 1. Sweeps in the velocities of bodies need
// one beta for all; here each group has its own, so that a few contacts that oscillate by friction do not slow the others. If the sum of all changes
// does not decrease, beta is capped in the groups whose own changes do not. Measured on Siconos's problem of 7002 contacts in eight orders: 102 to
// 154 sweeps to 1e-4; one momentum for all needs 440 to 1560, plain sweeps 510 to 630. Resetting every time is as good there, but slower in dense
// packings. Halving every time gets caught in oscillations.
#pragma once

#include "kernels/kernels.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace cd {

class RowMomentum {
    public:
	void begin(std::size_t count)
	{
		groups.assign(count, {});
		betas.assign(count, 0);
		sum = lastMean = 0;
		made = windowStart = 0;
		windowEnd = window();
	}

	// Call after a group has made a step.
	void afterStep(std::size_t group, const AheadReport& step)
	{
		Group& g = groups[group];
		if (step.against > 0)
			g.t = ++g.turns % 3 == 0 ? 1 : std::max(1., 0.5 * g.t);
		else
			g.t += 0.5;
		betas[group] = std::min(g.cap, (g.t - 1) / (g.t + 0.5));
	}

	// Call after all groups have made a step.
	void afterSweep(const std::vector<AheadReport>& steps)
	{
		assert(steps.size() == groups.size());
		double total = 0;
		for (std::size_t i = 0; i < groups.size(); i++) {
			total += steps[i].change;
			groups[i].sum += std::sqrt(steps[i].change);
		}
		sum += std::sqrt(total);
		if (++made == windowEnd)
			endWindow();
	}

	std::vector<double> betas; // of each group

    private:
	static constexpr double largest = 0.995; // largest beta

	struct Group {
		double t = 1, cap = 0.98;
		int turns = 0;
		double sum = 0, lastMean = 0; // of the changes: sum in this window of sweeps, mean in the one before
	};

	// Windows grow with the sweeps made. Slow convergence, by a power of the number of sweeps, then still shows from one window to the next;
	// oscillations show no decrease.
	int window() const { return std::max(20, made / 4); }

	void endWindow()
	{
		const int sweeps = made - windowStart;
		const double mean = sum / sweeps;
		const bool swings = lastMean > 0 && mean > lastMean;
		lastMean = mean;
		sum = 0;
		for (Group& g : groups) {
			const double own = g.sum / sweeps;
			g.cap = swings && own > g.lastMean ? std::max(0., 1 - 3 * (1 - g.cap)) : std::min(largest, 1 - 0.8 * (1 - g.cap));
			g.lastMean = own;
			g.sum = 0;
		}
		windowStart = made;
		windowEnd = made + window();
	}

	std::vector<Group> groups;
	double sum = 0, lastMean = 0; // the same for all groups together
	int made = 0, windowStart = 0, windowEnd = 0;
};

} // namespace cd
