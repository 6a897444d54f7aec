// The bodies of a sweep: those with contacts, numbered in the order in which the contacts meet them, so that bodies of near contacts are near in
// memory.
#pragma once

#include "graph/graph.hpp"
#include "kernels/kernels.hpp"

namespace cd {

// Of what a loop reads elsewhere in memory, so many bodies or groups ahead are fetched.
constexpr std::size_t fetchedAhead = 24;

// The packed bodies of a contact.
struct Ends {
	int32_t a, b;
};

template <class Space> class PackedBodies {
	using BodyVelocity = BodyVelocityIn<Space>;
	using PackedBody = PackedBodyIn<Space>;

    public:
	using Kind = PackedKind<typename Space::Scene>;
	// Whether kinds and masses have stayed the same since the last problem; whether external forces turn any body.
	struct Found {
		bool sameKinds, sameMasses, twisted;
	};

	// Reads the masses of the bodies of a system.
	Found classify(const std::vector<BodyVelocity>&, Threads*);
	// Numbers the bodies of each block. A movable body belongs to the first block that meets it. An immobile body has a copy in every block,
	// because sweeps write to it, too.
	void number(const Partition&, const Blocks&, std::vector<Ends>& ofContacts);
	// Copies free velocities and masses of the bodies of a block from the system, and velocities back. To be stored once: it adds the changes of
	// the spins to those of the system.
	void pack(int32_t block, const std::vector<BodyVelocity>&);
	void store(int32_t block, std::vector<BodyVelocity>&) const;

	int32_t nobody(int32_t block) const { return static_cast<int32_t>(at.size()) + 4 * block; } // an immobile body for empty lanes
	bool movable(std::size_t i) const { return isMovable(kinds[at[i]]); }

	std::vector<Kind> kinds; // of each body of the system,
	std::vector<double> inverseRadii; // 1/k,
	std::vector<int32_t> place; // and its packed number; -1: it has no contact
	std::vector<int32_t> at; // of each packed body: its number in the system
	std::vector<Range> ofBlock; // the packed bodies of each block
	std::vector<PackedBody> now; // after them: immobile ones for the empty lanes of each block, in memory lines that no other block uses
	std::vector<PackedBody> free; // their free velocities; w: the velocity by external forces, BodyVelocity::pushed [m/s]
	std::vector<double> masses; // of the same [kg]; 0: it cannot move along x or y

    private:
	std::vector<int32_t> metIn; // of each body of the system: the last block that gave it a packed number; 0 for movable bodies
};

} // namespace cd
