#include "sweeps/sweep.hpp"

#include <algorithm>
#include <cassert>

namespace cd {
namespace {

	template <class Space> void solve(LooseContact<Space>& l, PackedBodyIn<Space>* bodies)
	{
		ContactRow<Space>& c = l.row;
		PackedBodyIn<Space>&A = bodies[c.a], &B = bodies[c.b];
		const ImpulseOf<Space> u = relativeVelocity<true>(c, motionOf(A), motionOf(B));
		const ImpulseOf<Space> before = impulseOf(c), p = solveContact(c, inLaw(c, u, before), before);
		push(actionOf(c, p - before), velocityOf(A), l.wa, velocityOf(B), l.wb);
		setImpulse(c, p);
	}

	template <class Space>
	void solveAhead(LooseContact<Space>& l, ImpulseOf<Space>& before, PackedBodyIn<Space>* bodies, double beta, AheadReport& report)
	{
		const ImpulseOf<Space> p = impulseOf(l.row), y = extrapolated(p, before, beta);
		before = p;
		setImpulse(l.row, y);
		solve(l, bodies);
		const ImpulseOf<Space> next = impulseOf(l.row);
		report.change += dot(y - next, y - next);
		report.against += dot(y - next, next - p);
	}

} // namespace

template <class Space>
Sweep<Space>::Sweep(ContactSystem& s, unsigned seed, Threads* t)
    : system(s)
    , kept(s.memory)
    , packed(*kept)
    , problem(packed.problem)
    , order(seed, s.memory)
    , threads(t)
{
	packed.error.prepare(system, problem, problem.pack(system, threads));
	restoreVelocities();
}

template <class Space> void Sweep<Space>::restoreVelocities()
{
	const std::vector<PackedBody>& moved = packed.error.velocities(problem, threads);
	// + 0 turns -0 into +0. A body at rest must stay at +0 whatever is added to it 0 times, or its lanes would differ in sign.
	problem.blocks.inEvery(threads, [&](int32_t block) {
		for (const std::size_t i : problem.bodies.ofBlock[block])
			problem.bodies.now[i] = moved[i].withoutSigns(problem.bodies.now[i].w);
	});
	remembered = false; // what is remembered still contains the round-off
}

template <class Space> double Sweep<Space>::yield() const
{
	const PackedContacts<Space>& contacts = problem.contacts;
	if (contacts.springs.empty())
		return 0;
	double least = 1;
	for (std::size_t k = 0; k < contacts.groups.size(); k++)
		for (int lane = 0; lane < lanes; lane++)
			if (contacts.grouping.members[k * lanes + lane] >= 0)
				least = std::min(least, contacts.springs[k].n[lane] * contacts.groups[k].inverseWnn[lane]);
	for (const LooseContact<Space>& l : contacts.loose)
		if (l.row.wnn > 0)
			least = std::min(least, l.row.cn / l.row.nn());
	return least;
}

template <class Space> void Sweep<Space>::copyTo(Iterate& p) const
{
	p.groups.resize(problem.contacts.groups.size());
	p.loose.resize(problem.contacts.loose.size());
	problem.blocks.inEvery(threads, [&](int32_t block) { problem.contacts.copyTo(p, block); });
}

template <class Space> void Sweep<Space>::copyFrom(const Iterate& p)
{
	assert(p.groups.size() == problem.contacts.groups.size() && p.loose.size() == problem.contacts.loose.size());
	packed.error.impulsesHaveChanged();
	problem.blocks.inEvery(threads, [&](int32_t block) { problem.contacts.copyFrom(p, block); });
}

// Calls work(groups, loose contacts, block of their sums) in the order of the sweep.
template <class Space> template <class Work> void Sweep<Space>::inOrder(const Work& work)
{
	packed.error.impulsesHaveChanged();
	const PackedContacts<Space>& contacts = problem.contacts;
	if (!order)
		return problem.blocks.byColour(
		    threads, [&](int32_t block) { work(contacts.ofBlock[block].groups, contacts.ofBlock[block].loose, block); });
	const std::size_t groups = contacts.groups.size();
	order.visit(groups + contacts.loose.size(), [&](std::size_t i, std::size_t end) {
		if (i < groups)
			work(Range { i, end }, Range {}, 0);
		else
			work(Range {}, Range { i - groups, end - groups }, 0);
	});
}

template <class Space> void Sweep<Space>::operator()()
{
	PackedBody* const bodies = problem.bodies.now.data();
	inOrder([&](const Range& groups, const Range& loose, int32_t) {
		groupKernel<Space>().sweep(
		    problem.contacts.groups.data() + groups.from, problem.contacts.springsFrom(groups.from), groups.size(), bodies);
		for (const std::size_t i : loose)
			solve(problem.contacts.loose[i], bodies);
	});
}

// Velocities are linear in the impulses, so they are extrapolated in the same way.
template <class Space> AheadReport Sweep<Space>::ahead(double beta)
{
	PackedBody* const bodies = problem.bodies.now.data();
	if (!remembered) {
		packed.bodiesBefore = problem.bodies.now;
		copyTo(packed.before);
		remembered = true;
	}
	packed.sums.assign(problem.blocks.count(), {});
	problem.blocks.inEvery(threads, [&](int32_t block) {
		const Range& own = problem.bodies.ofBlock[block];
		groupKernel<Space>().extrapolate(bodies + own.from, &packed.bodiesBefore[own.from], own.size(), beta);
	});
	inOrder([&](const Range& groups, const Range& loose, int32_t block) {
		groupKernel<Space>().sweepAhead(problem.contacts.groups.data() + groups.from, problem.contacts.springsFrom(groups.from),
		    packed.before.groups.data() + groups.from, groups.size(), bodies, beta, packed.sums[block].groups);
		for (const std::size_t i : loose)
			solveAhead(problem.contacts.loose[i], packed.before.loose[i], bodies, beta, packed.sums[block].loose);
	});
	LaneSums sums = {};
	AheadReport report;
	for (const AheadSums& block : packed.sums) {
		for (int lane = 0; lane < lanes; lane++) {
			sums.change[lane] += block.groups.change[lane];
			sums.against[lane] += block.groups.against[lane];
		}
		report.change += block.loose.change;
		report.against += block.loose.against;
	}
	for (int lane = 0; lane < lanes; lane++) {
		report.change += sums.change[lane];
		report.against += sums.against[lane];
	}
	return report;
}

template class Sweep<Plane>;
template class Sweep<RollingPlane>;
template class Sweep<Space3>;

} // namespace cd
