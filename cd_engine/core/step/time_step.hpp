// One step of the Moreau-Jean scheme.
#pragma once

#include "step/account_in_space.hpp"
#include "step/overlap_correction.hpp"
#include "step/rolling_resistance.hpp"

namespace cd {

template <class Space> class TimeStep {
	using Account = cd::Account<Space>;
	using ContactSystem = cd::ContactSystem<Space>;
	using Sleepers = cd::Sleepers<Space>;
	using Stillness = cd::Stillness<Space>;
	using StepSettings = cd::StepSettings<Space>;
	using StepView = cd::StepView<Space>;
	using World = WorldOf<Space>;

    public:
	// Moves the bodies by dt: q_m = q + h/2 v;  M (v' - v) = h F + H(q_m) p;  q' = q_m + h/2 v'  (theta = 1/2; Jean 1999, section 4). Only the
	// pairs in world.awake may touch.
	// With stiffnesses (World::stiffnesses) it is backward Euler instead, since theta = 1/2 rings: M (v' - v) = h F + H(q) p; q' = q + h v'
	// (theta = 1). A force of a spring is then the one at q', to first order. Gaps of either sign count, and of the following only the fourth
	// point holds.
	// - Gaps: contact is required at the mid-configurations, which are a step apart. So u_n + max(gap, 0)/h >= 0 keeps the next one from
	//   overlapping, to first order: the gap may close within the step, but not become negative. If the face of a box turns, the change of the
	//   gap by this is added, so that it meets disks like one that only translates.
	// - Overlaps are kept from growing; overlapCorrection moves bodies apart after the step. With gapCorrection b > 0 they must shrink,
	//   u_n + b (gap + a)/h >= 0 (b = 1: to the allowed overlap a within the step), by a velocity that stays and is not dissipated. In a packing
	//   at rest such velocities contradict each other; the allowed overlap prevents them from moving the packing for ever.
	// - Only velocities just set from outside, or left by an unsolved step, can move the centre of a disk into or through a boundary in a step's
	//   first half, before contact is looked for. Such a disk stops at the face.
	// - Restitution e > 0: a contact that is closed, or that the velocities before the step would close within it, takes u_n' >= -e u_n instead,
	//   or what its overlap demands if that is more (rebounds.hpp). A contact that only other contacts' impulses close is left to the next step
	//   and overlaps by up to its closing velocity times h.
	// - No body is moved in two cases: the solver met a number that is not finite, or, without restitution, impulses made a body so fast that it
	//   may reach others that are not in the list of pairs (World::listed). In the second case report.outran is not empty, and the step must be
	//   repeated with a longer list.
	StepReport operator()(World&, const StepSettings&);

	// The problem that such a step would give to its solver, with the free velocities. The world is not moved.
	const ContactSystem& assemble(World&, const StepSettings&);

	// Of the last step: the pairs that had a contact.
	const std::vector<int32_t>& pairs() const { return finder.pairs(); }
	// Finds the places and overlaps of the last step of dt anew, up to round-off, if a later step was given up and has left its own.
	void locateBack(const World&, double dt);
	// Where a pair that carries a force touched when a step last located it.
	auto touchOf(const World& world, std::size_t pair) const { return finder.touchOf(world, pair, motion); }
	double gapOf(const World& world, std::size_t pair) const { return finder.gap(world, pair); } // [m]
	// The pairs whose reference overlap ended in the last step.
	const std::vector<int32_t>& overlapsForgotten() const { return finder.separated(); }
	// The impulses of all contacts on the bodies in the last step, those of sleeping islands included: [N s], [N s], [N m s]. They are summed
	// when somebody asks, so before the next step begins. world: as that step has left it.
	const std::vector<typename Account::Impulse>& impulsesOn(const World& world)
	{
		return account.impulses(world, finder, motion, system.contacts, rolling.rows());
	}
	// Whether nobody has read a row of the last step's contacts, so that none was made.
	bool sparedRows() const { return account.sparedRows(); }

	// To be updated before the pairs are read, and told which parts of the scene have changed.
	Sleepers sleepers;
	// What a run knows of rest from step to step.
	Rest rest;
	// Share the work of a step, and of what is done before and after it.
	Threads threads;

    private:
	// How exactly and how long a step may still be solved.
	struct Goal {
		double tolerance;
		int most; // iterations of all solutions together
		int first; // iterations that the first solution has taken
	};

	void prepare(World&, const StepView&);
	bool attempt(World&, const StepView&, StepReport&);
	Status solve(const StepView&, const Stillness&, Goal&, StepReport&);

	Workspace memory; // of the solvers
	ContactSystem system; // the motion sets its bodies, the builder its contacts, and the solver solves it
	BodyMotion<Space> motion;
	ContactFinder<Space> finder;
	ProblemBuilder<Space> builder;
	IslandSolver<Space> solveIslands;
	RollingResistance<Space> rolling;
	Account account;
	OverlapCorrection<Space> correction;
};

} // namespace cd
