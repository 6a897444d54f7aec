// Packs the data of a sweep: contacts in blocks and groups of eight, bodies in the order in which the contacts meet them.
#include "sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace cd {

bool Sweep::classifyBodies(bool& sameMasses)
{
	const bool known = packed.kinds.size() == system.bodies.size();
	packed.kinds.resize(system.bodies.size());
	packed.inverseRadii.resize(system.bodies.size());
	struct Same {
		bool kinds, masses, twisted;
	};
	const auto classify = [&](std::size_t from, std::size_t to) {
		Same same { known, known, false };
		for (std::size_t i = from; i < to; i++) {
			const double* const w = system.bodies[i].w;
			same.twisted = same.twisted || system.bodies[i].twisted > 0;
			BodyKind& kind = packed.kinds[i];
			if (known && std::equal(w, w + 3, kind.w))
				continue;
			same.masses = false;
			const bool turns = w[0] > 0 && w[2] > 0, uniform = w[0] == w[1] && (w[0] > 0 || w[2] == 0), movable = w[0] > 0;
			const double k = turns ? std::sqrt(w[0] / w[2]) : 1;
			same.kinds = same.kinds && uniform == kind.uniform && turns == kind.turns && movable == kind.movable;
			kind = { { w[0], w[1], w[2] }, k, uniform, turns, movable };
			packed.inverseRadii[i] = 1 / k;
		}
		return same;
	};
	const Same same = reduceRanges<Same>(threads, system.bodies.size(), classify, [](const Same& a, const Same& b) {
		return Same { a.kinds && b.kinds, a.masses && b.masses, a.twisted || b.twisted };
	});
	sameMasses = same.masses;
	twisted = same.twisted;
	return same.kinds;
}

inline bool Sweep::groupable(const ContactRow& c) const
{
	const BodyKind &A = packed.kinds[c.a], &B = packed.kinds[c.b];
	return c.wnn > 0 && c.diagonal() && c.wtt > 0 && A.uniform && B.uniform && (A.turns || c.at == 0) && (B.turns || c.bt == 0);
}

// Whether the contacts of a block link the same bodies as those that were grouped. Reads the rows in their order, which the processor foresees. They
// are near then when the groups take them out of it.
bool Sweep::sameLinks(std::size_t block) const
{
	bool same = true;
	for (int32_t k = packed.blocks.block[block]; k < packed.blocks.block[block + 1]; k++)
		same = same && packed.partition.links[packed.blocks.contacts[k]] == linkOf(system.contacts[packed.blocks.contacts[k]]);
	return same;
}

// Whether the contacts that no sweep solves, if there are any, are still the same.
bool Sweep::sameLeftOut() const
{
	const std::vector<Link>& links = packed.partition.links;
	return packed.blocks.contacts.size() == links.size()
	    || !anyOf(threads, links.size(), [&](std::size_t i) { return !links[i].solvable && !(links[i] == linkOf(system.contacts[i])); });
}

// Whether sweeps may take the contacts from the step itself: they link the same bodies as those that were grouped, in one island, and no body carries
// one that is far heavier (findAsked); else errors are summed contact by contact, from rows.
bool Sweep::sameContacts() const
{
	return system.contacts.postponed() && !system.contacts.solvedBeside() && packed.contactSet == system.contactSet
	    && packed.blocks.contacts.size() == system.contacts.size() && packed.partition.islands.size() == 1 && packed.carried.empty();
}

void Sweep::groupContacts()
{
	packed.partition.update(system, threads);
	packed.blocks.cut(packed.partition.links, packed.partition.freedom);
	numberBodies();
	packed.builder.begin(packed.bodyAt.size(), system.contacts.size(), packed.grouping);
	for (std::size_t block = 0; block < packed.blocks.count(); block++) {
		packed.begin[block].group = packed.grouping.groups();
		packed.begin[block].loose = packed.grouping.loose.size();
		for (int32_t k = packed.blocks.block[block]; k < packed.blocks.block[block + 1]; k++) {
			const int32_t i = packed.blocks.contacts[k];
			const ContactRow& c = system.contacts[i];
			packed.ends[i].groupable = groupable(c);
			if (packed.ends[i].groupable)
				packed.builder.add(i, packed.ends[i].a, packed.kinds[c.a].movable, packed.ends[i].b, packed.kinds[c.b].movable);
			else
				packed.grouping.loose.push_back(i);
		}
		packed.builder.end();
	}
	packed.begin.back().group = packed.grouping.groups();
	packed.begin.back().loose = packed.grouping.loose.size();
	linkGroups();
	numberSums();
}

void Sweep::linkGroups()
{
	packed.groups.resize(packed.grouping.groups());
	for (std::size_t block = 0; block < packed.blocks.count(); block++)
		for (std::size_t k = packed.begin[block].group * Group::lanes; k < packed.begin[block + 1].group * Group::lanes; k++) {
			const int32_t contact = packed.grouping.members[k];
			Group& g = packed.groups[k / Group::lanes];
			g.a[k % Group::lanes] = contact < 0 ? nobody(block) : packed.ends[contact].a;
			g.b[k % Group::lanes] = contact < 0 ? nobody(block) : packed.ends[contact].b;
		}
}

// Numbers the bodies in the order in which the contacts meet them, so that bodies of near contacts are near in memory.
void Sweep::numberBodies()
{
	const Blocks& blocks = packed.blocks;
	packed.place.assign(system.bodies.size(), -1);
	packed.metIn.assign(system.bodies.size(), -1);
	packed.ends.resize(system.contacts.size());
	packed.begin.resize(blocks.count() + 1);
	int32_t met = 0;
	for (std::size_t block = 0; block < blocks.count(); block++) {
		packed.begin[block].body = met;
		packed.bodyAt.resize(met + system.bodies.size() + 1); // one more, which is written to when no body is fresh
		const auto number = [&](int32_t body) {
			const int32_t in = packed.partition.freedom[body] > 0 ? 0 : static_cast<int32_t>(block);
			const bool fresh = packed.metIn[body] != in;
			const int32_t at = fresh ? met : packed.place[body]; // without a branch, which would be mispredicted half the time
			packed.place[body] = at;
			packed.metIn[body] = in;
			packed.bodyAt[met] = body;
			met += fresh;
			return at;
		};
		for (int32_t k = blocks.block[block]; k < blocks.block[block + 1]; k++) {
			const int32_t i = blocks.contacts[k];
			packed.ends[i].a = number(system.contacts[i].a);
			packed.ends[i].b = number(system.contacts[i].b);
		}
	}
	packed.begin.back().body = met;
	packed.bodyAt.resize(met);
}

void Sweep::findCarried()
{
	packed.carried.clear();
	forEachCarried(system, [&](int32_t light, int32_t heavy) { packed.carried.emplace_back(packed.place[light], packed.place[heavy]); });
}

bool Sweep::fill()
{
	const std::size_t bodies = packed.bodyAt.size();
	packed.loose.resize(packed.grouping.loose.size());
	packed.bodies.resize(bodies + 4 * packed.blocks.count());
	packed.freeBodies.resize(bodies);
	packed.masses.resize(bodies);
	packed.blockSums.resize(packed.blocks.count());
	std::atomic<bool> same { true };
	const bool fromStep = system.contacts.postponed();
	inEveryBlock([&](std::size_t block) {
		if (same && (fromStep ? fillFromStep(block) : sameLinks(block) && fillGroups(block)) && fillLoose(block))
			packBodies(block);
		else
			same = false;
	});
	return same;
}

inline void Sweep::clearLane(Group& g, int lane)
{
	g.nx[lane] = g.ny[lane] = g.at[lane] = g.bt[lane] = g.bias[lane] = g.mu[lane] = g.pn[lane] = g.pt[lane] = 0;
	g.inverseWnn[lane] = g.inverseWtt[lane] = 0;
}

// inverseA, inverseB: 1/k of the bodies.
inline void Sweep::setLane(Group& g, int lane, const ContactRow& c, double inverseA, double inverseB)
{
	g.nx[lane] = c.nx;
	g.ny[lane] = c.ny;
	g.at[lane] = c.at * inverseA;
	g.bt[lane] = c.bt * inverseB;
	g.bias[lane] = c.bias;
	g.mu[lane] = c.mu;
	g.pn[lane] = c.pn;
	g.pt[lane] = c.pt;
	g.inverseWnn[lane] = 1 / c.wnn;
	g.inverseWtt[lane] = 1 / c.wtt;
}

bool Sweep::fillFromStep(std::size_t block)
{
	constexpr std::size_t batch = 128; // groups
	const RowSource& step = *system.contacts.postponed();
	const int32_t* const member = packed.grouping.members.data();
	for (std::size_t from = packed.begin[block].group; from < packed.begin[block + 1].group; from += batch) {
		const std::size_t count = std::min(batch, packed.begin[block + 1].group - from);
		uint8_t left[batch];
		step.fill(member + from * Group::lanes, count, packed.inverseRadii.data(), packed.groups.data() + from, left);
		for (std::size_t k = 0; k < count; k++)
			for (unsigned lanes = left[k]; lanes != 0; lanes &= lanes - 1) {
				Group& g = packed.groups[from + k];
				const int lane = __builtin_ctz(lanes);
				const int32_t contact = member[(from + k) * Group::lanes + lane];
				if (contact < 0) {
					clearLane(g, lane);
					continue;
				}
				const ContactRow c = step.row(contact);
				if (!groupable(c))
					return false;
				setLane(g, lane, c, packed.inverseRadii[c.a], packed.inverseRadii[c.b]);
			}
	}
	return true;
}

bool Sweep::fillGroups(std::size_t block)
{
	const int32_t* member = packed.grouping.members.data() + packed.begin[block].group * Group::lanes;
	for (std::size_t k = packed.begin[block].group; k < packed.begin[block + 1].group; k++) {
		Group& g = packed.groups[k];
		bool same = true;
		for (int lane = 0; lane < Group::lanes; lane++, member++) {
			if (*member < 0) {
				clearLane(g, lane);
				continue;
			}
			const ContactRow& c = system.contacts[*member];
			same = same && groupable(c);
			setLane(g, lane, c, packed.inverseRadii[c.a], packed.inverseRadii[c.b]);
		}
		if (!same)
			return false;
	}
	return true;
}

bool Sweep::fillLoose(std::size_t block)
{
	for (std::size_t i = packed.begin[block].loose; i < packed.begin[block + 1].loose; i++) {
		Loose& l = packed.loose[i];
		const int32_t contact = packed.grouping.loose[i];
		l.row = system.contacts.postponed() ? system.contacts.postponed()->row(contact) : system.contacts[contact];
		if (!(l.row.wnn > 0) || groupable(l.row) != packed.ends[contact].groupable)
			return false;
		const auto fill = [&](int32_t& body, int32_t place, double& n, double& t, double* w) {
			std::copy_n(system.bodies[body].w, 3, w);
			const BodyKind& kind = packed.kinds[body];
			n *= packed.inverseRadii[body];
			t *= packed.inverseRadii[body];
			w[2] *= kind.radius * kind.radius;
			body = place;
		};
		fill(l.row.a, packed.ends[contact].a, l.row.an, l.row.at, l.wa);
		fill(l.row.b, packed.ends[contact].b, l.row.bn, l.row.bt, l.wb);
	}
	return true;
}

void Sweep::packBodies(std::size_t block)
{
	for (std::size_t i = packed.begin[block].body; i < packed.begin[block + 1].body; i++) {
		if (i + soon < packed.begin[block + 1].body)
			__builtin_prefetch(&system.bodies[packed.bodyAt[i + soon]]);
		const BodyVelocity& b = system.bodies[packed.bodyAt[i]];
		packed.bodies[i].w = b.w[0];
		packed.freeBodies[i] = { b.v[0], b.v[1], b.v[2] * packed.kinds[packed.bodyAt[i]].radius, b.pushed };
		const double inverse = std::max(b.w[0], b.w[1]);
		packed.masses[i] = inverse > 0 ? 1 / inverse : 0;
	}
	packed.bodies[nobody(block)] = {};
}

} // namespace cd
