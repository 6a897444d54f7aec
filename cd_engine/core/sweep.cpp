#include "sweep.hpp"
#include "local_problem.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace cd {
namespace {

	AheadReport total(const LaneSums& sums, AheadReport report)
	{
		for (int lane = 0; lane < Group::lanes; lane++) {
			report.change += sums.change[lane];
			report.against += sums.against[lane];
		}
		return report;
	}

	// Of a group. std::copy_n would be a call.
	template <class From, class To> void copyImpulses(const From& from, To& to)
	{
		std::memcpy(to.pn, from.pn, sizeof to.pn);
		std::memcpy(to.pt, from.pt, sizeof to.pt);
	}

} // namespace

Sweep::Sweep(ContactSystem& s, unsigned seed, Threads* t)
    : system(s)
    , kept(s.memory)
    , packed(*kept)
    , order(seed, s.memory)
    , threads(t)
{
	bool sameMasses = true;
	const bool sameKinds = classifyBodies(sameMasses);
	if (!sameKinds || !sameMasses || !sameContacts())
		system.contacts.make();
	const bool same = sameKinds && !packed.begin.empty() && packed.partition.links.size() == system.contacts.size() && sameLeftOut() && fill();
	if (!same) {
		system.contacts.make();
		groupContacts();
		fill();
	}
	packed.contactSet = system.contactSet;
	if (!same || !sameMasses)
		findCarried();
	restoreVelocities();
}

void Sweep::restoreVelocities()
{
	moveBodies();
	// + 0 turns -0 into +0. A body at rest must stay at +0 whatever is added to it 0 times, or its lanes would differ in sign.
	inEveryBlock([&](std::size_t block) {
		for (std::size_t i = packed.begin[block].body; i < packed.begin[block + 1].body; i++) {
			const PackedBody& m = packed.moved[i];
			packed.bodies[i] = { m.vx + 0., m.vy + 0., m.spin + 0., packed.bodies[i].w };
		}
	});
	remembered = false; // the arrays named `before` still contain the round-off
}

void Sweep::store()
{
	double* const beside = system.contacts.postponed() ? system.contacts.storeBeside() : nullptr;
	const auto store = [&](int32_t contact, double pn, double pt) {
		if (beside) {
			beside[2 * contact] = pn;
			beside[2 * contact + 1] = pt;
			return;
		}
		system.contacts[contact].pn = pn;
		system.contacts[contact].pt = pt;
	};
	inEveryBlock([&](std::size_t block) {
		const Begin &begin = packed.begin[block], &end = packed.begin[block + 1];
		for (std::size_t k = begin.group * Group::lanes; k < end.group * Group::lanes; k++)
			if (packed.grouping.members[k] >= 0) {
				const Group& g = packed.groups[k / Group::lanes];
				store(packed.grouping.members[k], g.pn[k % Group::lanes], g.pt[k % Group::lanes]);
			}
		for (std::size_t i = begin.loose; i < end.loose; i++)
			store(packed.grouping.loose[i], packed.loose[i].row.pn, packed.loose[i].row.pt);
		for (std::size_t i = begin.body; i < end.body; i++) {
			if (i + soon < end.body)
				__builtin_prefetch(&system.bodies[packed.bodyAt[i + soon]], 1);
			if (packed.partition.freedom[packed.bodyAt[i]] == 0)
				continue; // immobile: keeps its velocity
			BodyVelocity& b = system.bodies[packed.bodyAt[i]];
			const PackedBody& v = packed.bodies[i];
			b.v[0] = v.vx;
			b.v[1] = v.vy;
			// Adds only the change, so that a spin that nothing changes stays the same to the last bit.
			b.v[2] += (v.spin - packed.freeBodies[i].spin) * packed.inverseRadii[packed.bodyAt[i]];
		}
	});
}

void Sweep::copyTo(Iterate& p) const
{
	p.groups.resize(packed.groups.size());
	p.loose.resize(2 * packed.loose.size());
	inEveryBlock([&](std::size_t block) {
		for (std::size_t k = packed.begin[block].group; k < packed.begin[block + 1].group; k++)
			copyImpulses(packed.groups[k], p.groups[k]);
		for (std::size_t i = packed.begin[block].loose; i < packed.begin[block + 1].loose; i++) {
			p.loose[2 * i] = packed.loose[i].row.pn;
			p.loose[2 * i + 1] = packed.loose[i].row.pt;
		}
	});
}

void Sweep::copyFrom(const Iterate& p)
{
	current = false;
	inEveryBlock([&](std::size_t block) {
		for (std::size_t k = packed.begin[block].group; k < packed.begin[block + 1].group; k++)
			copyImpulses(p.groups[k], packed.groups[k]);
		for (std::size_t i = packed.begin[block].loose; i < packed.begin[block + 1].loose; i++) {
			packed.loose[i].row.pn = p.loose[2 * i];
			packed.loose[i].row.pt = p.loose[2 * i + 1];
		}
	});
}

void Sweep::solveLoose(Loose& l, PackedBody* bodies)
{
	ContactRow& c = l.row;
	PackedBody &A = bodies[c.a], &B = bodies[c.b];
	const double dx = B.vx - A.vx, dy = B.vy - A.vy;
	const double un = c.nx * dx + c.ny * dy + (c.bn * B.spin - c.an * A.spin) + c.bias;
	const double ut = c.nx * dy - c.ny * dx + (c.bt * B.spin - c.at * A.spin);
	double pn, pt;
	if (c.wnt == 0 && c.wtt > 0) {
		pn = std::max(0., c.pn - un / c.wnn);
		pt = std::max(-c.mu * pn, std::min(c.mu * pn, c.pt - ut / c.wtt));
	} else {
		const double qn = un - (c.wnn * c.pn + c.wnt * c.pt), qt = ut - (c.wnt * c.pn + c.wtt * c.pt);
		solveLocal(c.wnn, c.wnt, c.wnt, c.wtt, c.mu, qn, qt, pn, pt);
	}
	const double dn = pn - c.pn, dt = pt - c.pt;
	c.pn = pn;
	c.pt = pt;
	const double px = c.nx * dn - c.ny * dt, py = c.ny * dn + c.nx * dt;
	A.vx -= l.wa[0] * px;
	A.vy -= l.wa[1] * py;
	A.spin -= l.wa[2] * (c.an * dn + c.at * dt);
	B.vx += l.wb[0] * px;
	B.vy += l.wb[1] * py;
	B.spin += l.wb[2] * (c.bn * dn + c.bt * dt);
}

inline void Sweep::solveAhead(Loose& l, PackedBody* bodies, double beta, AheadReport& report)
{
	ContactRow& c = l.row;
	const double n = c.pn, t = c.pt;
	const double yn = n + beta * (n - l.beforePn), yt = t + beta * (t - l.beforePt);
	l.beforePn = n;
	l.beforePt = t;
	c.pn = yn;
	c.pt = yt;
	solveLoose(l, bodies);
	const double dn = yn - c.pn, dt = yt - c.pt;
	report.change += dn * dn + dt * dt;
	report.against += dn * (c.pn - n) + dt * (c.pt - t);
}

// Velocities are linear in the impulses, so they are extrapolated in the same way.
AheadReport Sweep::ahead(double beta)
{
	current = false;
	if (!remembered)
		remember();
	inEveryBlock([&](std::size_t block) {
		const std::size_t first = packed.begin[block].body, end = packed.begin[block + 1].body;
		groupKernel().extrapolate(packed.bodies.data() + first, packed.bodiesBefore.data() + first, end - first, beta);
	});
	if (order)
		return aheadAtRandom(beta);
	colourByColour([&](std::size_t block) { aheadInBlock(block, beta); });
	LaneSums sums = packed.blockSums[0].ahead;
	AheadReport report = packed.blockSums[0].aheadLoose;
	for (std::size_t block = 1; block < packed.blocks.count(); block++) {
		const BlockSums& of = packed.blockSums[block];
		for (int lane = 0; lane < Group::lanes; lane++) {
			sums.change[lane] += of.ahead.change[lane];
			sums.against[lane] += of.ahead.against[lane];
		}
		report.change += of.aheadLoose.change;
		report.against += of.aheadLoose.against;
	}
	return total(sums, report);
}

void Sweep::aheadInBlock(std::size_t block, double beta)
{
	const Begin &begin = packed.begin[block], &end = packed.begin[block + 1];
	BlockSums& sums = packed.blockSums[block];
	sums.ahead = {};
	sums.aheadLoose = {};
	groupKernel().sweepAhead(packed.groups.data() + begin.group, packed.groupsBefore.data() + begin.group, end.group - begin.group,
	    packed.bodies.data(), beta, sums.ahead);
	for (std::size_t i = begin.loose; i < end.loose; i++)
		solveAhead(packed.loose[i], packed.bodies.data(), beta, sums.aheadLoose);
}

AheadReport Sweep::aheadAtRandom(double beta)
{
	LaneSums sums = {};
	AheadReport report;
	const std::size_t groups = packed.groups.size();
	for (const auto i : order.next(groups + packed.loose.size())) {
		if (static_cast<std::size_t>(i) < groups)
			groupKernel().sweepAhead(&packed.groups[i], &packed.groupsBefore[i], 1, packed.bodies.data(), beta, sums);
		else
			solveAhead(packed.loose[i - groups], packed.bodies.data(), beta, report);
	}
	return total(sums, report);
}

void Sweep::remember()
{
	packed.bodiesBefore.resize(packed.bodies.size());
	packed.groupsBefore.resize(packed.groups.size());
	inEveryBlock([&](std::size_t block) {
		const Begin &begin = packed.begin[block], &end = packed.begin[block + 1];
		std::copy_n(packed.bodies.data() + begin.body, end.body - begin.body, packed.bodiesBefore.data() + begin.body);
		for (std::size_t k = begin.group; k < end.group; k++)
			copyImpulses(packed.groups[k], packed.groupsBefore[k]);
		for (std::size_t i = begin.loose; i < end.loose; i++) {
			packed.loose[i].beforePn = packed.loose[i].row.pn;
			packed.loose[i].beforePt = packed.loose[i].row.pt;
		}
	});
	remembered = true;
}

void Sweep::operator()()
{
	current = false;
	const std::size_t groups = packed.groups.size();
	if (!order) {
		colourByColour([&](std::size_t block) { sweepBlock(block); });
		return;
	}
	for (const auto i : order.next(groups + packed.loose.size())) {
		if (static_cast<std::size_t>(i) < groups)
			groupKernel().sweep(&packed.groups[i], 1, packed.bodies.data());
		else
			solveLoose(packed.loose[i - groups], packed.bodies.data());
	}
}

void Sweep::sweepBlock(std::size_t block)
{
	const Begin &begin = packed.begin[block], &end = packed.begin[block + 1];
	groupKernel().sweep(packed.groups.data() + begin.group, end.group - begin.group, packed.bodies.data());
	for (std::size_t i = begin.loose; i < end.loose; i++)
		solveLoose(packed.loose[i], packed.bodies.data());
}

} // namespace cd
