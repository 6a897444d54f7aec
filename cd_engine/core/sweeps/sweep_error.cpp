// Computes the error of residual.hpp from the packed contacts, in the order of the sweep. This costs about three sweeps instead of
// thirty: a first pass adds up the velocities and what acts on each body, a second one the misses. residual.cpp contains the formulas.
#include "sweeps/sweep.hpp"

#include <algorithm>
#include <limits>

namespace cd {
namespace {

	ResidualSum sumOf(const LaneMisses& all, std::size_t contacts)
	{
		ResidualSum sum;
		sum.contacts = contacts;
		for (int lane = 0; lane < Group::lanes; lane++) {
			sum.difference += all.difference[lane];
			sum.square += all.square[lane];
			sum.differenceEnergy += all.differenceEnergy[lane];
			sum.squareEnergy += all.squareEnergy[lane];
			sum.missed += all.velocity[lane];
			sum.worst = std::max(sum.worst, all.worst[lane]);
			sum.mostMissed = std::max(sum.mostMissed, all.mostVelocity[lane]);
		}
		return sum;
	}

} // namespace

// Recomputes the velocities from all impulses, if any has changed; the member w gets what acts on the body [m/s].
void Sweep::moveBodies()
{
	if (current)
		return;
	current = true;
	std::vector<PackedBody>& moved = packed.moved;
	moved.resize(packed.bodies.size());
	colourByColour([&](const Part& block) { // block.bodies are those that no earlier block has met
		std::fill_n(&moved[block.bodies.from], block.bodies.size(), PackedBody {});
		moved[block.nobody] = {};
		groupKernel().press(packed.groups.data() + block.groups.from, block.groups.size(), moved.data());
	});
	inEveryBlock([&](const Part& block) {
		for (const std::size_t i : block.bodies) {
			const PackedBody& free = packed.freeBodies[i];
			const double w = packed.bodies[i].w; // a body without a uniform inverse mass has no group, so m is 0
			PackedBody& m = moved[i];
			m = { free.vx + w * m.vx, free.vy + w * m.vy, free.spin + w * m.spin, free.w + w * m.w };
		}
	});
	if (packed.loose.empty())
		return;
	colourByColour([&](const Part& block) {
		for (const std::size_t i : block.loose) {
			const Loose& l = packed.loose[i];
			const ContactRow& c = l.row;
			PackedBody &A = moved[c.a], &B = moved[c.b];
			push(l, c.pn, c.pt, A, B);
			A.w += actionOn(l.wa, c, c.an, c.at);
			B.w += actionOn(l.wb, c, c.bn, c.bt);
		}
	});
}

// Adds what external torques do at the contacts: the torque's velocity change times the arm of every contact.
void Sweep::twistBodies()
{
	current = false; // what the torques do is no part of it
	const auto twist = [&](int32_t at, double arm) {
		if (static_cast<std::size_t>(at) < packed.bodyAt.size())
			packed.moved[at].w += system.bodies[packed.bodyAt[at]].twisted * packed.kinds[packed.bodyAt[at]].radius * std::abs(arm);
	};
	colourByColour([&](const Part& block) {
		for (const std::size_t k : block.lanes()) {
			const Group& g = packed.groups[k / Group::lanes];
			twist(g.a[k % Group::lanes], g.at[k % Group::lanes]);
			twist(g.b[k % Group::lanes], g.bt[k % Group::lanes]);
		}
		for (const std::size_t i : block.loose) {
			const ContactRow& c = packed.loose[i].row;
			twist(c.a, c.at);
			twist(c.b, c.bt);
		}
	});
}

// Numbers the sums that make the error: one for every island in every block, in the order of the sweep. Finds the runs of groups with one sum.
void Sweep::numberSums()
{
	packed.islandAt.clear();
	packed.sumOfIsland.assign(packed.partition.islands.size(), { -1, -1 });
	packed.sumOfBody.assign(packed.bodyAt.size(), -1);
	int32_t block = 0;
	for (Part& part : packed.parts) {
		part.sums.from = packed.islandAt.size();
		for (const std::size_t k : part.contacts) {
			const int32_t contact = packed.blocks.contacts[k], island = packed.partition.ofContact[contact];
			Ends& ends = packed.ends[contact];
			auto& [metIn, sum] = packed.sumOfIsland[island];
			if (metIn != block) {
				metIn = block;
				sum = static_cast<int32_t>(packed.islandAt.size());
				packed.islandAt.push_back(island);
			}
			ends.sum = sum;
			for (const int32_t body : { ends.a, ends.b })
				if (packed.sumOfBody[body] < 0 && packed.partition.freedom[packed.bodyAt[body]] > 0)
					packed.sumOfBody[body] = sum;
		}
		part.sums.to = packed.islandAt.size();
		block++;
	}
	packed.runs.clear();
	for (Part& part : packed.parts) {
		part.runs.from = packed.runs.size();
		for (const std::size_t k : part.groups)
			addToRuns(part, k);
		part.runs.to = packed.runs.size();
	}
}

// Adds the group k of a block to its last run, or begins another one.
void Sweep::addToRuns(const Part& part, std::size_t k)
{
	const int32_t* const member = &packed.grouping.members[k * Group::lanes];
	int32_t sum = packed.ends[member[0]].sum; // the first lane is never empty
	std::size_t contacts = 0;
	for (int lane = 0; lane < Group::lanes && member[lane] >= 0; lane++) {
		contacts++;
		if (packed.ends[member[lane]].sum != sum)
			sum = -1;
	}
	if (packed.runs.size() == part.runs.from || packed.runs.back().sum != sum)
		packed.runs.push_back({ { k, k }, sum, 0 });
	packed.runs.back().groups.to++;
	packed.runs.back().contacts += contacts;
}

Residual Sweep::error()
{
	moveBodies();
	if (twisted)
		twistBodies();
	const bool apart = !packed.carried.empty() || std::any_of(packed.runs.begin(), packed.runs.end(), [](const Run& r) { return r.sum < 0; });
	packed.misses.resize(apart ? packed.groups.size() : 0);
	packed.partSums.resize(packed.islandAt.size());
	if (!packed.carried.empty())
		findAsked();
	inEveryBlock([&](const Part& block) { missInBlock(block); });
	packed.sums.assign(packed.partition.islands.size(), {});
	for (std::size_t i = 0; i < packed.partSums.size(); i++)
		packed.sums[packed.islandAt[i]].add(packed.partSums[i]);
	return residual(packed.sums.data(), packed.sums.size());
}

// For each body, the smallest s of the far heavier bodies that it carries.
void Sweep::findAsked()
{
	for (const auto& [light, heavy] : packed.carried)
		packed.asked[light] = std::numeric_limits<double>::infinity();
	for (const auto& [light, heavy] : packed.carried)
		if (packed.moved[heavy].w > 0)
			packed.asked[light] = std::min(packed.asked[light], packed.moved[heavy].w);
}

void Sweep::missInBlock(const Part& block)
{
	ResidualSum* const first = packed.partSums.data() + block.sums.from;
	std::fill_n(first, block.sums.size(), ResidualSum {});
	for (const std::size_t i : block.runs) {
		const Run& run = packed.runs[i];
		LaneMisses all = {};
		GroupMiss* const each = run.sum < 0 || block.underHeavy.size() > 0 ? packed.misses.data() + run.groups.from : nullptr;
		groupKernel().miss(packed.groups.data() + run.groups.from, run.groups.size(), packed.moved.data(), all, each);
		if (run.sum < 0)
			addApart(run.groups);
		else
			packed.partSums[run.sum].add(sumOf(all, run.contacts));
	}
	for (const std::size_t i : block.underHeavy) {
		const UnderHeavy& u = packed.underHeavy[i];
		const double velocity = packed.misses[u.lane / Group::lanes].velocity[u.lane % Group::lanes];
		packed.partSums[u.sum].addUnderHeavy(velocity, std::min(packed.asked[u.a], packed.asked[u.b]));
	}
	const auto moved = [&](int32_t body) {
		const PackedBody& m = packed.moved[body];
		return Moved { { m.vx, m.vy, m.spin }, m.w };
	};
	for (const std::size_t i : block.loose) {
		const ContactRow& c = packed.loose[i].row;
		const Miss miss = missOf(c, c.wnn, moved(c.a), moved(c.b));
		ResidualSum& sum = packed.partSums[packed.loose[i].sum];
		sum.addContact(miss.difference, miss.velocity, c.pn * c.pn + c.pt * c.pt, c.wnn);
		if (!packed.carried.empty())
			sum.addUnderHeavy(miss.velocity, std::min(packed.asked[c.a], packed.asked[c.b]));
	}
	addBodies(block);
}

// Adds the bodies of a block. Most bodies add to the same sum as the one before, whose local copy stays in registers.
void Sweep::addBodies(const Part& block)
{
	ResidualSum sum;
	int32_t at = -1; // place of that sum in partSums
	for (const std::size_t i : block.bodies)
		if (const int32_t own = packed.sumOfBody[i]; own >= 0) {
			if (own != at) {
				if (at >= 0)
					packed.partSums[at] = sum;
				sum = packed.partSums[at = own];
			}
			sum.addBody(packed.masses[i], packed.moved[i].w, packed.bodyAt[i]);
		}
	if (at >= 0)
		packed.partSums[at] = sum;
}

// Adds what the contacts in some groups miss, contact by contact.
void Sweep::addApart(const Range& groups)
{
	for (const std::size_t k : Range { groups.from * Group::lanes, groups.to * Group::lanes })
		if (const int32_t contact = packed.grouping.members[k]; contact >= 0) {
			const Group& g = packed.groups[k / Group::lanes];
			const GroupMiss& miss = packed.misses[k / Group::lanes];
			const int lane = k % Group::lanes;
			const double square = g.pn[lane] * g.pn[lane] + g.pt[lane] * g.pt[lane];
			packed.partSums[packed.ends[contact].sum].addContact(miss.difference[lane], miss.velocity[lane], square, miss.wnn[lane]);
		}
}

} // namespace cd
