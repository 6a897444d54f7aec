// The solver's tolerance in the next step, from what the last step has shown of the motion ("unrest").
#pragma once

#include "step/settings.hpp"

#include <algorithm>

namespace cd {

struct StepTolerance {
	bool rigid; // whether the contacts have no stiffness
	double asked; // of packings at rest; with stiffnesses, as a share of the motion of a step
	double flow; // the largest, of rigid contacts

	// The smallest: with stiffnesses that of contacts in which nothing moves.
	double least() const
	{
		constexpr double leastMotion = 1e-8, finest = 1e-10;
		return rigid ? asked : std::max(finest, leastMotion * asked);
	}

	// That of the test of rest.
	double ofRest() const { return rigid ? asked : 100 * least(); }

	// The largest power of ten, within its limits, that is not above `unrest`. An error changes velocities by about the tolerance times
	// W_nn |p|. Beside the velocities of a flow this may be little where it is much beside those of a packing at rest. The energy that a step
	// dissipates, a mean of p u, over W_nn |p|^2 tells them apart: with 500 disks it is 2e-4 to 0.2 while they flow out of a silo, in a drum or
	// in a collapse. At rest, where errors alone move the disks, it is mostly at most half the tolerance, so that the tolerance falls. Where
	// contacts slide by errors it can be more: 3.5 times the error in a silo of 300 disks whose forces had been forgotten. Powers of ten, because
	// the round-off of `unrest` may depend on the way in which a step is made, and must not change the tolerance.
	double next(double unrest) const
	{
		double next = rigid ? flow : asked;
		if (rigid)
			while (next > asked && unrest < next)
				next = next > 11 * asked ? next / 10 : asked;
		else
			while (next > least() && unrest * asked < next)
				next /= 10;
		return std::max(next, least());
	}

	// The unrest after a step, from that before it. A step after one with a larger tolerance begins with a poor guess and takes many sweeps, so
	// the tolerance falls only after some steps at rest.
	double unrest(double before, const StepReport& report) const
	{
		const double fades = rigid ? 0.9 : 0.5; // in a step; tenfold in 22, or in 4
		const double now = report.solver.work > 0 ? (rigid ? report.dissipated : report.work) / report.solver.work : 0;
		return std::max(now, fades * before);
	}
};

} // namespace cd
