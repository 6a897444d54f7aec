#include "sweeps/packed_contacts.hpp"

#include <algorithm>
#include <cassert>

namespace cd {
namespace {

	template <class Space> bool isGroupable(const ContactRow<Space>& c, const PackedBodies<Space>& bodies)
	{
		const PackedKind<Space>&A = bodies.kinds[c.a], &B = bodies.kinds[c.b];
		return A.uniform && B.uniform && c.groupable(A.turns, B.turns);
	}

	// A row of the step; `made`: room for one that is postponed.
	template <class Space> const ContactRow<Space>& rowOf(const ContactRows<Space>& rows, int32_t contact, ContactRow<Space>& made)
	{
		const RowSource<Space>* const step = rows.postponed();
		return step ? made = step->row(contact) : rows[contact];
	}

} // namespace

template <class Space> void PackedContacts<Space>::group(const ContactRows& rows, const Blocks& blocks, const PackedBodies& bodies)
{
	assert(ends.size() == rows.size());
	marks.assign(bodies.at.size(), 0);
	ofBlock.resize(blocks.count());
	BodyGroups ring(grouping, marks);
	for (std::size_t block = 0; block < blocks.count(); block++) {
		Ranges& own = ofBlock[block];
		own.groups.from = grouping.groups();
		own.loose.from = grouping.loose.size();
		for (const std::size_t k : blocks.contactsOf(block)) {
			const int32_t i = blocks.contacts[k];
			if (isGroupable(rows[i], bodies))
				ring.add({ i, bodies.movable(ends[i].a) ? ends[i].a : ends[i].b, bodies.movable(ends[i].b) ? ends[i].b : ends[i].a });
			else
				grouping.loose.push_back(i);
		}
		ring.end();
		own.groups.to = grouping.groups();
		own.loose.to = grouping.loose.size();
	}
	groups.resize(grouping.groups());
	loose.resize(grouping.loose.size());
	for (std::size_t block = 0; block < blocks.count(); block++) {
		const int32_t nobody = bodies.nobody(static_cast<int32_t>(block));
		for (const std::size_t k : ofBlock[block].lanes()) {
			const int32_t contact = grouping.members[k];
			Group& g = groups[k / Group::lanes];
			g.a[k % Group::lanes] = contact < 0 ? nobody : ends[contact].a;
			g.b[k % Group::lanes] = contact < 0 ? nobody : ends[contact].b;
		}
	}
	for (std::size_t i = 0; i < loose.size(); i++) {
		const int32_t contact = grouping.loose[i];
		loose[i].row.a = ends[contact].a;
		loose[i].row.b = ends[contact].b;
		loose[i].groupable = isGroupable(rows[contact], bodies);
	}
}

template <class Space> bool PackedContacts<Space>::fill(int32_t block, const ContactRows& rows, const PackedBodies& bodies)
{
	return fillGroups(ofBlock[block].groups, rows, bodies) && fillLoose(ofBlock[block].loose, rows, bodies);
}

template <class Space> bool PackedContacts<Space>::fillGroups(const Range& which, const ContactRows& rows, const PackedBodies& bodies)
{
	constexpr std::size_t batch = 128; // groups
	ContactRow<Space> made;
	uint8_t left[batch]; // of each group: the lanes that are filled from rows, a bit each
	std::fill_n(left, batch, 0xff);
	const auto* const step = dynamic_cast<const GroupSource<Space>*>(rows.postponed());
	for (std::size_t from = which.from; from < which.to; from += batch) {
		const std::size_t count = std::min(batch, which.to - from);
		const int32_t* const member = &grouping.members[from * Group::lanes];
		if (step)
			step->fill(member, count, bodies.inverseRadii.data(), &groups[from], springs.empty() ? nullptr : &springs[from], left);
		for (std::size_t k = 0; k < count; k++)
			for (unsigned lanes = left[k]; lanes != 0; lanes &= lanes - 1) {
				const int lane = __builtin_ctz(lanes);
				const int32_t contact = member[k * Group::lanes + lane];
				Group& g = groups[from + k];
				if (contact < 0) {
					g.clear(lane);
					if (!springs.empty())
						springs[from + k].clear(lane);
					continue;
				}
				const ContactRow<Space>& c = rowOf(rows, contact, made);
				g.set(lane, c, bodies.inverseRadii[c.a], bodies.inverseRadii[c.b]);
				if (!springs.empty())
					springs[from + k].set(lane, c);
				if (!isGroupable(c, bodies))
					return false;
			}
	}
	return true;
}

template <class Space> bool PackedContacts<Space>::fillLoose(const Range& which, const ContactRows& rows, const PackedBodies& bodies)
{
	for (const std::size_t i : which) {
		LooseContact& l = loose[i];
		const Ends packed { l.row.a, l.row.b };
		l.row = rowOf(rows, grouping.loose[i], l.row);
		const bool same = l.row.wnn > 0 && isGroupable(l.row, bodies) == l.groupable;
		l.wa = packedMasses(bodies.kinds[l.row.a]);
		l.wb = packedMasses(bodies.kinds[l.row.b]);
		l.row.scaleArms(bodies.inverseRadii[l.row.a], bodies.inverseRadii[l.row.b]);
		l.row.a = packed.a;
		l.row.b = packed.b;
		if (!same)
			return false;
	}
	return true;
}

template <class Space> void PackedContacts<Space>::copyTo(SweptImpulses& p, int32_t block) const
{
	for (const std::size_t k : ofBlock[block].groups)
		copyImpulses(p.groups[k], groups[k]);
	for (const std::size_t i : ofBlock[block].loose)
		p.loose[i] = impulseOf(loose[i].row);
}

template <class Space> void PackedContacts<Space>::copyFrom(const SweptImpulses& p, int32_t block)
{
	for (const std::size_t k : ofBlock[block].groups)
		copyImpulses(groups[k], p.groups[k]);
	for (const std::size_t i : ofBlock[block].loose)
		setImpulse(loose[i].row, p.loose[i]);
}

template class PackedContacts<Plane>;
template class PackedContacts<Space3>;

} // namespace cd
