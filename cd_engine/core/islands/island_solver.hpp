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

#include "islands/island_part.hpp"
#include "islands/rest.hpp"
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

// Solves all contacts at once.
template <class Space> SolverReport solveWhole(ContactSystem<Space>&, Solver<Space>, const SolverSettings&, Effort&);

// Solves island by island. A system of one island gets the same bits as from solveWhole, unless the step needs no sweep. Settings with
// fixedIterations or a random order refer to the whole system; it is then solved as a whole. iterations: the most made on any island.
template <class Space> class IslandSolver {
	using Body = BodyOf<Space>;
	using World = WorldOf<typename Space::Scene>;
	using ContactSystem = cd::ContactSystem<Space>;
	using Sleepers = cd::Sleepers<typename Space::Scene>;
	using Solver = cd::Solver<Space>;
	using Stillness = cd::Stillness<typename Space::Scene>;

    public:
	SolverReport operator()(ContactSystem&, Solver, const SolverSettings&, Effort&, const Stillness* = nullptr);

	// Puts the islands to sleep that the last call has found asleep.
	void putToSleep(Sleepers& sleepers, const World& world) const { sleepers.add(world, found, partition.name); }

    private:
	enum class State : uint8_t { open, solved, unsolvable, asleep }; // unsolvable: according to its method
	struct Island {
		int sweeps = 0;
		State state = State::open;
		bool calm = false; // its bodies have passed the present test of rest
	};

	void findIslands(ContactSystem&, Threads*, Effort&);
	void solveLoneContacts(ContactSystem&, double tolerance);
	bool isNearlyOneIsland(const ContactSystem&) const;
	SolverReport solveInPlace(ContactSystem&, Solver, const SolverSettings&, Rest*);
	bool withinItsOwn(const ContactSystem&, double error, double tolerance) const;
	SolverReport solveInParts(ContactSystem&, Solver, const SolverSettings&);
	int markSolved(double tolerance, bool guess);
	SolverReport conclude(ContactSystem&, SolverReport, double tolerance, const Stillness*);

	// island_sleep.cpp
	template <class Condition> void excite(const Condition& moves);
	void exciteFast(const ContactSystem&, const int32_t* places, double tolerance, double share);
	void findCalm(double tolerance, double share);
	void findAsleep(ContactSystem&, const std::vector<Body>& before, double tolerance);
	void tryRest(ContactSystem&, const Stillness&, const SolverSettings&, Effort&);
	void stop(ContactSystem&, const Sleepers& on, Effort&);

	Partition partition; // of the system
	std::vector<Island> islands; // of the system
	std::vector<ResidualSum> sums; // errors of the islands
	std::vector<ResidualSum> all; // scratch: errors of the islands, those that sleep on included
	ResidualSum lone; // errors of all islands of one contact
	std::vector<double> freeVelocity; // velocities without impulses, of the bodies with contacts at least
	IslandPart<Space> part; // of the system
	std::size_t touching = 0; // movable bodies with a contact
	std::vector<SleepingIsland> found; // asleep, sorted by name
	std::vector<double> own; // of each body: W_nn |p|^2 summed over its own contacts [J]
};

} // namespace cd
