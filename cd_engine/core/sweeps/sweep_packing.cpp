// Packs the data of a sweep: contacts in blocks and groups of eight, bodies in the order in which the contacts meet them.
#include "sweeps/sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace cd {

Sweep::Same Sweep::classifyBodies()
{
	const bool known = packed.kinds.size() == system.bodies.size();
	packed.kinds.resize(system.bodies.size());
	packed.inverseRadii.resize(system.bodies.size());
	const auto classify = [&](std::size_t from, std::size_t to) {
		Same same { known, known, false };
		for (std::size_t i = from; i < to; i++) {
			const double* const w = system.bodies[i].w;
			same.twisted = same.twisted || system.bodies[i].twisted > 0;
			BodyKind& kind = packed.kinds[i];
			if (known && std::equal(w, w + 3, kind.w))
				continue;
			same.masses = false;
			const bool turns = w[0] > 0 && w[2] > 0, uniform = w[0] == w[1] && (w[0] > 0 || w[2] == 0);
			const double k = turns ? std::sqrt(w[0] / w[2]) : 1;
			same.kinds = same.kinds && uniform == kind.uniform && turns == kind.turns;
			kind = { { w[0], w[1], w[2] }, k, uniform, turns };
			packed.inverseRadii[i] = 1 / k;
		}
		return same;
	};
	const auto both = [](const Same& a, const Same& b) { return Same { a.kinds && b.kinds, a.masses && b.masses, a.twisted || b.twisted }; };
	return reduceRanges<Same>(threads, system.bodies.size(), classify, both);
}

inline bool Sweep::groupable(const ContactRow& c) const
{
	const BodyKind &A = packed.kinds[c.a], &B = packed.kinds[c.b];
	return c.wnn > 0 && c.diagonal() && c.wtt > 0 && A.uniform && B.uniform && (A.turns || c.at == 0) && (B.turns || c.bt == 0);
}

void Sweep::groupContacts()
{
	packed.blocks.cut(packed.partition.links, packed.partition.freedom);
	numberBodies();
	packed.grouped.assign(packed.bodyAt.size(), 0);
	Grouping& grouping = packed.grouping;
	BodyGroups groups(grouping, packed.grouped);
	for (Part& block : packed.parts) {
		block.groups.from = grouping.groups();
		block.loose.from = grouping.loose.size();
		for (const std::size_t k : block.contacts) {
			const int32_t i = packed.blocks.contacts[k];
			const ContactRow& c = system.contacts[i];
			Ends& ends = packed.ends[i];
			ends.groupable = groupable(c);
			const bool movesA = packed.partition.freedom[c.a] > 0, movesB = packed.partition.freedom[c.b] > 0;
			if (ends.groupable)
				groups.add({ i, movesA ? ends.a : ends.b, movesB ? ends.b : ends.a });
			else
				grouping.loose.push_back(i);
		}
		groups.end();
		block.groups.to = grouping.groups();
		block.loose.to = grouping.loose.size();
	}
	packed.groups.resize(grouping.groups());
	for (const Part& block : packed.parts)
		for (const std::size_t k : block.lanes()) {
			const int32_t contact = grouping.members[k];
			Group& g = packed.groups[k / Group::lanes];
			g.a[k % Group::lanes] = contact < 0 ? block.nobody : packed.ends[contact].a;
			g.b[k % Group::lanes] = contact < 0 ? block.nobody : packed.ends[contact].b;
		}
	numberSums();
}

// Numbers the bodies in the order in which the contacts meet them, so that bodies of near contacts are near in memory.
void Sweep::numberBodies()
{
	const Blocks& blocks = packed.blocks;
	packed.place.assign(system.bodies.size(), -1);
	packed.metIn.assign(system.bodies.size(), -1);
	packed.ends.resize(system.contacts.size());
	packed.parts.resize(blocks.count());
	packed.bodyAt.clear();
	for (std::size_t block = 0; block < blocks.count(); block++) {
		Part& part = packed.parts[block];
		part.contacts = { static_cast<std::size_t>(blocks.block[block]), static_cast<std::size_t>(blocks.block[block + 1]) };
		part.bodies.from = packed.bodyAt.size();
		const auto number = [&](int32_t body) {
			const int32_t in = packed.partition.freedom[body] > 0 ? 0 : static_cast<int32_t>(block);
			if (std::exchange(packed.metIn[body], in) != in) {
				packed.place[body] = static_cast<int32_t>(packed.bodyAt.size());
				packed.bodyAt.push_back(body);
			}
			return packed.place[body];
		};
		for (const std::size_t k : part.contacts) {
			const int32_t i = blocks.contacts[k];
			packed.ends[i].a = number(system.contacts[i].a);
			packed.ends[i].b = number(system.contacts[i].b);
		}
		part.bodies.to = packed.bodyAt.size();
	}
	auto nobody = static_cast<int32_t>(packed.bodyAt.size());
	for (Part& part : packed.parts) {
		part.nobody = nobody;
		nobody += 4;
	}
}

void Sweep::findCarried()
{
	packed.carried.clear();
	packed.underHeavy.clear();
	packed.asked.assign(packed.bodies.size(), std::numeric_limits<double>::infinity());
	forEachCarried(system, [&](int32_t light, int32_t heavy) {
		packed.carried.emplace_back(packed.place[light], packed.place[heavy]);
		packed.asked[packed.place[light]] = 0; // a mark; findAsked() computes the values
	});
	for (Part& block : packed.parts) {
		block.underHeavy.from = packed.underHeavy.size();
		for (const std::size_t k : packed.carried.empty() ? Range {} : block.lanes())
			if (const int32_t contact = packed.grouping.members[k]; contact >= 0) {
				const Ends& ends = packed.ends[contact];
				if (std::min(packed.asked[ends.a], packed.asked[ends.b]) == 0)
					packed.underHeavy.push_back({ k, ends.a, ends.b, ends.sum });
			}
		block.underHeavy.to = packed.underHeavy.size();
	}
}

bool Sweep::fill()
{
	const std::size_t bodies = packed.bodyAt.size();
	packed.loose.resize(packed.grouping.loose.size());
	packed.bodies.resize(bodies + 4 * packed.parts.size());
	packed.freeBodies.resize(bodies);
	packed.masses.resize(bodies);
	std::atomic<bool> same { true };
	inEveryBlock([&](const Part& block) {
		if (same && fillGroups(block) && fillLoose(block))
			packBodies(block);
		else
			same = false;
	});
	return same;
}

// `made`: for a row that the step has not made.
inline const ContactRow& Sweep::rowOf(int32_t contact, ContactRow& made) const
{
	const RowSource* const step = system.contacts.postponed();
	return step ? made = step->row(contact) : system.contacts[contact];
}

// Returns false if the contact may not be in a group.
inline bool Sweep::fillLane(Group& g, int lane, const ContactRow& c) const
{
	g.nx[lane] = c.nx;
	g.ny[lane] = c.ny;
	g.at[lane] = c.at * packed.inverseRadii[c.a];
	g.bt[lane] = c.bt * packed.inverseRadii[c.b];
	g.bias[lane] = c.bias;
	g.mu[lane] = c.mu;
	g.pn[lane] = c.pn;
	g.pt[lane] = c.pt;
	g.inverseWnn[lane] = 1 / c.wnn;
	g.inverseWtt[lane] = 1 / c.wtt;
	return groupable(c);
}

bool Sweep::fillGroups(const Part& block)
{
	constexpr std::size_t batch = 128; // groups
	ContactRow made;
	uint8_t left[batch]; // of each group: the lanes that are filled from rows, a bit each
	std::fill_n(left, batch, 0xff);
	for (std::size_t from = block.groups.from; from < block.groups.to; from += batch) {
		const std::size_t count = std::min(batch, block.groups.to - from);
		const int32_t* const member = &packed.grouping.members[from * Group::lanes];
		if (const RowSource* const step = system.contacts.postponed())
			step->fill(member, count, packed.inverseRadii.data(), &packed.groups[from], left);
		for (std::size_t k = 0; k < count; k++)
			for (unsigned lanes = left[k]; lanes != 0; lanes &= lanes - 1) {
				const int lane = __builtin_ctz(lanes);
				const int32_t contact = member[k * Group::lanes + lane];
				Group& g = packed.groups[from + k];
				if (contact < 0)
					for (double* const of : { g.nx, g.ny, g.at, g.bt, g.bias, g.mu, g.pn, g.pt, g.inverseWnn, g.inverseWtt })
						of[lane] = 0;
				else if (!fillLane(g, lane, rowOf(contact, made)))
					return false;
			}
	}
	return true;
}

bool Sweep::fillLoose(const Part& block)
{
	for (const std::size_t i : block.loose) {
		ContactRow& c = packed.loose[i].row;
		const int32_t contact = packed.grouping.loose[i];
		packed.loose[i].sum = packed.ends[contact].sum;
		c = rowOf(contact, c);
		if (!(c.wnn > 0) || groupable(c) != packed.ends[contact].groupable)
			return false;
		const auto fill = [&](int32_t& body, int32_t place, double& n, double& t, double* w) {
			std::copy_n(system.bodies[body].w, 3, w);
			const BodyKind& kind = packed.kinds[body];
			n *= packed.inverseRadii[body];
			t *= packed.inverseRadii[body];
			w[2] *= kind.radius * kind.radius;
			body = place;
		};
		fill(c.a, packed.ends[contact].a, c.an, c.at, packed.loose[i].wa);
		fill(c.b, packed.ends[contact].b, c.bn, c.bt, packed.loose[i].wb);
	}
	return true;
}

void Sweep::packBodies(const Part& block)
{
	for (const std::size_t i : block.bodies) {
		if (i + soon < block.bodies.to) {
			__builtin_prefetch(&system.bodies[packed.bodyAt[i + soon]]);
			__builtin_prefetch(&packed.kinds[packed.bodyAt[i + soon]]);
		}
		const BodyVelocity& b = system.bodies[packed.bodyAt[i]];
		packed.bodies[i].w = b.w[0];
		packed.freeBodies[i] = { b.v[0], b.v[1], b.v[2] * packed.kinds[packed.bodyAt[i]].radius, b.pushed };
		const double inverse = std::max(b.w[0], b.w[1]);
		packed.masses[i] = inverse > 0 ? 1 / inverse : 0;
	}
	packed.bodies[block.nobody] = {};
}

} // namespace cd
