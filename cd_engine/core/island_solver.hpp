// Solves no more of a step's problem than there is to solve: nothing for bodies that touch nothing, a lone contact in closed form, an
// island at rest not at all, and every other island of contacts until it has reached the tolerance by itself.
//
// An island are contacts that feel each other, through bodies that can move: impulses do not pass through a body that nothing can move, so
// two heaps on one fixed floor are two islands, and a loaded wall joins all that touch it. The error e is a 2-norm over a 2-norm, so if every
// island has |difference_k| <= tolerance |p_k|,
//   sum |difference_k|^2 <= tolerance^2 sum |p_k|^2,
// and the whole is within the tolerance, too. The reverse is not true: solved at once, sand beside rocks may keep any error that is small
// beside the impulses of the rocks. Islands are therefore swept together, which fills the groups of eight, but those that miss their own
// tolerance then go on without the others. A step whose whole error is within the tolerance counts as solved even if some island missed its
// own: nothing less is promised than for the whole.
//
// Islands proven to be at rest sleep until something changes (sleep.hpp).
#pragma once

#include "partition.hpp"
#include "residual.hpp"
#include "sleep.hpp"
#include "sleepers.hpp"
#include "solver.hpp"

namespace cd {

// What a step's problem amounted to.
struct Effort {
	int unknowns = 0; // velocities: three for a free disk, none for what cannot move or, in islands, touches nothing
	int islands = 0;
	int resting = 0; // islands whose first guess was within the tolerance already: no sweep was made
	int sleeping = 0; // of these, islands at rest in which nothing changes
	int provenAtRest = 0, notAtRest = 0; // islands that were slow when their rest was tried
	double stopped = 0; // energy of what was stopped then, which the impulses have not taken [J]
	bool stoppedMoving = false; // any of these moved before the step
};

// All the contacts at once.
SolverReport solveWhole(ContactSystem&, Solver, const SolverSettings&, Effort&);

// Island by island. A system of one island gets the bits that solveWhole gives it. Settings that ask for so many sweeps or for a random order
// mean the whole system; it is not parted. iterations: the most made on any island.
class IslandSolver {
    public:
	SolverReport operator()(ContactSystem&, Solver, const SolverSettings&, Effort&, const Stillness* = nullptr);

    private:
	struct Island {
		int32_t first = 0; // contact
		int32_t contacts = 0; // how many
		int sweeps = 0;
		bool solved = false;
		bool unsolvable = false; // as its method has found
		bool still = false; // nothing of it moved before the step
		bool calm = false; // none of its bodies is fast
		bool atRest = false; // by the last look at it
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
	bool findStill(const ContactSystem&, const std::vector<double>& before);
	void recognise(const ContactSystem&, const Stillness&, double tolerance);
	void reportSleep(const ContactSystem&, Sleepers&);
	void countSleepersOn(Effort&, const Sleepers&);
	void findCalm(const ContactSystem&, const std::vector<int32_t>* names, double tolerance, double share);
	void judgeRest(double tolerance, double share);
	int markSlow(const ContactSystem&, const Stillness&, double tolerance);
	void dismissMoving(const ContactSystem&, const SolverSettings&);
	void prove(ContactSystem&, const Stillness&, const SolverSettings&, Effort&);
	void stop(ContactSystem&, const Sleepers&);

	Partition partition; // of the system
	std::vector<Island> islands; // of it
	std::vector<ResidualSum> sums; // of the islands
	std::vector<ResidualSum> partSums; // scratch
	ResidualSum lone; // of the islands of one contact
	std::vector<double> freeVelocity; // velocities without impulses
	ContactSystem part; // some of the islands, with bodies of its own numbers
	std::vector<double> partFree;
	std::vector<int32_t> place; // of a body in `part`; -1: not in it
	std::vector<int32_t> partBodies, partContacts, partIsland; // what they are in the system
	int larger = 0, largest = 0; // islands of more than one contact; contacts of the largest
	int touching = 0; // bodies that can move and have a contact
	int factorizations = 0; // made for the parts
	struct {
		Status status = Status::converged;
		int32_t contact = -1; // of the system
	} unsolvable; // the last island found so
	int sleeping = 0; // of the islands
	std::vector<double> own; // W_nn |p|^2 of a body's own contacts [J]
	std::vector<ResidualSum> trial; // errors of the islands that may be at rest
	bool rested = false; // whether the last system was solved in place without a sweep: decides on costs, not on results
};

} // namespace cd
