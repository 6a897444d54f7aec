// One step of the Moreau-Jean scheme.
#pragma once

#include "island_solver.hpp"
#include "rebounds.hpp"
#include "sleepers.hpp"
#include "threads.hpp"
#include "world.hpp"

#include <array>

namespace cd {

struct StepSettings {
	double dt = 0; // [s]
	double restitution = 0; // Newton's e, normal direction
	double gapCorrection = 0; // share of an overlap beyond the reference that the step pushes out
	int threads = 1; // that share the work of a large scene; the bits are the same with any number
	bool reduce = true; // solve islands of contacts apart (island_solver.hpp)
	int trial = 0; // sweeps that slow islands may take to prove their rest (sleep.hpp)
	const std::vector<int>* loadsBefore = nullptr; // for that: the loads of the step before
	bool notesLoads = false; // for the step after
	Solver solve = nullptr;
	SolverSettings solver;
};

struct StepReport {
	SolverReport solver;
	Effort effort;
	std::array<int32_t, 2> unsolvable { -1, -1 }; // bodies of the contact that speaks most against a solution
	int contacts = 0; // that the solver was given
	int slidingContacts = 0; // loaded, mu > 0, |p_t| at mu p_n
	int loadedContacts = 0;
	double maxPenetration = 0; // [m], beyond the reference overlaps, at the mid-configuration
	double dissipated = 0; // [J] in this step
	double solveSeconds = 0; // spent in the solver
	std::vector<double> outran; // of each body: how far from its place before the step pairs have to be listed [m]; empty: they were
	bool idle = false; // nothing moves and all contacts sleep: under the same forces the next step leaves everything as it is, too
};

// Of all disks [m]; infinite if there is none.
double smallestRadius(const World&);

// How far from its outline a body may meet others in a step [m], at most. way: what it goes in the step (wayOf) [m]. A pair becomes a contact only
// if its gap is at most the sum of the reaches of both bodies.
double reachOf(const Body&, double way);

class TimeStep {
    public:
	// Moves the bodies by dt, of which the pairs in world.awake may touch: q_m = q + h/2 v;  M (v' - v) = h F + H(q_m) p;  q' = q_m + h/2 v'
	// (theta = 1/2; Jean 1999, section 4). Contact is required at the mid-configurations, which are a step apart, so u_n + max(gap, 0)/h >= 0
	// keeps the next one from overlapping to first order: the gap may close within the step but not be crossed. Where the face of a box turns,
	// what that changes in the gap within the step is added, so that it meets disks as one does that only moves. An overlap is kept from growing;
	// with gapCorrection b > 0 it has to shrink, u_n + b gap/h >= 0 (b = 1: within the step), by a velocity that stays and is not dissipated.
	// Only velocities that somebody has just given, or that a step has left unsolved, can take the centre of a disk into a boundary, or through
	// it, before contact is looked at, in the first half of a step: its way ends at the face then. Restitution e > 0: a contact that is closed,
	// or that the velocities before the step would close within it, takes u_n' >= -e u_n instead, or what its overlap asks for where that is more
	// (rebounds.hpp); one that only other contacts' impulses close is left to the next step, overlapping by up to their velocity times h.
	// No body is moved in two cases. The solver has met a number that is not finite. Or impulses made a body so fast that it may reach others
	// that are not in the list of pairs (World::listed); report.outran is not empty then, and the step has to be made again with a longer list.
	StepReport operator()(World&, const StepSettings&);

	// The problem such a step would hand to its solver, with the velocities free of impulses; the world is not moved. Pairs are contacts whose
	// bodies may close their gap at their present velocities (mayClose). If the solution lets one cross its gap that was left out, the step is
	// solved again with that and all others that the new velocities can close.
	const ContactSystem& assemble(World&, const StepSettings&);

	// Of the last step: the pairs that had a contact, and where a pair that was looked at touches, or would.
	const std::vector<int32_t>& pairs() const { return rowPair; }
	const Touch& touchOf(int32_t pair) const { return touches[pair]; }
	// The pairs whose reference overlap ended in the last step.
	const std::vector<int32_t>& overlapsForgotten() const { return forgotten; }
	// Fingerprints of the loads of the bodies, if they were to be noted.
	const std::vector<int>& loads() const { return fingerprints; }
	// Of all contacts on every body, those left out included.
	const std::array<double, 3>& impulseOn(std::size_t body) const { return impulses[body]; }

	// Whether the last step had to look at pairs that were not awake before it.
	bool woke() const { return wokeSome; }

	// What is asked before the pairs are read, and told what of the scene a step has changed.
	Sleepers sleepers;
	// Share the work of a step, and what is done before and after it.
	Threads threads;

    private:
	void freeVelocities(const World&, double dt);
	void noteLoads(const World&, const StepSettings&);
	void locateBodies(const World&, double dt);
	void meanVelocities(const World&, double dt, bool solved);
	double relativeSpeed(const Pair&, const World&, const double* a, const double* b) const;
	bool mayClose(const Pair&, const World&, double gap, double dt) const;
	struct Seen;
	Seen look(const World&, const StepSettings&, Seen* parts);
	void findContacts(World&, const StepSettings&);
	bool isThrough(const Pair&, const World&, const Touch&, double dt, Foot& face) const;
	void stopAtFaces(const World&, double dt);
	double turning(const Pair&, const World&, const Touch&, double gap, double dt) const;
	bool crosses(std::size_t pair, const World&, double dt) const;
	void prefetchBodies(const Pair&) const;
	void resizeRows(std::size_t count, const StepSettings&);
	void fillRow(std::size_t row, const World&, std::size_t pair, const StepSettings&);
	bool closes(const World&, const Pair&, const Touch&, double gap, double dt) const;
	bool outruns(const World&, double dt, StepReport&);
	bool within(std::size_t pair, const World&, double dt) const;
	bool anyViolated(const World&, const StepSettings&);
	bool addViolated(World&, const StepSettings&);
	bool attempt(World&, const StepSettings&, StepReport&);
	void firstGuess(const World&);
	bool lowerRebounds(const StepSettings&, const StepReport&);
	static bool end(StepReport&);
	void finishContacts(World&, StepReport&);
	SleepingIsland* asleepAt(const ContactRow&);
	struct Account;
	Account account(World&, double dissipated, std::size_t from, std::size_t to);
	struct Share;
	Share share(std::size_t row, const Pair&) const;
	void give(const Share&);
	void push(const Share&, SleepingIsland&);
	void pushAll();
	void finishSleepers(StepReport&);
	bool finishBodies(World&, double dt);

	// What a part of the pairs that a step looks at has shown.
	struct Seen {
		std::size_t contacts = 0, first = 0; // first: row of the first
		bool through = false; // a disk is to be taken back to a face
		bool apart = false; // a reference overlap has ended
		double deepest = 0, narrowest = endless; // overlap beyond the reference one, gap that was left out [m]
	};

	struct Mean {
		double v[3]; // of the velocities before and after the step
		double speed; // after the step, of the fastest point of its outline, for how far it may go [m/s]
	};

	IslandSolver solveIslands;
	Rebounds rebounds;
	ContactSystem system;
	std::vector<double> before; // velocities of the bodies before the step
	std::vector<double> free; // with restitution: those that forces alone would leave
	std::vector<int> fingerprints; // of what forces add to them, if anybody wants to know
	std::vector<Place> places; // of the bodies at the mid-configuration
	std::vector<Mean> means; // of the bodies
	std::vector<double> ways; // that the bodies go in the step without impulses, those that turn with their farthest point [m]
	struct Shift {
		int32_t body;
		double x, y; // [m]
	};
	std::vector<Shift> shifts; // of disks that were stopped at a face, at the mid-configuration
	double narrowest = 0; // gap that was left out [m]
	double fastest = 0; // speed of a body after the step [m/s]
	std::vector<int32_t> forgotten;
	double deepest = 0; // overlap beyond the reference one [m]
	std::size_t rows = 0; // contacts of the system, while it is made
	bool wokeSome = false;
	std::size_t assembled = 0; // of these before any was taken back
	std::vector<int32_t> rowPair; // the pair of each contact of the system
	std::vector<char> solved; // whether a pair has a contact in the system
	std::vector<double> gaps; // of the pairs looked at [m]
	std::vector<Touch> touches; // of the same
	struct Share { // of a contact's impulse
		int32_t a, b; // bodies; a < 0: none
		double x, y, turnA, turnB; // on b, and about the centres of both
	};
	std::vector<Share> shares; // of the contacts, where several threads work or something sleeps
	std::vector<std::array<double, 3>> impulses; // on the bodies [N s], [N s], [N m s]
};

} // namespace cd
