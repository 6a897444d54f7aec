// Momentum for sweeps over W, for each group of rows separately. The next sweep starts from y = p + beta (p - q); q, p are the last two iterates.
//
// beta = (t - 1)/(t + 1/2), and t grows by 1/2 a sweep (Nesterov 1983 in the form of Chambolle & Dossal 2015, J. Optim. Theory Appl. 166, a = 2). If
// a sweep moves a group back against its momentum, t of the group is halved, and every third time reset to 1. Sweeps in the velocities of bodies need
// one beta for all; here each group has its own, so that a few contacts that oscillate by friction do not slow the others. If the sum of all changes
// does not decrease, beta is capped in the groups whose own changes do not. Measured on Siconos's problem of 7002 contacts in eight orders: 102 to
// 154 sweeps to 1e-4; one momentum for all needs 440 to 1560, plain sweeps 510 to 630. Resetting every time is as good there, but slower in dense
// packings. Halving every time gets caught in oscillations.
#pragma once

#include "row_group.hpp"

#include <vector>

namespace cd {

class RowMomentum {
    public:
	void begin(std::size_t groups);

	// Call after a group has made a step.
	void add(std::size_t group, const GroupStep&);
	// Call after all groups have made a step.
	void watch(const std::vector<GroupStep>&);

	const std::vector<double>& betas() const { return beta; }

    private:
	struct Group {
		double t = 1, cap = 0.98;
		int turns = 0;
		double sum = 0, lastMean = 0; // of the changes: sum in this window of sweeps, mean in the one before
	};
	void judge(int sweeps);

	std::vector<Group> groups;
	std::vector<double> beta;
	double sum = 0, lastMean = 0; // the same for all groups together
	int made = 0, windowStart = 0, windowEnd = 0;
};

} // namespace cd
