#include "sweeps/sweep_error.hpp"

#include <algorithm>
#include <limits>

namespace cd {
namespace {

	constexpr double infinite = std::numeric_limits<double>::infinity();

	ResidualSum sumOf(const LaneMisses& all, std::size_t contacts)
	{
		ResidualSum sum;
		for (int lane = 0; lane < lanes; lane++) {
			ResidualSum one;
			one.difference = all.difference[lane];
			one.square = all.square[lane];
			one.differenceEnergy = all.differenceEnergy[lane];
			one.squareEnergy = all.squareEnergy[lane];
			one.missed = all.missed[lane];
			one.worst = all.worst[lane];
			one.mostMissed = all.mostMissed[lane];
			one.stale = all.stale[lane];
			sum.add(one);
		}
		sum.contacts = contacts;
		return sum;
	}

} // namespace

template <class Space> void SweepError<Space>::prepare(const ContactSystem& system, const PackedProblem& problem, typename PackedProblem::Same same)
{
	current = false;
	if (!same.groups)
		numberSums(problem);
	if (!same.groups || !same.masses)
		findHeavyOnLight(system, problem);
}

template <class Space> void SweepError<Space>::numberSums(const PackedProblem& problem)
{
	const PackedContacts& contacts = problem.contacts;
	islandAt.clear();
	sumOfContact.resize(contacts.ends.size());
	sumOfIsland.assign(problem.partition.islands.size(), { -1, -1 });
	sumOfBody.assign(problem.bodies.at.size(), -1);
	ofBlock.resize(problem.blocks.count());
	runs.clear();
	for (std::size_t block = 0; block < ofBlock.size(); block++) {
		Ranges& own = ofBlock[block];
		own.sums.from = islandAt.size();
		for (const std::size_t k : problem.blocks.contactsOf(block)) {
			const int32_t contact = problem.blocks.contacts[k], island = problem.partition.ofContact[contact];
			auto& [metIn, sum] = sumOfIsland[island];
			if (metIn != static_cast<int32_t>(block)) {
				metIn = static_cast<int32_t>(block);
				sum = static_cast<int32_t>(islandAt.size());
				islandAt.push_back(island);
			}
			sumOfContact[contact] = sum;
			for (const int32_t body : { contacts.ends[contact].a, contacts.ends[contact].b })
				if (sumOfBody[body] < 0 && problem.bodies.movable(body))
					sumOfBody[body] = sum;
		}
		own.sums.to = islandAt.size();
		own.runs.from = runs.size();
		for (const std::size_t k : contacts.ofBlock[block].groups)
			addToRuns(contacts, own, k);
		own.runs.to = runs.size();
	}
}

// Adds the group k of a block to its last run, or begins another one.
template <class Space> void SweepError<Space>::addToRuns(const PackedContacts& contacts, Ranges& block, std::size_t k)
{
	const int32_t* const member = &contacts.grouping.members[k * Group::lanes];
	int32_t sum = sumOfContact[member[0]]; // the first lane is never empty
	std::size_t count = 0;
	for (int lane = 0; lane < Group::lanes && member[lane] >= 0; lane++) {
		count++;
		if (sumOfContact[member[lane]] != sum)
			sum = -1;
	}
	if (runs.size() == block.runs.from || runs.back().sum != sum)
		runs.push_back({ { k, k }, sum, 0 });
	runs.back().groups.to++;
	runs.back().contacts += count;
}

template <class Space> void SweepError<Space>::findHeavyOnLight(const ContactSystem& system, const PackedProblem& problem)
{
	heavyOnLight.clear();
	underHeavy.clear();
	leastHeavy.assign(problem.bodies.now.size(), infinite);
	forEachHeavyOnLight(system, [&](int32_t light, int32_t heavy) {
		heavyOnLight.emplace_back(problem.bodies.place[light], problem.bodies.place[heavy]);
		leastHeavy[problem.bodies.place[light]] = 0; // a mark; findLeastHeavy() computes the values
	});
	for (std::size_t block = 0; block < ofBlock.size(); block++) {
		ofBlock[block].underHeavy.from = underHeavy.size();
		for (const std::size_t k : heavyOnLight.empty() ? Range {} : problem.contacts.ofBlock[block].lanes()) {
			const Group& g = problem.contacts.groups[k / Group::lanes];
			const std::size_t lane = k % Group::lanes;
			if (problem.contacts.grouping.members[k] >= 0 && std::min(leastHeavy[g.a[lane]], leastHeavy[g.b[lane]]) == 0)
				underHeavy.push_back(static_cast<int32_t>(k));
		}
		ofBlock[block].underHeavy.to = underHeavy.size();
	}
}

template <class Space> auto SweepError<Space>::velocities(const PackedProblem& problem, Threads* threads) -> const std::vector<PackedBody>&
{
	if (current)
		return moved;
	current = true;
	const PackedBodies& bodies = problem.bodies;
	const PackedContacts& contacts = problem.contacts;
	moved.resize(bodies.now.size());
	problem.blocks.byColour(threads, [&](int32_t block) { // its bodies are those that no earlier block has met
		const Range &own = bodies.ofBlock[block], &groups = contacts.ofBlock[block].groups;
		std::fill_n(&moved[own.from], own.size(), PackedBody {});
		moved[bodies.nobody(block)] = {};
		groupKernel<Space>().addImpulses(contacts.groups.data() + groups.from, groups.size(), moved.data());
	});
	problem.blocks.inEvery(threads, [&](int32_t block) {
		for (const std::size_t i : bodies.ofBlock[block]) {
			const PackedBody& free = bodies.free[i];
			const double w = bodies.now[i].w; // a body without a uniform inverse mass has no group, so m is 0
			PackedBody& m = moved[i];
			m = free.plus(w, m);
		}
	});
	if (contacts.loose.empty())
		return moved;
	problem.blocks.byColour(threads, [&](int32_t block) {
		for (const std::size_t i : contacts.ofBlock[block].loose) {
			const LooseContact<Space>& l = contacts.loose[i];
			const ImpulseOf<Space> p = impulseOf(l.row);
			PackedBody &A = moved[l.row.a], &B = moved[l.row.b];
			push(actionOf(l.row, p), velocityOf(A), l.wa, velocityOf(B), l.wb);
			A.w += actingOnA(l.wa, l.row, p);
			B.w += actingOnB(l.wb, l.row, p);
		}
	});
	return moved;
}

// Adds what external torques do at the contacts: the torque's velocity change times the arm of every contact.
template <class Space> void SweepError<Space>::twistBodies(const ContactSystem& system, const PackedProblem& problem, Threads* threads)
{
	current = false; // what the torques do is no part of it
	const PackedBodies& bodies = problem.bodies;
	const auto twist = [&](int32_t i, double arm) {
		if (static_cast<std::size_t>(i) < bodies.at.size())
			moved[i].w += system.bodies[bodies.at[i]].twisted * bodies.kinds[bodies.at[i]].radius * arm;
	};
	problem.blocks.byColour(threads, [&](int32_t block) {
		const PackedContacts& contacts = problem.contacts;
		for (const std::size_t k : contacts.ofBlock[block].lanes()) {
			const Group& g = contacts.groups[k / Group::lanes];
			twist(g.a[k % Group::lanes], g.armA(k % Group::lanes));
			twist(g.b[k % Group::lanes], g.armB(k % Group::lanes));
		}
		for (const std::size_t i : contacts.ofBlock[block].loose) {
			const ContactRow<Space>& c = contacts.loose[i].row;
			twist(c.a, c.armA());
			twist(c.b, c.armB());
		}
	});
}

template <class Space> Residual SweepError<Space>::operator()(const ContactSystem& system, const PackedProblem& problem, Threads* threads)
{
	velocities(problem, threads);
	if (problem.twisted)
		twistBodies(system, problem, threads);
	const bool each = !heavyOnLight.empty() || std::any_of(runs.begin(), runs.end(), [](const Run& r) { return r.sum < 0; });
	misses.resize(each ? problem.contacts.groups.size() : 0);
	sums.resize(islandAt.size());
	if (!heavyOnLight.empty())
		findLeastHeavy();
	problem.blocks.inEvery(threads, [&](int32_t block) {
		addContacts(problem.contacts, block);
		addBodies(problem.bodies, block);
	});
	islands.assign(problem.partition.islands.size(), {});
	for (std::size_t i = 0; i < sums.size(); i++)
		islands[islandAt[i]].add(sums[i]);
	return residual(islands.data(), islands.size());
}

template <class Space> void SweepError<Space>::findLeastHeavy()
{
	for (const auto& [light, heavy] : heavyOnLight)
		leastHeavy[light] = infinite;
	for (const auto& [light, heavy] : heavyOnLight)
		if (moved[heavy].w > 0)
			leastHeavy[light] = std::min(leastHeavy[light], moved[heavy].w);
}

template <class Space> void SweepError<Space>::addContacts(const PackedContacts& contacts, int32_t block)
{
	const Ranges& own = ofBlock[block];
	std::fill_n(sums.data() + own.sums.from, own.sums.size(), ResidualSum {});
	for (const std::size_t i : own.runs) {
		const Run& run = runs[i];
		LaneMisses all = {};
		GroupMiss* const each = run.sum < 0 || own.underHeavy.size() > 0 ? misses.data() + run.groups.from : nullptr;
		groupKernel<Space>().miss(
		    contacts.groups.data() + run.groups.from, contacts.springsFrom(run.groups.from), run.groups.size(), moved.data(), all, each);
		if (run.sum < 0)
			addEach(contacts, run.groups);
		else
			sums[run.sum].add(sumOf(all, run.contacts));
	}
	for (const std::size_t i : own.underHeavy) {
		const std::size_t k = underHeavy[i] / Group::lanes, lane = underHeavy[i] % Group::lanes;
		const Group& g = contacts.groups[k];
		sums[sumOfContact[contacts.grouping.members[underHeavy[i]]]].addUnderHeavy(
		    misses[k].velocity[lane], std::min(leastHeavy[g.a[lane]], leastHeavy[g.b[lane]]));
	}
	for (const std::size_t i : contacts.ofBlock[block].loose) {
		const ContactRow<Space>& c = contacts.loose[i].row;
		const PackedBody &A = moved[c.a], &B = moved[c.b];
		const Miss<double> miss = missOf(c, c.nn(), motionOf(A), motionOf(B), A.w + B.w);
		ResidualSum& sum = sums[sumOfContact[contacts.grouping.loose[i]]];
		sum.addContact(miss, impulseOf(c), c.nn());
		if (!heavyOnLight.empty())
			sum.addUnderHeavy(miss.velocity, std::min(leastHeavy[c.a], leastHeavy[c.b]));
	}
}

// Adds what the contacts in some groups miss, contact by contact.
template <class Space> void SweepError<Space>::addEach(const PackedContacts& contacts, const Range& groups)
{
	for (const std::size_t k : Range { groups.from * Group::lanes, groups.to * Group::lanes })
		if (const int32_t contact = contacts.grouping.members[k]; contact >= 0) {
			const Group& g = contacts.groups[k / Group::lanes];
			const GroupMiss& miss = misses[k / Group::lanes];
			const std::size_t lane = k % Group::lanes;
			sums[sumOfContact[contact]].addContact(
			    { miss.difference[lane], miss.velocity[lane] }, g.impulse(lane), 1 / g.inverseWnn[lane]);
		}
}

// Adds the bodies of a block. Most bodies add to the same sum as the one before, whose local copy stays in registers.
template <class Space> void SweepError<Space>::addBodies(const PackedBodies& bodies, int32_t block)
{
	ResidualSum sum;
	int32_t at = -1; // place of that sum
	for (const std::size_t i : bodies.ofBlock[block])
		if (const int32_t own = sumOfBody[i]; own >= 0) {
			if (own != at) {
				if (at >= 0)
					sums[at] = sum;
				sum = sums[at = own];
			}
			sum.addBody(bodies.masses[i], moved[i].w, bodies.at[i]);
		}
	if (at >= 0)
		sums[at] = sum;
}

template class SweepError<Plane>;
template class SweepError<RollingPlane>;
template class SweepError<Space3>;

} // namespace cd
