// Solves only what needs to be solved in a step: nothing for bodies without contacts, a lone contact in closed form, an island at rest not at all,
// and every other island of contacts until it has reached the tolerance by itself.
//
// partition.hpp defines the islands. The error e is a ratio of two 2-norms. If |difference_k| <= tolerance |p_k| in every island, then
//   sum |difference_k|^2 <= tolerance^2 sum |p_k|^2,
// and the whole is within the tolerance, too. The reverse is not true: if an island of sand and an island of rocks are solved as one system,
// errors may remain that are large for the sand, because e is relative to all impulses. Islands are therefore swept together, which fills the groups
// of eight, but those that miss their own tolerance then continue without the others. A step counts as solved if its whole error is within the
// tolerance, even if some island missed its own.
//
// Islands that are proven to be at rest sleep until something changes (island_sleep.cpp).
#pragma once

#include "graph/graph.hpp"
#include "error/error.hpp"
#include "islands/sleepers.hpp"
#include "solvers/solvers.hpp"

namespace cd {

// What a step had to solve.
struct Effort {
	int unknowns = 0; // unknown velocities: three for a free disk, none for an immobile body or, with islands, for one without contacts
	int islands = 0;
	int resting = 0; // islands whose first guess was already within the tolerance, so that no sweep was made
	int sleeping = 0; // of these: islands at rest in which nothing changes
	int provenAtRest = 0, notAtRest = 0; // result of a trial of rest (island_sleep.cpp): slow islands found at rest, and those found not at rest
	double stopped = 0; // energy of the motion that a trial stopped and that the impulses have not taken [J]
	bool stoppedMoving = false; // whether any of the stopped bodies moved before the step
};

// What a step needs to know about rest; without it nothing sleeps.
struct Stillness {
	const Sleepers& sleepers; // islands left out of the system
	const std::vector<Body>& before; // the bodies before the step
	int trial; // sweeps that slow islands may take to prove their rest in this step; 0: no trial
	// Fingerprints of the bodies' loads in this step and the one before. Read in a trial only; if those before are not known, there is
	// no trial.
	const std::vector<int>&loads, *loadsBefore;
	double tolerance; // by which rest is judged, at most that of the step
};

// A hash of the velocity that forces add to a body in a step: equal loads have equal hashes.
int fingerprint(const double gained[3]);

// Solves all contacts at once.
SolverReport solveWhole(ContactSystem&, Solver, const SolverSettings&, Effort&);

// Solves island by island. A system of one island gets the same bits as from solveWhole, unless the step needs no sweep. Settings with
// fixedIterations or a random order refer to the whole system; it is then solved as a whole. iterations: the most made on any island.
class IslandSolver {
    public:
	SolverReport operator()(ContactSystem&, Solver, const SolverSettings&, Effort&, const Stillness* = nullptr);

	// Puts the islands to sleep that the last call has found asleep.
	void putToSleep(Sleepers& sleepers, const World& world) const { sleepers.add(world, found, partition.name); }

	// Whether the last system solved in place, its one large island and lone contacts, needed no sweep. It decides in which order the impulses of
	// the next one are added to the velocities, and so its last digits.
	bool rested = false;

    private:
	struct Island {
		int sweeps = 0;
		bool solved = false;
		bool unsolvable = false; // according to its method
		bool calm = false; // its bodies have passed the present test of rest
		bool asleep = false;
	};

	void findIslands(const ContactSystem&, Threads*);
	void countUnknowns(Effort&);
	void solveLoneContacts(ContactSystem&, double tolerance);
	bool isNearlyOneIsland(const ContactSystem&) const;
	SolverReport solveInPlace(ContactSystem&, Solver, const SolverSettings&);
	bool withinItsOwn(const ContactSystem&, double error, double tolerance) const;
	Status solveInParts(ContactSystem&, Solver, const SolverSettings&);
	int judge(double tolerance);
	void takePart(const ContactSystem&, bool (*wanted)(const Island&));
	int32_t placeOf(const ContactSystem&, int32_t body);
	void measurePart(std::vector<ResidualSum>&);
	SolverReport conclude(ContactSystem&, Status, double tolerance, const Sleepers*);

	// island_sleep.cpp
	template <class Condition> void excite(const Condition& moves);
	void exciteFast(const ContactSystem&, const int32_t* places, double tolerance, double share);
	void judgeRest(double tolerance, double share);
	void recognise(const ContactSystem&, const std::vector<Body>& before, double tolerance);
	void prove(ContactSystem&, const Stillness&, const SolverSettings&, Effort&);
	void stop(ContactSystem&, const Sleepers& on, Effort&);

	Partition partition; // of the system
	std::vector<Island> islands; // of the system
	std::vector<ResidualSum> sums; // errors of the islands
	std::vector<ResidualSum> all; // scratch: errors of the islands, those that sleep on included
	ResidualSum lone; // errors of all islands of one contact
	std::vector<double> freeVelocity; // velocities without impulses
	ContactSystem part; // some of the islands, with a body numbering of their own
	std::vector<double> partFree;
	std::vector<int32_t> place; // of each body: its number in `part`; -1: not in it
	std::vector<int32_t> partBodies, partContacts, partIsland; // their numbers in the system
	int larger = 0, largest = 0; // number of islands with more than one contact; contacts of the largest island
	int touching = 0; // movable bodies with a contact
	int factorizations = 0; // made by the methods for the parts
	struct {
		Status status = Status::converged;
		int32_t contact = -1; // of the system
	} unsolvable; // the first island found without a solution, else one whose first guess must not be used again (SolverReport::contact)
	std::vector<SleepingIsland> found; // asleep, sorted by name
	std::vector<double> own; // of each body: W_nn |p|^2 summed over its own contacts [J]
	std::vector<ResidualSum> trial; // errors of the islands that may be at rest
};

} // namespace cd
