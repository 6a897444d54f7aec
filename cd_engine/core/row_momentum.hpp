// Momentum for sweeps over W, each group of rows for itself: the next sweep starts from y = p + beta (p - q), q, p the last two iterates.
//
// beta = (t - 1)/(t + 1/2) with t growing by 1/2 a sweep (Nesterov 1983 in the form of Chambolle & Dossal 2015, J. Optim. Theory Appl. 166,
// a = 2). Where a sweep turns back against the momentum of a group its t is halved, and every third time begins anew. Unlike in the velocities
// of bodies, nothing asks for one beta: a few contacts that friction lets swing cost the others nothing. Where all changes together do not
// decrease, beta is capped for the groups whose own do not.
// Measured, Siconos's problem of 7002 contacts in eight orders: 102 to 154 sweeps to 1e-4, where one momentum for all needs 440 to 1560 and plain
// sweeps 510 to 630. Always anew instead of halved is as good there and slower in dense packings; always halved is caught in swings.
#pragma once

#include "row_group.hpp"

#include <vector>

namespace cd {

class RowMomentum {
    public:
	void begin(std::size_t groups);

	// After a group made a step.
	void add(std::size_t group, const GroupStep&);
	// After all groups did.
	void watch(const std::vector<GroupStep>&);

	const std::vector<double>& betas() const { return beta; }

    private:
	struct Group {
		double t = 1, cap = 0.98;
		int turns = 0;
		double sum = 0, lastMean = 0; // of the changes in this window of sweeps, and in the one before
	};
	void judge(int sweeps);

	std::vector<Group> groups;
	std::vector<double> beta;
	double sum = 0, lastMean = 0; // the same of all groups together
	int made = 0, windowStart = 0, windowEnd = 0;
};

} // namespace cd
