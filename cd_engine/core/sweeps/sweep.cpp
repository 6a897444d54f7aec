#include "sweeps/sweep.hpp"
#include "problem/problem.hpp"

#include <algorithm>
#include <cstring>

namespace cd {
namespace {

	// Of a group or a contact. std::copy_n would be a call.
	template <class From, class To> void copyImpulses(const From& from, To& to)
	{
		std::memcpy(&to.pn, &from.pn, sizeof to.pn);
		std::memcpy(&to.pt, &from.pt, sizeof to.pt);
	}

} // namespace

Sweep::Sweep(ContactSystem& s, unsigned seed, Threads* t)
    : system(s)
    , kept(s.memory)
    , packed(*kept)
    , order(seed, s.memory)
    , threads(t)
{
	const Same same = classifyBodies();
	twisted = same.twisted;
	// Sweeps take the contacts from the step itself where they link the same bodies as those that were grouped.
	if (!same.kinds || !same.masses || !packed.partition.knows(system) || system.contacts.solvedBeside()
	    || packed.blocks.contacts.size() != system.contacts.size())
		system.contacts.make();
	const bool others = packed.partition.update(system, threads), anew = others || !same.kinds || packed.parts.empty() || !fill();
	if (anew) {
		system.contacts.make();
		groupContacts();
		fill();
	}
	if (anew || !same.masses)
		findCarried();
	restoreVelocities();
}

void Sweep::restoreVelocities()
{
	moveBodies();
	// + 0 turns -0 into +0. A body at rest must stay at +0 whatever is added to it 0 times, or its lanes would differ in sign.
	inEveryBlock([&](const Part& block) {
		for (const std::size_t i : block.bodies) {
			const PackedBody& m = packed.moved[i];
			packed.bodies[i] = { m.vx + 0., m.vy + 0., m.spin + 0., packed.bodies[i].w };
		}
	});
	remembered = false; // what is remembered still contains the round-off
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
	inEveryBlock([&](const Part& block) {
		for (const std::size_t k : block.groups) {
			const Group& g = packed.groups[k];
			if (k + soon < block.groups.to) { // only two of its eleven lines are read
				__builtin_prefetch(&packed.groups[k + soon].pn);
				__builtin_prefetch(&packed.groups[k + soon].pt);
			}
			for (std::size_t lane = 0; lane < Group::lanes; lane++)
				if (const int32_t contact = packed.grouping.members[k * Group::lanes + lane]; contact >= 0)
					store(contact, g.pn[lane], g.pt[lane]);
		}
		for (const std::size_t i : block.loose)
			store(packed.grouping.loose[i], packed.loose[i].row.pn, packed.loose[i].row.pt);
		for (const std::size_t i : block.bodies) {
			if (i + soon < block.bodies.to) {
				__builtin_prefetch(&system.bodies[packed.bodyAt[i + soon]], 1);
				__builtin_prefetch(&packed.inverseRadii[packed.bodyAt[i + soon]]);
			}
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

// Calls copy(the packed impulses, those of the iterate) for all groups and loose contacts.
template <class P, class Copy> void Sweep::withIterate(P& p, const Copy& copy) const
{
	inEveryBlock([&](const Part& block) {
		for (const std::size_t k : block.groups)
			copy(packed.groups[k], p.groups[k]);
		for (const std::size_t i : block.loose)
			copy(packed.loose[i].row, p.loose[i]);
	});
}

void Sweep::copyTo(Iterate& p) const
{
	p.groups.resize(packed.groups.size());
	p.loose.resize(packed.loose.size());
	withIterate(p, [](const auto& own, auto& saved) { copyImpulses(own, saved); });
}

void Sweep::copyFrom(const Iterate& p)
{
	current = false;
	withIterate(p, [](auto& own, const auto& saved) { copyImpulses(saved, own); });
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
	push(l, pn - c.pn, pt - c.pt, A, B);
	c.pn = pn;
	c.pt = pt;
}

inline void Sweep::solveAhead(Loose& l, Iterate::Loose& before, PackedBody* bodies, double beta, AheadReport& report)
{
	ContactRow& c = l.row;
	const double n = c.pn, t = c.pt;
	const double yn = n + beta * (n - before.pn), yt = t + beta * (t - before.pt);
	before = { n, t };
	c.pn = yn;
	c.pt = yt;
	solveLoose(l, bodies);
	const double dn = yn - c.pn, dt = yt - c.pt;
	report.change += dn * dn + dt * dt;
	report.against += dn * (c.pn - n) + dt * (c.pt - t);
}

// Calls work(groups, loose contacts, where their sums are) in the order of the sweep.
template <class Work> void Sweep::inOrder(const Work& work)
{
	current = false;
	if (!order)
		return colourByColour([&](Part& block) { work(block.groups, block.loose, block); });
	const std::size_t groups = packed.groups.size();
	order.visit(groups + packed.loose.size(), [&](std::size_t i, std::size_t end) {
		if (i < groups)
			work(Range { i, end }, Range {}, packed.parts[0]);
		else
			work(Range {}, Range { i - groups, end - groups }, packed.parts[0]);
	});
}

void Sweep::operator()()
{
	inOrder([&](const Range& groups, const Range& loose, Part&) {
		groupKernel().sweep(packed.groups.data() + groups.from, groups.size(), packed.bodies.data());
		for (const std::size_t i : loose)
			solveLoose(packed.loose[i], packed.bodies.data());
	});
}

// Velocities are linear in the impulses, so they are extrapolated in the same way.
AheadReport Sweep::ahead(double beta)
{
	if (!remembered) {
		packed.bodiesBefore = packed.bodies;
		copyTo(packed.before);
		remembered = true;
	}
	inEveryBlock([&](Part& block) {
		groupKernel().extrapolate(&packed.bodies[block.bodies.from], &packed.bodiesBefore[block.bodies.from], block.bodies.size(), beta);
		block.ahead = {};
		block.aheadLoose = {};
	});
	inOrder([&](const Range& groups, const Range& loose, Part& sums) {
		groupKernel().sweepAhead(packed.groups.data() + groups.from, packed.before.groups.data() + groups.from, groups.size(),
		    packed.bodies.data(), beta, sums.ahead);
		for (const std::size_t i : loose)
			solveAhead(packed.loose[i], packed.before.loose[i], packed.bodies.data(), beta, sums.aheadLoose);
	});
	LaneSums sums = {};
	AheadReport report;
	for (const Part& block : packed.parts) {
		for (int lane = 0; lane < Group::lanes; lane++) {
			sums.change[lane] += block.ahead.change[lane];
			sums.against[lane] += block.ahead.against[lane];
		}
		report.change += block.aheadLoose.change;
		report.against += block.aheadLoose.against;
	}
	for (int lane = 0; lane < Group::lanes; lane++) {
		report.change += sums.change[lane];
		report.against += sums.against[lane];
	}
	return report;
}

} // namespace cd
