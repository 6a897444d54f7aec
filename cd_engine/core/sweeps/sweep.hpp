// Gauss-Seidel sweeps over packed contacts, in the velocities of the bodies: the inner loop that all sweeping solvers share.
#pragma once

#include "graph/graph.hpp"
#include "problem/problem.hpp"
#include "kernels/kernels.hpp"
#include "base/base.hpp"
#include "error/error.hpp"

#include <utility>

namespace cd {

// The numbers from .. to - 1.
struct Range {
	struct Number {
		std::size_t i;
		std::size_t operator*() const { return i; }
		void operator++() { i++; }
		bool operator!=(const Number& other) const { return i != other.i; }
	};
	Number begin() const { return { from }; }
	Number end() const { return { to }; }
	std::size_t size() const { return to - from; }

	std::size_t from = 0, to = 0;
};

// What a method needs, for a problem given by its bodies. DelassusSweep has the same functions for a problem given by its matrix.
class Sweep {
    public:
	using System = ContactSystem;

	// Packs the contacts and applies the impulses of the first guess to the bodies. Reuses the groups of the last problem with this memory, if
	// that had the same contacts in the same order, as in most steps of a packing at rest. seed > 0: each sweep visits the groups of contacts in
	// a new random order. threads: share the work; the bits do not depend on them.
	Sweep(ContactSystem& system, unsigned seed, Threads* threads = nullptr);

	// Solves every contact once, exactly, while the others are held. About 104 bytes and 45 operations a contact.
	void operator()();
	// The same from y = p + beta (p - q), with q the impulses before the last such sweep (at the first one q = p).
	AheadReport ahead(double beta);

	// Recomputes the velocities from the impulses. This removes the round-off that updates in place leave behind.
	void restoreVelocities();
	// Copies impulses and velocities back to the system. To be called once: it adds the changes of the spins to those of the system.
	void store();
	// The error of the packed impulses: that of residual(), except for the order of its sums. Costs about three sweeps: it reads every contact
	// twice.
	Residual error();

	// The impulses of an iterate, saved to restore it later.
	struct Iterate {
		struct Loose {
			double pn, pt;
		};
		std::vector<GroupBefore> groups;
		std::vector<Loose> loose;
	};
	void copyTo(Iterate&) const;
	void copyFrom(const Iterate&);

	const Blocks& blocks() const { return packed.blocks; }
	Workspace* memory() const { return system.memory; }

    private:
	static constexpr std::size_t soon = 24; // of what a loop reads elsewhere in memory, so many bodies or groups ahead are fetched

	// A contact that is solved alone: it couples n and t, or one of its bodies has no uniform inverse mass (BodyKind).
	struct Loose {
		ContactRow row; // a, b: packed bodies; arms divided by k
		double wa[3], wb[3]; // inverse masses of x, y and spin
		int32_t sum; // as in Ends
	};
	struct BodyKind {
		double w[3]; // inverse masses that the members below are made from
		double radius; // k [m]; 1 where the body does not turn
		bool uniform; // x, y and spin have one inverse mass: its contacts may be in a group
		bool turns;
	};
	// What a block has of the packed arrays. A movable body belongs to the first block that meets it. An immobile body has a copy in every block,
	// because sweeps write to it, too.
	struct alignas(128) Part {
		Range contacts; // of Blocks::contacts
		Range groups, loose, bodies, sums;
		Range runs, underHeavy; // of Packed
		int32_t nobody; // an immobile body for the empty lanes, in memory lines that no other block uses
		LaneSums ahead; // results of a sweep with momentum: of the groups,
		AheadReport aheadLoose; // and of the loose contacts

		Range lanes() const { return { groups.from * Group::lanes, groups.to * Group::lanes }; }
	};
	// Groups next to each other whose contacts all add to one sum for the error; sum -1: several sums within a group.
	struct Run {
		Range groups;
		int32_t sum;
		std::size_t contacts;
	};
	// A contact in a group, of a body that carries a far heavier one: its lane, its bodies, the sum for the error that it adds to.
	struct UnderHeavy {
		std::size_t lane;
		int32_t a, b, sum;
	};
	// Of a contact: its packed bodies; the sum for the error that it adds to, which is that of its island in its block; whether it may be in a
	// group.
	struct Ends {
		int32_t a, b, sum;
		bool groupable;
	};
	// The packed problem. The next Sweep with the same memory finds it.
	struct Packed {
		std::vector<int32_t> place; // of each body of the system: its packed number; -1: it has no contact
		std::vector<int32_t> metIn; // the last block that gave it a packed number; 0 for movable bodies
		std::vector<int32_t> bodyAt; // of each packed body: its number in the system
		std::vector<BodyKind> kinds; // of each body of the system
		std::vector<double> inverseRadii; // of the same: 1/k
		std::vector<Ends> ends;
		std::vector<PackedBody> bodies; // the last ones are immobile, for the empty lanes of each block
		std::vector<PackedBody> freeBodies; // their free velocities; w: the velocity by external forces, BodyVelocity::pushed [m/s]
		std::vector<double> masses; // of the same [kg]; 0: it cannot move along x or y
		std::vector<Group> groups;
		std::vector<Loose> loose;
		std::vector<PackedBody> bodiesBefore; // one sweep ago,
		Iterate before; // and the impulses
		Grouping grouping;
		std::vector<uint64_t> grouped; // of each packed body: marks while contacts are grouped
		Blocks blocks;
		std::vector<Part> parts; // one a block
		Partition partition; // of the system
		std::vector<std::pair<int32_t, int32_t>> carried; // packed bodies that touch; the second is ten times heavier
		// For the error.
		std::vector<PackedBody> moved; // w: magnitude of what acts on the body [m/s]
		std::vector<Run> runs;
		std::vector<UnderHeavy> underHeavy;
		std::vector<GroupMiss> misses; // empty if all runs have one sum and no body carries a far heavier one
		std::vector<ResidualSum> sums; // of the islands
		std::vector<ResidualSum> partSums; // of the islands in each block
		std::vector<int32_t> islandAt; // the island of each of these sums
		std::vector<int32_t> sumOfBody; // the sum that each packed body adds to; -1: the body cannot move
		std::vector<std::pair<int32_t, int32_t>> sumOfIsland; // of each island: block in which it was last met, and its sum there
		std::vector<double> asked; // of each packed body: smallest s of the far heavier bodies that it carries [m/s]
	};
	struct Same {
		bool kinds, masses;
		bool twisted; // whether external forces turn any body
	};
	Same classifyBodies(); // what has stayed the same since the last problem
	bool groupable(const ContactRow&) const;
	void groupContacts();
	void numberBodies();
	// Fills in this problem's numbers. Returns false if a contact is no longer what it was when groups were made.
	bool fill();
	bool fillGroups(const Part&);
	bool fillLane(Group&, int lane, const ContactRow&) const;
	bool fillLoose(const Part&);
	const ContactRow& rowOf(int32_t contact, ContactRow& made) const;
	void packBodies(const Part&);
	template <class Work> void inEveryBlock(const Work&) const;
	template <class Work> void colourByColour(const Work&) const;
	template <class Work> void inOrder(const Work&);
	template <class P, class Copy> void withIterate(P&, const Copy&) const;
	void findCarried();
	void moveBodies();
	void twistBodies();
	void numberSums();
	void addToRuns(const Part&, std::size_t group);
	void findAsked();
	void missInBlock(const Part&);
	void addApart(const Range& groups);
	void addBodies(const Part&);
	static void push(const Loose&, double pn, double pt, PackedBody& A, PackedBody& B);
	static void solveLoose(Loose&, PackedBody* bodies);
	static void solveAhead(Loose&, Iterate::Loose& before, PackedBody* bodies, double beta, AheadReport&);

	ContactSystem& system;
	Borrowed<Packed> kept;
	Packed& packed;
	bool remembered = false; // whether `bodiesBefore` and `before` are set
	bool current = false; // whether packed.moved has the velocities of the present impulses
	bool twisted; // whether external forces turn any body
	RandomOrder order;
	Threads* const threads;
};

// Adds an impulse of a contact to the velocities of its bodies.
inline void Sweep::push(const Loose& l, double pn, double pt, PackedBody& A, PackedBody& B)
{
	const ContactRow& c = l.row;
	const double px = c.nx * pn - c.ny * pt, py = c.ny * pn + c.nx * pt;
	A.vx -= l.wa[0] * px;
	A.vy -= l.wa[1] * py;
	A.spin -= l.wa[2] * (c.an * pn + c.at * pt);
	B.vx += l.wb[0] * px;
	B.vy += l.wb[1] * py;
	B.spin += l.wb[2] * (c.bn * pn + c.bt * pt);
}

// Calls work(part) for every block.
template <class Work> void Sweep::inEveryBlock(const Work& work) const
{
	if (threads)
		threads->run(packed.blocks.colour.data(), packed.blocks.colours(), [&](int32_t block) { work(packed.parts[block]); });
	else
		for (Part& part : packed.parts)
			work(part);
}

// The same in the order of the sweep: blocks that share a movable body never run at the same time.
template <class Work> void Sweep::colourByColour(const Work& work) const
{
	if (!threads)
		return inEveryBlock(work);
	for (std::size_t c = 0; c < packed.blocks.colours(); c++)
		threads->run(&packed.blocks.colour[c], 1, [&](int32_t block) { work(packed.parts[block]); });
}

} // namespace cd
