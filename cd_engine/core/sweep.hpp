// Gauss-Seidel sweeps over packed contacts, in the velocities of the bodies: the inner loop that all sweeping solvers share.
#pragma once

#include "contact_system.hpp"
#include "group_kernel.hpp"
#include "grouping.hpp"
#include "partition.hpp"
#include "random_order.hpp"
#include "residual.hpp"

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
	Sweep(ContactSystem& system, unsigned seed);
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
	enum class Part : int32_t { none, loose, grouped }; // none: two immobile bodies
	// All that the grouping asks of a contact.
	struct Link {
		int32_t a, b;
		Part part;
		bool operator==(const Link& other) const { return a == other.a && b == other.b && part == other.part; }
	};
	// The packed problem. Its memory is kept from one Sweep of a thread to the next.
	struct Packed {
		std::vector<int32_t> place; // of each body of the system: its number among the packed, -1: not in any contact
		std::vector<int32_t> bodyAt; // the other way round
		std::vector<BodyKind> kinds; // of each body of the system
		std::vector<Link> links; // of each contact of the system
		std::vector<PackedBody> bodies, bodiesBefore; // the last is immobile, for empty lanes
		std::vector<PackedBody> freeBodies; // their free velocities; w: what external forces make of them, BodyVelocity::pushed [m/s]
		std::vector<double> masses; // of the same [kg]; 0: it cannot move along
		std::vector<double> freeSpins; // of the same [rad/s]
		std::vector<Group> groups;
		std::vector<GroupBefore> groupsBefore;
		std::vector<Loose> loose;
		Grouping grouping;
		std::size_t contacts = 0; // that can be solved
		GroupBuilder builder;
		Partition partition; // of the system
		std::vector<std::pair<int32_t, int32_t>> carried; // packed bodies that touch, the second ten times heavier
		// Of the error.
		std::vector<PackedBody> moved; // w: what acts on the body [m/s]
		std::vector<GroupMiss> misses;
		std::vector<ResidualSum> sums; // of the islands
		std::vector<double> asked; // by packed body: least that acts on those that it carries and that are far heavier [m/s]
	};
	static std::unique_ptr<Packed>& spare();

	bool classifyBodies(bool& sameMasses); // whether they are of the same kinds as in the last problem
	Link link(const ContactRow&) const;
	bool sameLinks() const;
	void groupContacts();
	void fillGroups();
	void fillLoose();
	void packBodies();
	void remember();
	void findCarried();
	void moveBodies();
	void twistBodies();
	void addBodies();
	void addTogether(const LaneMisses&);
	void addApart();
	void addCarried();
	Miss missOf(const Loose&) const;
	static void solveLoose(Loose&, PackedBody* bodies);
	static void solveAhead(Loose&, PackedBody* bodies, double beta, AheadReport&);

	ContactSystem& system;
	std::unique_ptr<Packed> kept;
	Packed& packed;
	bool remembered = false; // whether the arrays named `before` are filled
	bool twisted = false; // whether external forces turn any body
	RandomOrder order;
};

} // namespace cd
