#include "error/residual.hpp"

#include "graph/graph.hpp"
#include "base/base.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {
namespace {

	constexpr double manyLoops = 200; // loops of an island from which the mean over the mass counts in full
	constexpr double farBelow = 0.1; // of that mean: a heavy body below it has its own term; walls as heavy as 2 sqrt(N) disks have 0.16 to 0.3
	constexpr double nothing = 1e-6; // of that mean: a smaller s counts as this
	constexpr double single = 10; // root mean squares that a single contact may miss there; in a packing it misses 5 to 20

	// A body: its velocity after the impulses, and the magnitude of what acts on it [m/s].
	template <class Space> struct alignas(32) Moved {
		MotionOf<Space> v;
		double s;
	};

	// Of the bodies of contacts; of others, what earlier systems have left.
	template <class Space> struct Bodies {
		std::vector<Moved<Space>> moved;
		std::vector<char> met;
		std::vector<double> leastHeavy; // smallest s of the far heavier bodies that it carries [m/s]
	};

	template <class Space> void moveBodies(const ContactSystem<Space>& system, const std::vector<double>& freeVelocity, Bodies<Space>& bodies)
	{
		std::vector<Moved<Space>>& moved = bodies.moved;
		moved.resize(system.bodies.size());
		bodies.met.resize(moved.size());
		bodies.leastHeavy.resize(moved.size());
		system.forBodies(nullptr, [&](std::size_t i) {
			moved[i] = { motionOf<Space>(&freeVelocity[Space::freedoms * i]), system.bodies[i].pushed };
			bodies.met[i] = 0;
			bodies.leastHeavy[i] = std::numeric_limits<double>::infinity();
		});
		for (const ContactRow<Space>& c : system.contacts) {
			const BodyVelocityIn<Space>&A = system.bodies[c.a], &B = system.bodies[c.b];
			const bool passes = c.wnn > 0; // else nothing can move along the normal
			Moved<Space>&a = moved[c.a], &b = moved[c.b];
			const ImpulseOf<Space> p = impulseOf(c);
			const MotionOf<Space> wa = motionOf<Space>(A.w), wb = motionOf<Space>(B.w);
			push(actionOf(c, p), a.v, wa, b.v, wb);
			a.s += actingOnA(wa, c, p) + (passes ? A.twisted * c.armA() : 0);
			b.s += actingOnB(wb, c, p) + (passes ? B.twisted * c.armB() : 0);
		}
	}

} // namespace

void ResidualSum::addUnderHeavy(double velocity, double s)
{
	if (!std::isfinite(s))
		return;
	missedUnderHeavy = atLeast(missedUnderHeavy, velocity);
	leastHeavy = std::min(leastHeavy, s);
}

void ResidualSum::add(const ResidualSum& other)
{
	contacts += other.contacts;
	difference += other.difference;
	square += other.square;
	differenceEnergy += other.differenceEnergy;
	squareEnergy += other.squareEnergy;
	stale += other.stale;
	worst = atLeast(worst, other.worst);
	missed += other.missed;
	mostMissed = atLeast(mostMissed, other.mostMissed);
	missedUnderHeavy = atLeast(missedUnderHeavy, other.missedUnderHeavy);
	leastHeavy = std::min(leastHeavy, other.leastHeavy);
	touched += other.touched;
	mass += other.mass;
	weighted += other.weighted;
	if (other.least < least) {
		least = other.least;
		leastBody = other.leastBody;
	}
}

double ResidualSum::bodies() const
{
	if (missed == 0)
		return 0;
	// Nothing acts on any body, but a contact misses its law: the whole velocity change is missing. Else this would be 0 instead.
	if (missed > 0 && std::isinf(least))
		return std::numeric_limits<double>::infinity();
	const double root = mass > 0 ? weighted / mass : 0, mean = root * root;
	const double every = std::sqrt(static_cast<double>(contacts) * missed) / std::max(least, nothing * mean);
	if (contacts <= touched)
		return every;
	const double loops = std::min(1., static_cast<double>(contacts - touched) / manyLoops);
	const double typical = std::max(std::sqrt(missed / static_cast<double>(contacts)), std::sqrt(mostMissed) / single) / (mean * loops);
	const bool unseen = leastHeavy < farBelow * mean; // the mean does not represent the heavy body
	const double amongMany = unseen ? std::max(typical, std::sqrt(missedUnderHeavy) / (single * leastHeavy)) : typical;
	return amongMany < every ? amongMany : every; // `every` if the other is NaN
}

Residual ResidualSum::of() const { return residual(this, 1); }

Residual residual(const ResidualSum* islands, std::size_t count)
{
	ResidualSum all;
	Residual r;
	for (const ResidualSum* sum = islands; sum != islands + count; sum++) {
		all.add(*sum);
		const double bodies = sum->bodies();
		if (!(bodies <= r.bodies)) {
			r.bodies = bodies;
			r.body = sum->leastBody;
		}
	}
	r.difference = std::sqrt(all.difference);
	r.impulse = std::sqrt(all.square);
	if (all.square == 0) {
		r.norm = r.energy = r.maximum = all.difference == 0 ? 0 : std::numeric_limits<double>::infinity();
		return r;
	}
	r.stale = all.stale > 0;
	r.norm = std::sqrt(all.difference / all.square);
	r.work = all.squareEnergy;
	r.energy = std::sqrt(all.differenceEnergy / all.squareEnergy);
	r.maximum = std::sqrt(all.worst / (all.square / static_cast<double>(all.contacts)));
	return r;
}

template <class Space> Residual residual(const ContactSystem<Space>& system, const std::vector<double>& freeVelocity)
{
	struct Islands {
		Partition partition; // of the last system, which mostly had the same contacts
		std::vector<ResidualSum> sums;
	};
	const Borrowed<Islands> islands(system.memory);
	auto& [partition, sums] = *islands;
	partition.update(system);
	sums.assign(partition.islands.size(), {});
	addResiduals(system, freeVelocity, partition.ofContact, sums);
	return residual(sums.data(), sums.size());
}

template <class Space>
void addResiduals(const ContactSystem<Space>& system, const std::vector<double>& freeVelocity, const std::vector<int32_t>& islandOf,
    std::vector<ResidualSum>& sums, const int32_t* numbers)
{
	assert(system.consistent() && freeVelocity.size() == Space::freedoms * system.bodies.size() && islandOf.size() == system.contacts.size());
	const Borrowed<Bodies<Space>> bodies(system.memory);
	auto& moved = bodies->moved; // no structured bindings: a lambda below captures them
	auto& met = bodies->met;
	auto& leastHeavy = bodies->leastHeavy;
	moveBodies(system, freeVelocity, *bodies);
	forEachHeavyOnLight(system, [&](int32_t light, int32_t heavy) {
		if (moved[heavy].s > 0)
			leastHeavy[light] = std::min(leastHeavy[light], moved[heavy].s);
	});
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow<Space>& c = system.contacts[i];
		const double *ma = system.bodies[c.a].w, *mb = system.bodies[c.b].w;
		const double wnn = c.compliance(ma, mb);
		if (islandOf[i] < 0 || c.held(wnn, c.freedom(ma, mb)))
			continue; // nothing can move along n
		const double compliance = wnn + c.cn;
		ResidualSum& sum = sums[islandOf[i]];
		const Miss<double> miss = missOf(c, compliance, moved[c.a].v, moved[c.b].v, moved[c.a].s + moved[c.b].s);
		sum.addContact(miss, impulseOf(c), compliance);
		sum.addUnderHeavy(miss.velocity, std::min(leastHeavy[c.a], leastHeavy[c.b]));
		// Bodies are added as the contacts meet them, so that the sums do not depend on the numbering of the bodies.
		for (const int32_t body : { c.a, c.b })
			if (!met[body]) {
				met[body] = 1;
				const double inverse = inverseMass(system.bodies[body]);
				if (isMovable(system.bodies[body]))
					sum.addBody(inverse > 0 ? 1 / inverse : 0, moved[body].s, numbers ? numbers[body] : body);
			}
	}
}

template Residual residual(const ContactSystem<Plane>&, const std::vector<double>&);
template Residual residual(const ContactSystem<RollingPlane>&, const std::vector<double>&);
template Residual residual(const ContactSystem<Space3>&, const std::vector<double>&);
template void addResiduals(
    const ContactSystem<Plane>&, const std::vector<double>&, const std::vector<int32_t>&, std::vector<ResidualSum>&, const int32_t*);
template void addResiduals(
    const ContactSystem<Space3>&, const std::vector<double>&, const std::vector<int32_t>&, std::vector<ResidualSum>&, const int32_t*);
template void addResiduals(
    const ContactSystem<RollingPlane>&, const std::vector<double>&, const std::vector<int32_t>&, std::vector<ResidualSum>&, const int32_t*);

Residual residual(const DelassusSystem& system)
{
	assert(system.consistent());
	ResidualSum sum;
	for (std::size_t i = 0; i < system.contacts(); i++) {
		double un = system.q[2 * i], ut = system.q[2 * i + 1];
		double size = std::abs(un) + std::abs(ut);
		for (std::size_t k = system.start[i]; k < system.start[i + 1]; k++) {
			const Block& w = system.blocks[k];
			const double n = system.p[2 * system.column[k]], t = system.p[2 * system.column[k] + 1];
			un += w.nn * n + w.nt * t;
			ut += w.tn * n + w.tt * t;
			size += std::abs(w.nn * n) + std::abs(w.nt * t) + std::abs(w.tn * n) + std::abs(w.tt * t);
		}
		const Components<double> p = { system.p[2 * i], system.p[2 * i + 1] };
		const double compliance = system.blocks[system.diagonal[i]].nn;
		// u is a sum and is known only to the round-off of its terms.
		sum.addContact(
		    missOf<double>(squaredMiss(p, Components<double> { un, ut }, Friction<double> { system.mu[i] }, compliance), compliance, size, 0),
		    p, compliance);
	}
	Residual r = sum.of();
	r.bodies = 0;
	return r;
}

} // namespace cd
