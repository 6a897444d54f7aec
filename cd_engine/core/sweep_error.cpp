// The error of residual.hpp from packed contacts, in the order of the sweep: it costs two to three sweeps, and not thirty. residual.cpp has the
// formulas.
#include "sweep.hpp"

#include <algorithm>
#include <limits>

namespace cd {

// Velocities anew from all impulses, and in place of w what acts on the body [m/s].
void Sweep::moveBodies()
{
	std::vector<PackedBody>& moved = packed.moved;
	moved.resize(packed.bodies.size());
	inEveryBlock([&](std::size_t block) {
		std::fill(moved.data() + packed.begin[block].body, moved.data() + packed.begin[block + 1].body, PackedBody {});
		moved[nobody(block)] = {};
	});
	colourByColour([&](std::size_t block) {
		const std::size_t first = packed.begin[block].group;
		groupKernel().press(packed.groups.data() + first, packed.begin[block + 1].group - first, moved.data());
	});
	inEveryBlock([&](std::size_t block) {
		for (std::size_t i = packed.begin[block].body; i < packed.begin[block + 1].body; i++) {
			const PackedBody& free = packed.freeBodies[i];
			const double w = packed.bodies[i].w; // of what is not uniform nothing has been pressed
			PackedBody& m = moved[i];
			m = { free.vx + w * m.vx, free.vy + w * m.vy, free.spin + w * m.spin, free.w + w * m.w };
		}
	});
	if (packed.loose.empty())
		return;
	colourByColour([&](std::size_t block) {
		for (std::size_t i = packed.begin[block].loose; i < packed.begin[block + 1].loose; i++) {
			const Loose& l = packed.loose[i];
			const ContactRow& c = l.row;
			const double px = c.nx * c.pn - c.ny * c.pt, py = c.ny * c.pn + c.nx * c.pt;
			PackedBody &A = moved[c.a], &B = moved[c.b];
			A.vx -= l.wa[0] * px;
			A.vy -= l.wa[1] * py;
			A.spin -= l.wa[2] * (c.an * c.pn + c.at * c.pt);
			A.w += actionOn(l.wa, c, c.an, c.at);
			B.vx += l.wb[0] * px;
			B.vy += l.wb[1] * py;
			B.spin += l.wb[2] * (c.bn * c.pn + c.bt * c.pt);
			B.w += actionOn(l.wb, c, c.bn, c.bt);
		}
	});
}

// What acts on bodies that external forces turn, by every contact's arm.
void Sweep::twistBodies()
{
	const auto twist = [&](int32_t at, double arm) {
		if (static_cast<std::size_t>(at) < packed.bodyAt.size())
			packed.moved[at].w += system.bodies[packed.bodyAt[at]].twisted * packed.kinds[packed.bodyAt[at]].radius * std::abs(arm);
	};
	colourByColour([&](std::size_t block) {
		for (std::size_t k = packed.begin[block].group; k < packed.begin[block + 1].group; k++)
			for (int lane = 0; lane < Group::lanes; lane++) {
				const Group& g = packed.groups[k];
				twist(g.a[lane], g.at[lane]);
				twist(g.b[lane], g.bt[lane]);
			}
		for (std::size_t i = packed.begin[block].loose; i < packed.begin[block + 1].loose; i++) {
			const ContactRow& c = packed.loose[i].row;
			twist(c.a, c.at);
			twist(c.b, c.bt);
		}
	});
}

Miss Sweep::missOf(const Loose& l) const
{
	const auto at = [&](int32_t body) {
		return Moved { { packed.moved[body].vx, packed.moved[body].vy, packed.moved[body].spin }, packed.moved[body].w };
	};
	return cd::missOf(l.row, l.row.wnn, at(l.row.a), at(l.row.b));
}

Residual Sweep::error()
{
	moveBodies();
	if (twisted)
		twistBodies();
	std::vector<ResidualSum>& sums = packed.sums;
	sums.assign(packed.partition.islands.size(), {});
	const bool apart = sums.size() > 1 || !packed.carried.empty(); // else all that is asked of the groups are their sums
	packed.misses.resize(apart ? packed.groups.size() : 0);
	inEveryBlock([&](std::size_t block) { missInBlock(block, apart); });
	if (apart)
		addApart();
	else if (!sums.empty())
		addTogether();
	for (std::size_t i = 0; i < packed.loose.size(); i++) {
		const ContactRow& c = packed.loose[i].row;
		const Miss miss = missOf(packed.loose[i]);
		sums[packed.partition.ofContact[packed.grouping.loose[i]]].addContact(
		    miss.difference, miss.velocity, c.pn * c.pn + c.pt * c.pt, c.wnn);
	}
	addBodies();
	if (!packed.carried.empty())
		addCarried();
	return residual(sums.data(), sums.size());
}

void Sweep::missInBlock(std::size_t block, bool apart)
{
	const Begin &begin = packed.begin[block], &end = packed.begin[block + 1];
	BlockSums& sums = packed.blockSums[block];
	sums.misses = {};
	groupKernel().miss(packed.groups.data() + begin.group, end.group - begin.group, packed.moved.data(), sums.misses,
	    apart ? packed.misses.data() + begin.group : nullptr);
	if (packed.sums.size() > 1)
		return;
	ResidualSum all; // of its own, so that it stays in registers
	for (std::size_t i = begin.body; i < end.body; i++)
		if (packed.masses[i] > 0 || packed.partition.ofBody[packed.bodyAt[i]] >= 0) // it can move
			all.addBody(packed.masses[i], packed.moved[i].w, packed.bodyAt[i]);
	sums.bodies = all;
}

void Sweep::addBodies()
{
	if (packed.sums.size() == 1)
		for (const BlockSums& of : packed.blockSums)
			packed.sums.front().addBodies(of.bodies);
	else
		for (std::size_t i = 0; i < packed.bodyAt.size(); i++)
			if (const int32_t island = packed.partition.ofBody[packed.bodyAt[i]]; island >= 0)
				packed.sums[island].addBody(packed.masses[i], packed.moved[i].w, packed.bodyAt[i]);
}

void Sweep::addTogether()
{
	ResidualSum& sum = packed.sums.front();
	sum.contacts = packed.blocks.contacts.size() - packed.loose.size();
	LaneMisses all = packed.blockSums[0].misses;
	for (std::size_t block = 1; block < packed.blocks.count(); block++) {
		const LaneMisses& of = packed.blockSums[block].misses;
		for (int lane = 0; lane < Group::lanes; lane++) {
			all.difference[lane] += of.difference[lane];
			all.square[lane] += of.square[lane];
			all.differenceEnergy[lane] += of.differenceEnergy[lane];
			all.squareEnergy[lane] += of.squareEnergy[lane];
			all.velocity[lane] += of.velocity[lane];
			all.worst[lane] = std::max(all.worst[lane], of.worst[lane]);
			all.mostVelocity[lane] = std::max(all.mostVelocity[lane], of.mostVelocity[lane]);
		}
	}
	for (int lane = 0; lane < Group::lanes; lane++) {
		sum.difference += all.difference[lane];
		sum.square += all.square[lane];
		sum.differenceEnergy += all.differenceEnergy[lane];
		sum.squareEnergy += all.squareEnergy[lane];
		sum.missed += all.velocity[lane];
		sum.worst = std::max(sum.worst, all.worst[lane]);
		sum.mostMissed = std::max(sum.mostMissed, all.mostVelocity[lane]);
	}
}

void Sweep::addApart()
{
	for (std::size_t k = 0; k < packed.grouping.members.size(); k++)
		if (const int32_t contact = packed.grouping.members[k]; contact >= 0) {
			const Group& g = packed.groups[k / Group::lanes];
			const GroupMiss& miss = packed.misses[k / Group::lanes];
			const int lane = k % Group::lanes;
			const double square = g.pn[lane] * g.pn[lane] + g.pt[lane] * g.pt[lane];
			packed.sums[packed.partition.ofContact[contact]].addContact(
			    miss.difference[lane], miss.velocity[lane], square, system.contacts[contact].wnn);
		}
}

// The contacts of bodies that touch one ten times heavier.
void Sweep::addCarried()
{
	constexpr double none = std::numeric_limits<double>::infinity();
	std::vector<double>& asked = packed.asked;
	asked.assign(packed.moved.size(), none);
	for (const auto& [light, heavy] : packed.carried)
		if (packed.moved[heavy].w > 0)
			asked[light] = std::min(asked[light], packed.moved[heavy].w);
	for (std::size_t k = 0; k < packed.grouping.members.size(); k++)
		if (const int32_t contact = packed.grouping.members[k]; contact >= 0) {
			const Group& g = packed.groups[k / Group::lanes];
			const int lane = k % Group::lanes;
			packed.sums[packed.partition.ofContact[contact]].addUnderHeavy(
			    packed.misses[k / Group::lanes].velocity[lane], std::min(asked[g.a[lane]], asked[g.b[lane]]));
		}
	for (std::size_t i = 0; i < packed.loose.size(); i++) {
		const Loose& l = packed.loose[i];
		packed.sums[packed.partition.ofContact[packed.grouping.loose[i]]].addUnderHeavy(
		    missOf(l).velocity, std::min(asked[l.row.a], asked[l.row.b]));
	}
}

} // namespace cd
