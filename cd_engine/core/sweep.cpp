#include "sweep.hpp"
#include "local_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

} // namespace

std::unique_ptr<Sweep::Packed>& Sweep::spare()
{
	static thread_local std::unique_ptr<Packed> one;
	return one;
}

Sweep::Sweep(ContactSystem& s, unsigned seed, Threads* t)
    : system(s)
    , kept(spare() ? std::move(spare()) : std::make_unique<Packed>())
    , packed(*kept)
    , order(seed)
    , threads(t)
{
	bool sameMasses = true;
	const bool same = classifyBodies(sameMasses) && sameLinks();
	if (!same)
		groupContacts();
	if (!same || !sameMasses)
		findCarried();
	twisted = anyOf(threads, system.bodies.size(), [&](std::size_t i) { return system.bodies[i].twisted > 0 && packed.place[i] >= 0; });
	const std::size_t bodies = packed.bodyAt.size();
	packed.groups.resize(packed.grouping.groups());
	packed.loose.resize(packed.grouping.loose.size());
	packed.bodies.resize(bodies + 4 * packed.blocks.count());
	packed.freeBodies.resize(bodies);
	packed.masses.resize(bodies);
	packed.freeSpins.resize(bodies);
	packed.blockSums.resize(packed.blocks.count());
	inEveryBlock([&](std::size_t block) {
		fillGroups(block);
		fillLoose(block);
		packBodies(block);
	});
	restoreVelocities();
}

Sweep::~Sweep() { spare() = std::move(kept); }

bool Sweep::classifyBodies(bool& sameMasses)
{
	const bool known = packed.kinds.size() == system.bodies.size();
	packed.kinds.resize(system.bodies.size());
	struct Same {
		bool kinds, masses;
	};
	const auto classify = [&](std::size_t from, std::size_t to) {
		Same same { known, known };
		for (std::size_t i = from; i < to; i++) {
			const double* const w = system.bodies[i].w;
			BodyKind& kind = packed.kinds[i];
			if (known && std::equal(w, w + 3, kind.w))
				continue;
			same.masses = false;
			const bool turns = w[0] > 0 && w[2] > 0, uniform = w[0] == w[1] && (w[0] > 0 || w[2] == 0), movable = w[0] > 0;
			const double k = turns ? std::sqrt(w[0] / w[2]) : 1;
			same.kinds = same.kinds && uniform == kind.uniform && turns == kind.turns && movable == kind.movable;
			kind = { { w[0], w[1], w[2] }, k, 1 / k, uniform, turns, movable };
		}
		return same;
	};
	const Same same = reduceRanges<Same>(threads, system.bodies.size(), classify,
	    [](const Same& a, const Same& b) { return Same { a.kinds && b.kinds, a.masses && b.masses }; });
	sameMasses = same.masses;
	return same.kinds;
}

inline Link Sweep::link(const ContactRow& c) const
{
	const BodyKind &A = packed.kinds[c.a], &B = packed.kinds[c.b];
	const bool groupable = c.diagonal() && c.wtt > 0 && A.uniform && B.uniform && (A.turns || c.at == 0) && (B.turns || c.bt == 0);
	return { c.a, c.b, !(c.wnn > 0) ? Part::none : groupable ? Part::grouped : Part::loose };
}

bool Sweep::sameLinks() const
{
	return packed.links.size() == system.contacts.size()
	    && !anyOf(threads, packed.links.size(), [&](std::size_t i) { return !(packed.links[i] == link(system.contacts[i])); });
}

void Sweep::groupContacts()
{
	packed.links.resize(system.contacts.size());
	forRanges(threads, system.contacts.size(), [&](std::size_t from, std::size_t to) {
		for (std::size_t i = from; i < to; i++)
			packed.links[i] = link(system.contacts[i]);
	});
	packed.partition.update(system, threads);
	packed.blocks.cut(packed.links, packed.partition.freedom);
	numberBodies();
	packed.builder.begin(packed.bodyAt.size(), system.contacts.size(), packed.grouping);
	for (std::size_t block = 0; block < packed.blocks.count(); block++) {
		packed.begin[block].group = packed.grouping.groups();
		packed.begin[block].loose = packed.grouping.loose.size();
		for (int32_t k = packed.blocks.block[block]; k < packed.blocks.block[block + 1]; k++) {
			const int32_t i = packed.blocks.contacts[k];
			const Link& c = packed.links[i];
			if (c.part == Part::grouped)
				packed.builder.add(i, packed.ends[i].a, packed.kinds[c.a].movable, packed.ends[i].b, packed.kinds[c.b].movable);
			else
				packed.grouping.loose.push_back(i);
		}
		packed.builder.end();
	}
	packed.begin.back().group = packed.grouping.groups();
	packed.begin.back().loose = packed.grouping.loose.size();
	numberSums();
}

// As the contacts first meet them: what is near in the order of the contacts is near in memory.
void Sweep::numberBodies()
{
	const Blocks& blocks = packed.blocks;
	packed.place.assign(system.bodies.size(), -1);
	packed.metIn.assign(system.bodies.size(), -1);
	packed.ends.resize(packed.links.size());
	packed.begin.resize(blocks.count() + 1);
	int32_t met = 0;
	for (std::size_t block = 0; block < blocks.count(); block++) {
		packed.begin[block].body = met;
		packed.bodyAt.resize(met + system.bodies.size() + 1); // the last is written to where none is fresh
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
			packed.ends[i].a = number(packed.links[i].a);
			packed.ends[i].b = number(packed.links[i].b);
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

void Sweep::fillGroups(std::size_t block)
{
	const int32_t empty = nobody(block);
	const int32_t* member = packed.grouping.members.data() + packed.begin[block].group * Group::lanes;
	for (std::size_t k = packed.begin[block].group; k < packed.begin[block + 1].group; k++) {
		Group& g = packed.groups[k];
		double wnn[Group::lanes], wtt[Group::lanes];
		for (int lane = 0; lane < Group::lanes; lane++, member++) {
			if (*member < 0) {
				g.a[lane] = g.b[lane] = empty;
				g.nx[lane] = g.ny[lane] = g.at[lane] = g.bt[lane] = g.bias[lane] = g.mu[lane] = g.pn[lane] = g.pt[lane] = 0;
				wnn[lane] = wtt[lane] = std::numeric_limits<double>::infinity();
				continue;
			}
			const ContactRow& c = system.contacts[*member];
			g.a[lane] = packed.ends[*member].a;
			g.b[lane] = packed.ends[*member].b;
			g.nx[lane] = c.nx;
			g.ny[lane] = c.ny;
			g.at[lane] = c.at * packed.kinds[c.a].inverseRadius;
			g.bt[lane] = c.bt * packed.kinds[c.b].inverseRadius;
			g.bias[lane] = c.bias;
			g.mu[lane] = c.mu;
			g.pn[lane] = c.pn;
			g.pt[lane] = c.pt;
			wnn[lane] = c.wnn;
			wtt[lane] = c.wtt;
		}
		for (int lane = 0; lane < Group::lanes; lane++) {
			g.inverseWnn[lane] = 1 / wnn[lane];
			g.inverseWtt[lane] = 1 / wtt[lane];
		}
	}
}

void Sweep::fillLoose(std::size_t block)
{
	for (std::size_t i = packed.begin[block].loose; i < packed.begin[block + 1].loose; i++) {
		Loose& l = packed.loose[i];
		const int32_t contact = packed.grouping.loose[i];
		l.row = system.contacts[contact];
		const auto fill = [&](int32_t& body, int32_t place, double& n, double& t, double* w) {
			std::copy_n(system.bodies[body].w, 3, w);
			const BodyKind& kind = packed.kinds[body];
			n *= kind.inverseRadius;
			t *= kind.inverseRadius;
			w[2] *= kind.radius * kind.radius;
			body = place;
		};
		fill(l.row.a, packed.ends[contact].a, l.row.an, l.row.at, l.wa);
		fill(l.row.b, packed.ends[contact].b, l.row.bn, l.row.bt, l.wb);
	}
}

void Sweep::packBodies(std::size_t block)
{
	for (std::size_t i = packed.begin[block].body; i < packed.begin[block + 1].body; i++) {
		const BodyVelocity& b = system.bodies[packed.bodyAt[i]];
		packed.bodies[i].w = b.w[0];
		packed.freeBodies[i] = { b.v[0], b.v[1], b.v[2] * packed.kinds[packed.bodyAt[i]].radius, b.pushed };
		packed.freeSpins[i] = b.v[2];
		const double inverse = std::max(b.w[0], b.w[1]);
		packed.masses[i] = inverse > 0 ? 1 / inverse : 0;
	}
	packed.bodies[nobody(block)] = {};
}

void Sweep::restoreVelocities()
{
	moveBodies();
	// + 0: a body at rest keeps +0, whatever it adds 0 times; -0 would not, and its lanes would differ in sign.
	inEveryBlock([&](std::size_t block) {
		for (std::size_t i = packed.begin[block].body; i < packed.begin[block + 1].body; i++) {
			const PackedBody& m = packed.moved[i];
			packed.bodies[i] = { m.vx + 0., m.vy + 0., m.spin + 0., packed.bodies[i].w };
		}
	});
	remembered = false; // what was before has the round-off that is gone now
}

void Sweep::store()
{
	const auto store = [&](int32_t contact, double pn, double pt) {
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
			if (packed.partition.freedom[packed.bodyAt[i]] == 0)
				continue; // keeps its velocity
			BodyVelocity& b = system.bodies[packed.bodyAt[i]];
			const PackedBody& v = packed.bodies[i];
			b.v[0] = v.vx;
			b.v[1] = v.vy;
			// So that a spin that nothing changes stays the same to the last bit.
			b.v[2] = packed.freeSpins[i] + (v.spin - packed.freeBodies[i].spin) * packed.kinds[packed.bodyAt[i]].inverseRadius;
		}
	});
}

void Sweep::copyTo(Iterate& p) const
{
	p.groups.resize(packed.groups.size());
	p.loose.resize(2 * packed.loose.size());
	inEveryBlock([&](std::size_t block) {
		for (std::size_t k = packed.begin[block].group; k < packed.begin[block + 1].group; k++) {
			std::copy_n(packed.groups[k].pn, Group::lanes, p.groups[k].pn);
			std::copy_n(packed.groups[k].pt, Group::lanes, p.groups[k].pt);
		}
		for (std::size_t i = packed.begin[block].loose; i < packed.begin[block + 1].loose; i++) {
			p.loose[2 * i] = packed.loose[i].row.pn;
			p.loose[2 * i + 1] = packed.loose[i].row.pt;
		}
	});
}

void Sweep::copyFrom(const Iterate& p)
{
	inEveryBlock([&](std::size_t block) {
		for (std::size_t k = packed.begin[block].group; k < packed.begin[block + 1].group; k++) {
			std::copy_n(p.groups[k].pn, Group::lanes, packed.groups[k].pn);
			std::copy_n(p.groups[k].pt, Group::lanes, packed.groups[k].pt);
		}
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

// Velocities are linear in the impulses and are moved as those are.
AheadReport Sweep::ahead(double beta)
{
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
	groupKernel().sweepAhead(packed.groups.data() + begin.group, packed.groupsBefore.data() + begin.group, end.group - begin.group, packed.bodies.data(), beta, sums.ahead);
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
		for (std::size_t k = begin.group; k < end.group; k++) {
			std::copy_n(packed.groups[k].pn, Group::lanes, packed.groupsBefore[k].pn);
			std::copy_n(packed.groups[k].pt, Group::lanes, packed.groupsBefore[k].pt);
		}
		for (std::size_t i = begin.loose; i < end.loose; i++) {
			packed.loose[i].beforePn = packed.loose[i].row.pn;
			packed.loose[i].beforePt = packed.loose[i].row.pt;
		}
	});
	remembered = true;
}

void Sweep::operator()()
{
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
