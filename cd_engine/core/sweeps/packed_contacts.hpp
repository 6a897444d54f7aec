// The contacts of a sweep: in groups of eight, or alone.
#pragma once

#include "sweeps/packed_bodies.hpp"

namespace cd {

// A contact that is solved alone: it couples n and t, one of its bodies has no uniform inverse mass, or no group had room.
template <class Space> struct LooseContact {
	ContactRow<Space> row; // a, b: packed bodies; arms divided by k
	MotionOf<Space> wa, wb; // inverse masses of the packed bodies
	bool groupable; // whether it may be in a group
};

// The impulses of an iterate.
template <class Space> struct SweptImpulses {
	std::vector<GroupBefore<Space>> groups;
	std::vector<ImpulseOf<Space>> loose;
};

template <class Space> class PackedContacts {
	using ContactRows = cd::ContactRows<Space>;
	using Group = cd::Group<Space>;
	using LooseContact = cd::LooseContact<Space>;
	using PackedBodies = cd::PackedBodies<Space>;
	using SweptImpulses = cd::SweptImpulses<Space>;

    public:
	struct Ranges {
		Range groups, loose;
		Range lanes() const { return { groups.from * Group::lanes, groups.to * Group::lanes }; }
	};

	// Groups the contacts of each block. Their ends must be known.
	void group(const ContactRows&, const Blocks&, const PackedBodies&);
	// Fills in the numbers of a block, from rows or, where these are postponed, from the step itself. Returns false if a contact is no longer
	// what it was when groups were made.
	bool fill(int32_t block, const ContactRows&, const PackedBodies&);

	void copyTo(SweptImpulses&, int32_t block) const;
	void copyFrom(const SweptImpulses&, int32_t block);
	// Calls store(number of the contact, its impulse) for the contacts of a block.
	template <class Store> void forImpulses(int32_t block, const Store& store) const
	{
		for (const std::size_t k : ofBlock[block].groups) {
			const Group& g = groups[k];
			if (k + fetchedAhead < ofBlock[block].groups.to)
				groups[k + fetchedAhead].prefetchImpulses();
			for (std::size_t lane = 0; lane < Group::lanes; lane++)
				if (const int32_t contact = grouping.members[k * Group::lanes + lane]; contact >= 0)
					store(contact, g.impulse(lane));
		}
		for (const std::size_t i : ofBlock[block].loose)
			store(grouping.loose[i], impulseOf(loose[i].row));
	}

	Grouping grouping; // of the numbers of the contacts
	std::vector<Group> groups; // of the members of grouping
	std::vector<LooseContact> loose;
	std::vector<Ends> ends; // of each contact
	std::vector<Ranges> ofBlock;

    private:
	bool fillGroups(const Range&, const ContactRows&, const PackedBodies&);
	bool fillLoose(const Range&, const ContactRows&, const PackedBodies&);

	std::vector<uint64_t> marks; // of each packed body, while contacts are grouped
};

} // namespace cd
