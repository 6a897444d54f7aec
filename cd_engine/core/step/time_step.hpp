// One step of the Moreau-Jean scheme.
#pragma once

#include "scene/scene.hpp"
#include "islands/islands.hpp"
#include "step/rebounds.hpp"
#include "base/base.hpp"
#include "search/search.hpp"

#include <array>

namespace cd {

struct PairLanes;
struct PairEffects;
struct RowSettings;

struct StepSettings {
	double dt = 0; // [s]
	double restitution = 0; // Newton's e, normal direction
	double gapCorrection = 0; // share of an overlap, beyond the reference and the allowed one, that the step pushes out
	double allowedOverlap = 0; // that it leaves, as a share of the smaller disk's radius
	int threads = 1; // threads that share the work of a large scene; the bits do not depend on their number
	bool warmStart = true; // the first guess are the forces that contacts have carried; else nothing
	long iteration = 0; // number of the step, recorded where a contact becomes loaded
	bool reduce = true; // solve islands of contacts separately (island_solver.hpp)
	int trial = 0; // sweeps that slow islands may take to prove their rest in this step (island_sleep.cpp)
	const std::vector<int>* loadsBefore = nullptr; // for a trial: hashes of the loads in the step before
	bool notesLoads = false; // record the loads, for a trial in the next step
	bool rested = false; // StepReport::rested of the step before
	Solver solve = nullptr;
	SolverSettings solver;
	// Tolerance by which rest is judged, if it is smaller than that of the step. The same in all steps, so that it does not matter in which of
	// them an island is looked at.
	double restTolerance = std::numeric_limits<double>::infinity();
};

struct StepReport {
	SolverReport solver;
	Effort effort;
	bool rested = false; // IslandSolver::rested
	std::array<int32_t, 2> unsolvable { -1, -1 }; // bodies of SolverReport::contact
	int contacts = 0; // contacts that the solver was given
	int slidingContacts = 0; // loaded contacts with mu > 0 and |p_t| at mu p_n
	int loadedContacts = 0;
	double maxPenetration = 0; // [m], beyond the reference overlap, at the mid-configuration
	double dissipated = 0; // [J] in this step
	double solveSeconds = 0; // spent in the solver
	std::vector<double> outran; // of each body: how far from its place before the step pairs must be listed [m]; empty: the list was long enough
	bool idle = false; // nothing moves and all contacts sleep: under the same forces the next step changes nothing either
};

// The smallest radius of the disks [m]; infinite if there is no disk.
double smallestRadius(const World&);

class TimeStep : RowSource {
    public:
	// Moves the bodies by dt: q_m = q + h/2 v;  M (v' - v) = h F + H(q_m) p;  q' = q_m + h/2 v'  (theta = 1/2; Jean 1999, section 4). Only the
	// pairs in world.awake may touch.
	// - Gaps: contact is required at the mid-configurations, which are a step apart. So u_n + max(gap, 0)/h >= 0 keeps the next one from
	//   overlapping, to first order: the gap may close within the step, but not become negative. If the face of a box turns, the change of the
	//   gap by this is added, so that it meets disks like one that only translates.
	// - Overlaps are kept from growing. With gapCorrection b > 0 they must shrink, u_n + b (gap + a)/h >= 0 (b = 1: to the allowed overlap a
	//   within the step), by a velocity that stays and is not dissipated. In a packing at rest such velocities contradict each other; the
	//   allowed overlap prevents them from moving the packing for ever.
	// - Only velocities just set from outside, or left by an unsolved step, can move the centre of a disk into or through a boundary in a step's
	//   first half, before contact is looked at. Such a disk stops at the face.
	// - Restitution e > 0: a contact that is closed, or that the velocities before the step would close within it, takes u_n' >= -e u_n instead,
	//   or what its overlap demands if that is more (rebounds.hpp). A contact that only other contacts' impulses close is left to the next step
	//   and overlaps by up to its closing velocity times h.
	// - No body is moved in two cases: the solver met a number that is not finite, or, without restitution, impulses made a body so fast that it
	//   may reach others that are not in the list of pairs (World::listed). In the second case report.outran is not empty, and the step must be
	//   repeated with a longer list.
	StepReport operator()(World&, const StepSettings&);

	// The problem that such a step would give to its solver, with the free velocities. The world is not moved. A pair is a contact if its bodies
	// may close its gap at their present velocities (mayClose). If the solution closes the gap of a pair that was left out, the step is solved
	// again with this pair and all others that the new velocities can close.
	const ContactSystem& assemble(World&, const StepSettings&);

	// Of the last step: the pairs that had a contact.
	const std::vector<int32_t>& pairs() const { return rowPair; }
	// Finds the places and overlaps of the last step of dt anew, up to round-off, if a later step was given up and has left its own.
	void lookBack(const World&, double dt);
	// Where a pair that carries a force touched when a step last looked at it.
	Touch touchOf(const World&, std::size_t pair) const;
	double gapOf(const World& world, std::size_t pair) const { return world.pairs[pair].reference - overlaps[pair]; } // [m]
	// The pairs whose reference overlap ended in the last step.
	const std::vector<int32_t>& overlapsForgotten() const { return forgotten; }
	// Hashes of the loads of the bodies, if they were recorded.
	const std::vector<int>& loads() const { return fingerprints; }
	// The impulses of all contacts on the bodies in the last step, those of sleeping islands included: [N s], [N s], [N m s]. They are summed
	// when somebody asks, so before the next step begins. world: as that step has left it.
	const std::vector<std::array<double, 3>>& impulsesOn(const World& world);

	// Whether nobody has read a row of the last step's contacts, so that none was made.
	bool sparedRows() const { return spared; }
	// Asked before the pairs are read, and told which parts of the scene a step has changed.
	Sleepers sleepers;
	// Share the work of a step, and of what is done before and after it.
	Threads threads;

    private:
	static void free(const Body&, double dt, BodyVelocity&);
	void freeAgain(const World&, double dt);
	struct Begun {
		bool turns, sameMasses, guides; // guides: there is a disk that no force moves
	};
	Begun beginBodies(const World&, double dt);
	void noteLoads(const World&, const StepSettings&);
	bool meanVelocities(const World&, double dt, bool solved);
	double needed(const World&, std::size_t body, double dt) const;
	double relativeSpeed(const Pair&, const World&, const double* a, const double* b) const;
	double smallerRadius(const Pair&) const;
	bool mayClose(const Pair&, const World&, double gap, double dt) const;
	Touch locate(const Pair&, const World&) const;
	struct Seen;
	Seen look(const World&, const StepSettings&, Seen* parts);
	bool judge(const Pair&, const World&, const StepSettings&, double beyond, double& overlap, double& gap, bool& through) const;
	void findContacts(World&, const StepSettings&, const Begun&);
	void prepare(World&, const StepSettings&);
	bool isThrough(const Pair&, const World&, const Touch&, double dt, Foot& face) const;
	void stopAtFaces(const World&, double dt);
	double turning(const Pair&, const World&, const Touch&, double gap, double dt, double spin) const;
	bool crosses(std::size_t pair, const World&, double dt) const;
	void resizeRows(std::size_t count, const StepSettings&);
	std::array<double, 2> firstGuess(const World&, std::size_t pair, const StepSettings&) const;
	ContactRow rowOf(const World&, std::size_t pair, const StepSettings&, double& turned) const;
	template <bool rows, class Which>
	std::size_t load(const World&, std::size_t count, PairLanes*, const Which&, const double* inverseRadius = nullptr) const;
	void fillRows(const World&, const StepSettings&, ContactRow* all, std::size_t from, std::size_t to);
	static RowSettings asked(const StepSettings&);
	bool findSpecial(const World&, const StepSettings&);
	void makeRows(std::vector<ContactRow>&) override;
	ContactRow row(int32_t contact) const override;
	std::array<double, 2> guess(int32_t contact) const override;
	void fill(const int32_t* contacts, std::size_t count, const double* inverseRadius, Group*, uint8_t* left) const override;
	void askRebound(const World&, std::size_t row, ContactRow&, double turned, const StepSettings&);
	bool closes(const World&, const Pair&, const Touch&, double gap, double dt) const;
	bool within(std::size_t pair, const World&, double dt) const;
	bool addViolated(World&, const StepSettings&);
	bool attempt(World&, const StepSettings&, StepReport&);
	void guessAgain(const World&, const StepSettings&);
	bool lowerRebounds(const World&, const StepSettings&, const StepReport&, bool last);
	static bool end(StepReport&);
	void finishContacts(World&, const StepSettings&, StepReport&);
	// Pairs that the kernels are given at once. A vector that has been written lane by lane can be read only a while later.
	static constexpr std::size_t batch = 64;
	void effectsOf(const World&, double rate, std::size_t from, std::size_t count, PairEffects*) const;
	struct Account;
	struct Effect;
	Effect effectOf(const ContactRow&, double rate) const;
	void book(World&, const StepSettings&, std::size_t row, const Effect&, bool anyAsleep, Account&);
	void bookPostponed(World&, const StepSettings&, double rate, std::size_t from, std::size_t count, Account&);
	Account account(World&, const StepSettings&, double dissipated, std::size_t from, std::size_t to);
	static bool keeps(double nx, double ny, double pn, double pt, Carried&, double dt);
	void release(const Pair&, Carried&);
	struct Share;
	Share share(const World&, std::size_t pair, Vector normal, double pn, double pt) const;
	void clearImpulses();
	void give(const Share&);
	void give(const World&, std::size_t row);
	void push(const World&, std::size_t row, int32_t island);
	void finishSleepers(StepReport&);
	bool finishBodies(World&, double dt);

	// What a step has found in one part of the pairs.
	struct Seen {
		std::size_t contacts = 0, first = 0; // first: row of the first contact
		bool through = false; // a disk must be taken back to a face
		bool same = true; // the contacts are those of the last look
		bool apart = false; // a reference overlap has ended
		double deepest = 0, narrowest = endless; // largest overlap beyond the reference, smallest gap left out [m]
	};

	Workspace memory; // of the solvers
	IslandSolver solveIslands;
	Rebounds rebounds;
	ContactSystem system;
	std::vector<double> freeVelocity; // with restitution: the velocities that external forces alone would leave
	std::vector<int> fingerprints; // hashes of what forces add to the velocities, if recorded
	std::vector<Place> places; // of the bodies at the mid-configuration
	std::vector<Mean> means; // of the bodies
	std::vector<double> ways; // of the bodies in the step without impulses; if a body turns, of its farthest point [m]
	struct Shift {
		int32_t body;
		double x, y; // [m]
	};
	std::vector<Shift> shifts; // of disks that were stopped at a face, at the mid-configuration
	double narrowest = 0; // smallest gap of a pair that was left out [m]
	double fastest = 0; // largest speed of a body after the step [m/s]
	std::vector<int32_t> forgotten;
	double deepest = 0; // largest overlap beyond the reference one [m]
	std::vector<char> special; // of each contact: whether the kernel cannot make its row
	// These contacts, their rows if all rows are postponed, and of every contact its index among them, -1: none. Known for this contactSet.
	std::vector<int32_t> specials, specialOf;
	std::vector<ContactRow> specialRows;
	std::size_t specialFor = 0;
	const World* source = nullptr; // what postponed rows are made from
	const StepSettings* sourceSettings = nullptr;
	bool spared = false;
	long listing = 0; // World::listing of the last step
	bool appended = false; // the last step has added contacts
	std::size_t assembled = 0; // contacts before any pair that was left out has been added
	std::vector<int32_t> rowPair; // the pair of each contact of the system
	std::vector<char> solved; // whether a pair has a contact in the system
	HiddenCorners corners;
	std::vector<double> overlaps; // geometric ones of the pairs looked at; negative: apart [m]
	struct Share { // what a contact's impulse does to its bodies
		int32_t a, b; // bodies
		double x, y, turnA, turnB; // impulse on b [N s], moments about the centres of both [N m s]
	};
	std::vector<std::array<double, 3>> impulses;
	bool impulsesKnown = false; // whether they are summed; if not, nothing sleeps, and they can be summed from the contacts of the last step
};

} // namespace cd
