// Gauss-Seidel sweeps over packed contacts, in the velocities of the bodies: the inner loop that all sweeping solvers share.
#pragma once

#include "blocks.hpp"
#include "contact_system.hpp"
#include "group_kernel.hpp"
#include "grouping.hpp"
#include "partition.hpp"
#include "random_order.hpp"
#include "residual.hpp"
#include "threads.hpp"

#include <memory>
#include <utility>

namespace cd {

// What a sweep from an extrapolated point did: y the point, p before, p+ after the sweep.
struct AheadReport {
	double change = 0; // |y - p+|^2 [N^2 s^2]
	double against = 0; // (y - p+) . (p+ - p) [N^2 s^2], positive: the sweep turned back
};

// What a method needs of the form a problem is given in; DelassusSweep has the same functions for the other form.
class Sweep {
    public:
	using System = ContactSystem;

	// Packs the contacts and puts their first-guess impulses on the bodies. The groups are those of this thread's last problem where that had
	// the same contacts in the same order, as in most steps of a packing at rest.
	// seed > 0: each sweep visits the groups of contacts in a new random order.
	// threads: that share the work; the bits are the same with any, and without.
	Sweep(ContactSystem& system, unsigned seed, Threads* threads = nullptr);
	~Sweep();
	Sweep(const Sweep&) = delete;
	Sweep& operator=(const Sweep&) = delete;

	// Solves every contact once, exactly, the others held. About 104 bytes and 45 operations a contact.
	void operator()();
	// The same from y = p + beta (p - q), q being the impulses before the last such sweep (p itself at the first).
	AheadReport ahead(double beta);

	// Recomputes the velocities from the impulses, which clears the round-off that updates in place leave behind.
	void restoreVelocities();
	// Copies impulses and velocities back to the system.
	void store();
	// The error of the packed impulses: that of residual(), but for the order of its sums. Costs two to three sweeps.
	Residual error();

	// The impulses of an iterate, to come back to.
	struct Iterate {
		std::vector<GroupBefore> groups;
		std::vector<double> loose; // two a contact
	};
	void copyTo(Iterate&) const;
	void copyFrom(const Iterate&);

	const Blocks& blocks() const { return packed.blocks; }

    private:
	// A contact that is solved alone: it couples n and t, or has a body that is no disk.
	struct Loose {
		ContactRow row; // packed bodies, arms over k
		double wa[3], wb[3]; // inverse masses of x, y and spin
		double beforePn, beforePt;
	};
	struct BodyKind {
		double w[3]; // what the rest was made from
		double radius, inverseRadius; // k [m] and 1/k; 1 where the body does not turn
		bool uniform; // one inverse mass for x, y and spin: may be in a group
		bool turns, movable;
	};
	// Where a block begins among the groups, the loose contacts and the bodies; it ends where the next begins. Bodies belong to the block that
	// meets them first, those that cannot move are in every block anew: it writes to them, too.
	struct Begin {
		std::size_t group, loose, body, sum;
	};
	// Of a contact: its packed bodies, and the sum for the error that it adds to: that of its island in its block.
	struct Ends {
		int32_t a, b, sum;
	};
	// What a sweep with momentum did in a block.
	struct alignas(128) BlockSums {
		LaneSums ahead;
		AheadReport aheadLoose;
	};
	// The packed problem. Its memory is kept from one Sweep of a thread to the next.
	struct Packed {
		std::vector<int32_t> place; // of each body of the system: its number among the packed, -1: not in any contact
		std::vector<int32_t> metIn; // the block in which it was; 0 of those that can move
		std::vector<int32_t> bodyAt; // the other way round
		std::vector<BodyKind> kinds; // of each body of the system
		std::vector<Link> links; // of each contact of the system
		std::vector<Ends> ends;
		std::vector<PackedBody> bodies, bodiesBefore; // the last are immobile, for the empty lanes of each block
		std::vector<PackedBody> freeBodies; // their free velocities; w: what external forces make of them, BodyVelocity::pushed [m/s]
		std::vector<double> masses; // of the same [kg]; 0: it cannot move along
		std::vector<double> freeSpins; // of the same [rad/s]
		std::vector<Group> groups;
		std::vector<GroupBefore> groupsBefore;
		std::vector<Loose> loose;
		Grouping grouping;
		GroupBuilder builder;
		Blocks blocks;
		std::vector<Begin> begin; // of each block, and the end of all
		std::vector<BlockSums> blockSums;
		Partition partition; // of the system
		std::vector<std::pair<int32_t, int32_t>> carried; // packed bodies that touch, the second ten times heavier
		// Of the error.
		std::vector<PackedBody> moved; // w: what acts on the body [m/s]
		std::vector<GroupMiss> misses;
		std::vector<ResidualSum> sums; // of the islands
		std::vector<ResidualSum> partSums; // of the islands in each block
		std::vector<int32_t> islandAt; // of these
		std::vector<int32_t> sumOfBody; // that it adds to; -1: it cannot move
		std::vector<std::pair<int32_t, int32_t>> sumOfIsland; // block in which it was last met, and its sum there
		std::vector<double> asked; // by packed body: least that acts on those that it carries and that are far heavier [m/s]
	};
	static std::unique_ptr<Packed>& spare();

	bool classifyBodies(bool& sameMasses); // whether they are of the same kinds as in the last problem
	Link link(const ContactRow&) const;
	bool sameLinks() const;
	void groupContacts();
	void numberBodies();
	// A body for the empty lanes of a block, in lines of memory of its own.
	int32_t nobody(std::size_t block) const { return static_cast<int32_t>(packed.bodyAt.size() + 4 * block); }
	void fillGroups(std::size_t block);
	void fillLoose(std::size_t block);
	void packBodies(std::size_t block);
	template <class Work> void inEveryBlock(const Work&) const;
	template <class Work> void colourByColour(const Work&) const;
	void sweepBlock(std::size_t block);
	void aheadInBlock(std::size_t block, double beta);
	AheadReport aheadAtRandom(double beta);
	void remember();
	void findCarried();
	void moveBodies();
	void twistBodies();
	void numberSums();
	void findAsked();
	void missInBlock(std::size_t block, bool apart);
	void addApart(std::size_t block);
	Miss missOf(const Loose&) const;
	static void solveLoose(Loose&, PackedBody* bodies);
	static void solveAhead(Loose&, PackedBody* bodies, double beta, AheadReport&);

	ContactSystem& system;
	std::unique_ptr<Packed> kept;
	Packed& packed;
	bool remembered = false; // whether the arrays named `before` are filled
	bool twisted = false; // whether external forces turn any body
	RandomOrder order;
	Threads* const threads;
};

// Calls work(block) for every block.
template <class Work> void Sweep::inEveryBlock(const Work& work) const
{
	if (threads)
		threads->run(packed.blocks.colour.data(), packed.blocks.colours(), work);
	else
		for (std::size_t block = 0; block < packed.blocks.count(); block++)
			work(block);
}

// The same in the order of the sweep: no two blocks at once that have a body that can move in common.
template <class Work> void Sweep::colourByColour(const Work& work) const
{
	if (!threads)
		return inEveryBlock(work);
	for (std::size_t c = 0; c < packed.blocks.colours(); c++)
		threads->run(&packed.blocks.colour[c], 1, work);
}

} // namespace cd
