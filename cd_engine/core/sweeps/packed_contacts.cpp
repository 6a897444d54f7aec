#include "sweeps/packed_contacts.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace cd {
namespace {

	bool isGroupable(const ContactRow& c, const PackedBodies& bodies)
	{
		const PackedBodies::Kind &A = bodies.kinds[c.a], &B = bodies.kinds[c.b];
		return c.wnn > 0 && c.diagonal() && c.wtt > 0 && A.uniform && B.uniform && (A.turns || c.at == 0) && (B.turns || c.bt == 0);
	}

	// A row of the step; `made`: room for one that is postponed.
	const ContactRow& rowOf(const ContactRows& rows, int32_t contact, ContactRow& made)
	{
		const RowSource* const step = rows.postponed();
		return step ? made = step->row(contact) : rows[contact];
	}

	void fillLane(Group& g, GroupSprings* springs, int lane, const ContactRow& c, const PackedBodies& bodies)
	{
		g.nx[lane] = c.nx;
		g.ny[lane] = c.ny;
		g.at[lane] = c.at * bodies.inverseRadii[c.a];
		g.bt[lane] = c.bt * bodies.inverseRadii[c.b];
		g.bias[lane] = c.bias;
		g.mu[lane] = c.mu;
		g.pn[lane] = c.pn;
		g.pt[lane] = c.pt;
		g.inverseWnn[lane] = 1 / c.nn();
		g.inverseWtt[lane] = 1 / c.tt();
		if (springs) {
			springs->n[lane] = c.cn;
			springs->t[lane] = c.ct;
			springs->bias[lane] = c.slipBias;
		}
	}

} // namespace

void PackedContacts::group(const ContactRows& rows, const Blocks& blocks, const PackedBodies& bodies)
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

bool PackedContacts::fill(int32_t block, const ContactRows& rows, const PackedBodies& bodies)
{
	return fillGroups(ofBlock[block].groups, rows, bodies) && fillLoose(ofBlock[block].loose, rows, bodies);
}

bool PackedContacts::fillGroups(const Range& which, const ContactRows& rows, const PackedBodies& bodies)
{
	constexpr std::size_t batch = 128; // groups
	ContactRow made;
	uint8_t left[batch]; // of each group: the lanes that are filled from rows, a bit each
	std::fill_n(left, batch, 0xff);
	const auto* const step = dynamic_cast<const GroupSource*>(rows.postponed());
	for (std::size_t from = which.from; from < which.to; from += batch) {
		const std::size_t count = std::min(batch, which.to - from);
		const int32_t* const member = &grouping.members[from * Group::lanes];
		if (step)
			step->fill(member, count, bodies.inverseRadii.data(), &groups[from], left);
		for (std::size_t k = 0; k < count; k++)
			for (unsigned lanes = left[k]; lanes != 0; lanes &= lanes - 1) {
				const int lane = __builtin_ctz(lanes);
				const int32_t contact = member[k * Group::lanes + lane];
				Group& g = groups[from + k];
				if (contact < 0) {
					for (double* const of : { g.nx, g.ny, g.at, g.bt, g.bias, g.mu, g.pn, g.pt, g.inverseWnn, g.inverseWtt })
						of[lane] = 0;
					if (!springs.empty())
						springs[from + k].n[lane] = springs[from + k].t[lane] = springs[from + k].bias[lane] = 0;
					continue;
				}
				const ContactRow& c = rowOf(rows, contact, made);
				fillLane(g, springs.empty() ? nullptr : &springs[from + k], lane, c, bodies);
				if (!isGroupable(c, bodies))
					return false;
			}
	}
	return true;
}

bool PackedContacts::fillLoose(const Range& which, const ContactRows& rows, const PackedBodies& bodies)
{
	for (const std::size_t i : which) {
		LooseContact& l = loose[i];
		const Ends packed { l.row.a, l.row.b };
		l.row = rowOf(rows, grouping.loose[i], l.row);
		const bool same = l.row.wnn > 0 && isGroupable(l.row, bodies) == l.groupable;
		const auto fill = [&](int32_t& body, int32_t place, double& n, double& t, Motion<double>& w) {
			const PackedBodies::Kind& kind = bodies.kinds[body];
			n *= bodies.inverseRadii[body];
			t *= bodies.inverseRadii[body];
			w = { kind.w.x, kind.w.y, kind.w.spin * (kind.radius * kind.radius) };
			body = place;
		};
		fill(l.row.a, packed.a, l.row.an, l.row.at, l.wa);
		fill(l.row.b, packed.b, l.row.bn, l.row.bt, l.wb);
		if (!same)
			return false;
	}
	return true;
}

// std::copy_n would be a call.
void PackedContacts::copyTo(SweptImpulses& p, int32_t block) const
{
	for (const std::size_t k : ofBlock[block].groups) {
		std::memcpy(p.groups[k].pn, groups[k].pn, sizeof groups[k].pn);
		std::memcpy(p.groups[k].pt, groups[k].pt, sizeof groups[k].pt);
	}
	for (const std::size_t i : ofBlock[block].loose)
		p.loose[i] = impulseOf(loose[i].row);
}

void PackedContacts::copyFrom(const SweptImpulses& p, int32_t block)
{
	for (const std::size_t k : ofBlock[block].groups) {
		std::memcpy(groups[k].pn, p.groups[k].pn, sizeof groups[k].pn);
		std::memcpy(groups[k].pt, p.groups[k].pt, sizeof groups[k].pt);
	}
	for (const std::size_t i : ofBlock[block].loose)
		setImpulse(loose[i].row, p.loose[i]);
}

} // namespace cd
