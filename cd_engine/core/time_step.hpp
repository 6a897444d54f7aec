// One step of the Moreau-Jean scheme.
#pragma once

#include "solver.hpp"
#include "world.hpp"

namespace cd {

struct StepSettings {
	double dt = 0; // [s]
	double restitution = 0; // Newton's e, normal direction
	double gapCorrection = 0; // share of an overlap beyond the reference that the step pushes out
	Solver solve = nullptr;
	SolverSettings solver;
};

struct StepReport {
	SolverReport solver;
	int contacts = 0; // that the solver was given
	int slidingContacts = 0; // loaded, mu > 0, |p_t| at mu p_n
	int loadedContacts = 0;
	double maxPenetration = 0; // [m], beyond the reference overlaps, at the mid-configuration
	double dissipated = 0; // [J] in this step
	int overlapsForgotten = 0; // pairs whose reference overlap ended
	double solveSeconds = 0; // spent in the solver
};

// Of the disks [m]; infinite if there are none.
double smallestRadius(const World&);

// Gaps wider than this [m] are left out of the problem of a step at first: four times the way of the fastest body under its external
// forces, and a thousandth of the smallest disk. A pair left out that the solution would close is taken back and the step solved again.
double reach(const World&, double dt);

// The way [m] of the fastest body in a step, under its external forces.
double fastestWay(const World&, double dt);

class TimeStep {
    public:
	// Moves the bodies by dt: q_m = q + h/2 v;  M (v' - v) = h F + H(q_m) p;  q' = q_m + h/2 v'  (theta = 1/2; Jean 1999, section 4).
	// Contact is required at the mid-configurations, which are a step apart, so u_n + max(gap, 0)/h >= 0 keeps the next one from
	// overlapping to first order: the gap may close within the step but not be crossed. An overlap is kept from growing; with
	// gapCorrection b > 0 it has to shrink, u_n + b gap/h >= 0 (b = 1: within the step), by a velocity that stays and is not dissipated.
	// Restitution e > 0: a contact that the velocities before the step would close within it takes u_n' >= -e u_n instead, or what its
	// overlap asks for where that is more; one that only other contacts' impulses close is left to the next step, overlapping by up to their
	// velocity times h.
	StepReport operator()(World&, const StepSettings&);

	// The problem such a step would hand to its solver, with the velocities free of impulses; the world is not moved.
	const ContactSystem& assemble(World&, const StepSettings&);

    private:
	void freeVelocities(const World&, double dt);
	void fillRow(ContactRow&, const World&, size_t pair, const StepSettings&);
	bool closes(const World&, const Pair&, double dt) const;
	bool addViolated(const World&, const StepSettings&);
	void finish(World&, const StepSettings&, StepReport&);

	ContactSystem system;
	std::vector<Place> places; // of the bodies at the mid-configuration
	int forgotten = 0;
	std::vector<int32_t> rowPair; // the pair of each contact of the system
	std::vector<char> solved; // whether a pair has a contact in the system
};

} // namespace cd
