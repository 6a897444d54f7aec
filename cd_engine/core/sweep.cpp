#include "sweep.hpp"
#include "local_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cd {

std::unique_ptr<Sweep::Packed>& Sweep::spare()
{
	static thread_local std::unique_ptr<Packed> one;
	return one;
}

Sweep::Sweep(ContactSystem& s, unsigned seed)
    : system(s)
    , kept(spare() ? std::move(spare()) : std::make_unique<Packed>())
    , packed(*kept)
    , order(seed)
{
	bool sameMasses = true;
	const bool same = classifyBodies(sameMasses) && sameLinks();
	if (!same)
		groupContacts();
	if (!same || !sameMasses)
		findCarried();
	fillGroups();
	fillLoose();
	packBodies();
	restoreVelocities();
}

Sweep::~Sweep() { spare() = std::move(kept); }

bool Sweep::classifyBodies(bool& sameMasses)
{
	bool same = packed.kinds.size() == system.bodies.size();
	packed.kinds.resize(system.bodies.size());
	for (std::size_t i = 0; i < system.bodies.size(); i++) {
		const double* const w = system.bodies[i].w;
		BodyKind& kind = packed.kinds[i];
		if (same && std::equal(w, w + 3, kind.w))
			continue;
		sameMasses = false;
		const bool turns = w[0] > 0 && w[2] > 0, uniform = w[0] == w[1] && (w[0] > 0 || w[2] == 0), movable = w[0] > 0;
		const double k = turns ? std::sqrt(w[0] / w[2]) : 1;
		same = same && uniform == kind.uniform && turns == kind.turns && movable == kind.movable;
		kind = { { w[0], w[1], w[2] }, k, 1 / k, uniform, turns, movable };
	}
	return same;
}

inline Sweep::Link Sweep::link(const ContactRow& c) const
{
	const BodyKind &A = packed.kinds[c.a], &B = packed.kinds[c.b];
	const bool groupable = c.diagonal() && c.wtt > 0 && A.uniform && B.uniform && (A.turns || c.at == 0) && (B.turns || c.bt == 0);
	return { c.a, c.b, !(c.wnn > 0) ? Part::none : groupable ? Part::grouped : Part::loose };
}

bool Sweep::sameLinks() const
{
	if (packed.links.size() != system.contacts.size())
		return false;
	for (std::size_t i = 0; i < packed.links.size(); i++)
		if (!(packed.links[i] == link(system.contacts[i])))
			return false;
	return true;
}

// Bodies are numbered as the contacts first meet them: what is near in the order of the contacts is near in memory.
void Sweep::groupContacts()
{
	packed.place.assign(system.bodies.size(), -1);
	packed.bodyAt.resize(system.bodies.size() + 1);
	packed.links.resize(system.contacts.size());
	packed.builder.begin(system.bodies.size(), system.contacts.size(), packed.grouping);
	packed.contacts = 0;
	int32_t met = 0;
	// Without a branch, which would be mispredicted half the time.
	const auto number = [&, place = packed.place.data(), bodyAt = packed.bodyAt.data()](int32_t body) {
		const bool fresh = place[body] < 0;
		const int32_t at = fresh ? met : place[body];
		place[body] = at;
		bodyAt[met] = body;
		met += fresh;
		return at;
	};
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const Link c = packed.links[i] = link(system.contacts[i]);
		if (c.part == Part::none)
			continue;
		packed.contacts++;
		const int32_t a = number(c.a), b = number(c.b);
		if (c.part == Part::grouped)
			packed.builder.add(static_cast<int32_t>(i), a, packed.kinds[c.a].movable, b, packed.kinds[c.b].movable);
		else
			packed.grouping.loose.push_back(static_cast<int32_t>(i));
	}
	packed.builder.end();
	packed.bodyAt.resize(met);
	packed.partition.update(system);
}

void Sweep::findCarried()
{
	packed.carried.clear();
	forEachCarried(system, [&](int32_t light, int32_t heavy) { packed.carried.emplace_back(packed.place[light], packed.place[heavy]); });
}

void Sweep::fillGroups()
{
	const auto nobody = static_cast<int32_t>(packed.bodyAt.size());
	packed.groups.resize(packed.grouping.groups());
	const int32_t* member = packed.grouping.members.data();
	for (Group& g : packed.groups) {
		double wnn[Group::lanes], wtt[Group::lanes];
		for (int lane = 0; lane < Group::lanes; lane++, member++) {
			if (*member < 0) {
				g.a[lane] = g.b[lane] = nobody;
				g.nx[lane] = g.ny[lane] = g.at[lane] = g.bt[lane] = g.bias[lane] = g.mu[lane] = g.pn[lane] = g.pt[lane] = 0;
				wnn[lane] = wtt[lane] = std::numeric_limits<double>::infinity();
				continue;
			}
			const ContactRow& c = system.contacts[*member];
			g.a[lane] = packed.place[c.a];
			g.b[lane] = packed.place[c.b];
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

void Sweep::fillLoose()
{
	packed.loose.resize(packed.grouping.loose.size());
	for (std::size_t i = 0; i < packed.loose.size(); i++) {
		Loose& l = packed.loose[i];
		l.row = system.contacts[packed.grouping.loose[i]];
		const auto fill = [&](int32_t& body, double& n, double& t, double* w) {
			std::copy_n(system.bodies[body].w, 3, w);
			const BodyKind& kind = packed.kinds[body];
			n *= kind.inverseRadius;
			t *= kind.inverseRadius;
			w[2] *= kind.radius * kind.radius;
			body = packed.place[body];
		};
		fill(l.row.a, l.row.an, l.row.at, l.wa);
		fill(l.row.b, l.row.bn, l.row.bt, l.wb);
	}
}

void Sweep::packBodies()
{
	const std::size_t count = packed.bodyAt.size();
	packed.bodies.resize(count + 1);
	packed.freeBodies.resize(count);
	packed.masses.resize(count);
	packed.freeSpins.resize(count);
	for (std::size_t i = 0; i < count; i++) {
		const BodyVelocity& b = system.bodies[packed.bodyAt[i]];
		packed.bodies[i].w = b.w[0];
		packed.freeBodies[i] = { b.v[0], b.v[1], b.v[2] * packed.kinds[packed.bodyAt[i]].radius, b.pushed };
		packed.freeSpins[i] = b.v[2];
		const double inverse = std::max(b.w[0], b.w[1]);
		packed.masses[i] = inverse > 0 ? 1 / inverse : 0;
		twisted = twisted || b.twisted > 0;
	}
	packed.bodies[count] = {};
}

void Sweep::restoreVelocities()
{
	moveBodies();
	// + 0: a body at rest keeps +0, whatever it adds 0 times; -0 would not, and its lanes would differ in sign.
	for (std::size_t i = 0; i < packed.bodyAt.size(); i++) {
		const PackedBody& m = packed.moved[i];
		packed.bodies[i] = { m.vx + 0., m.vy + 0., m.spin + 0., packed.bodies[i].w };
	}
	remembered = false; // what was before has the round-off that is gone now
}

void Sweep::store()
{
	const auto store = [&](int32_t contact, double pn, double pt) {
		system.contacts[contact].pn = pn;
		system.contacts[contact].pt = pt;
	};
	for (std::size_t k = 0; k < packed.grouping.members.size(); k++)
		if (packed.grouping.members[k] >= 0) {
			const Group& g = packed.groups[k / Group::lanes];
			store(packed.grouping.members[k], g.pn[k % Group::lanes], g.pt[k % Group::lanes]);
		}
	for (std::size_t i = 0; i < packed.loose.size(); i++)
		store(packed.grouping.loose[i], packed.loose[i].row.pn, packed.loose[i].row.pt);
	for (std::size_t i = 0; i < packed.bodyAt.size(); i++) {
		BodyVelocity& b = system.bodies[packed.bodyAt[i]];
		const PackedBody& v = packed.bodies[i];
		b.v[0] = v.vx;
		b.v[1] = v.vy;
		// So that a spin that nothing changes stays the same to the last bit.
		b.v[2] = packed.freeSpins[i] + (v.spin - packed.freeBodies[i].spin) * packed.kinds[packed.bodyAt[i]].inverseRadius;
	}
}

void Sweep::copyTo(Iterate& p) const
{
	p.groups.resize(packed.groups.size());
	for (std::size_t k = 0; k < packed.groups.size(); k++) {
		std::copy_n(packed.groups[k].pn, Group::lanes, p.groups[k].pn);
		std::copy_n(packed.groups[k].pt, Group::lanes, p.groups[k].pt);
	}
	p.loose.clear();
	for (const Loose& l : packed.loose)
		p.loose.insert(p.loose.end(), { l.row.pn, l.row.pt });
}

void Sweep::copyFrom(const Iterate& p)
{
	for (std::size_t k = 0; k < packed.groups.size(); k++) {
		std::copy_n(p.groups[k].pn, Group::lanes, packed.groups[k].pn);
		std::copy_n(p.groups[k].pt, Group::lanes, packed.groups[k].pt);
	}
	for (std::size_t i = 0; i < packed.loose.size(); i++) {
		packed.loose[i].row.pn = p.loose[2 * i];
		packed.loose[i].row.pt = p.loose[2 * i + 1];
	}
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
	const GroupKernel& kernel = groupKernel();
	PackedBody* const bodies = packed.bodies.data();
	const std::size_t groups = packed.groups.size();
	if (!remembered)
		remember();
	kernel.extrapolate(bodies, packed.bodiesBefore.data(), packed.bodies.size(), beta);
	AheadReport report;
	LaneSums sums = {};
	if (order) {
		for (const auto i : order.next(groups + packed.loose.size())) {
			if (static_cast<std::size_t>(i) < groups)
				kernel.sweepAhead(&packed.groups[i], &packed.groupsBefore[i], 1, bodies, beta, sums);
			else
				solveAhead(packed.loose[i - groups], bodies, beta, report);
		}
	} else {
		kernel.sweepAhead(packed.groups.data(), packed.groupsBefore.data(), groups, bodies, beta, sums);
		for (Loose& l : packed.loose)
			solveAhead(l, bodies, beta, report);
	}
	for (int lane = 0; lane < Group::lanes; lane++) {
		report.change += sums.change[lane];
		report.against += sums.against[lane];
	}
	return report;
}

void Sweep::remember()
{
	packed.bodiesBefore = packed.bodies;
	packed.groupsBefore.resize(packed.groups.size());
	for (std::size_t k = 0; k < packed.groups.size(); k++) {
		std::copy_n(packed.groups[k].pn, Group::lanes, packed.groupsBefore[k].pn);
		std::copy_n(packed.groups[k].pt, Group::lanes, packed.groupsBefore[k].pt);
	}
	for (Loose& l : packed.loose) {
		l.beforePn = l.row.pn;
		l.beforePt = l.row.pt;
	}
	remembered = true;
}

void Sweep::operator()()
{
	const GroupKernel& kernel = groupKernel();
	PackedBody* const bodies = packed.bodies.data();
	const std::size_t groups = packed.groups.size();
	if (order) {
		for (const auto i : order.next(groups + packed.loose.size())) {
			if (static_cast<std::size_t>(i) < groups)
				kernel.sweep(&packed.groups[i], 1, bodies);
			else
				solveLoose(packed.loose[i - groups], bodies);
		}
		return;
	}
	kernel.sweep(packed.groups.data(), groups, bodies);
	for (Loose& l : packed.loose)
		solveLoose(l, bodies);
}

} // namespace cd
