#include "error/residual.hpp"

#include "graph/graph.hpp"
#include "base/base.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	constexpr double roundOff = 4 * std::numeric_limits<double>::epsilon();
	constexpr double manyLoops = 200; // loops of an island from which the mean over the mass counts in full
	constexpr double farBelow = 0.1; // of that mean: a heavy body below it has its own term; walls as heavy as 2 sqrt(N) disks have 0.16 to 0.3
	constexpr double nothing = 1e-6; // of that mean: a smaller s counts as this
	constexpr double single = 10; // root mean squares that a single contact may miss there; in a packing it misses 5 to 20

	// Sets a square to 0 if it is at most floor^2.
	inline double beyond(double square, double floor) { return square <= floor * floor ? 0 : square; }

	// Written so that a NaN is kept and reported; a plain comparison would lose it.
	inline void raise(double& largest, double value)
	{
		if (!(value <= largest))
			largest = value;
	}

	void moveBodies(const ContactSystem& system, const std::vector<double>& freeVelocity, std::vector<Moved>& moved)
	{
		moved.resize(system.bodies.size());
		for (std::size_t i = 0; i < moved.size(); i++)
			moved[i] = { { freeVelocity[3 * i], freeVelocity[3 * i + 1], freeVelocity[3 * i + 2] }, system.bodies[i].pushed };
		for (const ContactRow& c : system.contacts) {
			const double fx = c.pn * c.nx - c.pt * c.ny, fy = c.pn * c.ny + c.pt * c.nx;
			const BodyVelocity &A = system.bodies[c.a], &B = system.bodies[c.b];
			const bool passes = c.wnn > 0; // else nothing can move along the normal
			Moved &a = moved[c.a], &b = moved[c.b];
			a.v[0] -= A.w[0] * fx;
			a.v[1] -= A.w[1] * fy;
			a.v[2] -= A.w[2] * (c.pn * c.an + c.pt * c.at);
			a.s += actionOn(A.w, c, c.an, c.at) + (passes ? A.twisted * std::abs(c.at) : 0);
			b.v[0] += B.w[0] * fx;
			b.v[1] += B.w[1] * fy;
			b.v[2] += B.w[2] * (c.pn * c.bn + c.pt * c.bt);
			b.s += actionOn(B.w, c, c.bn, c.bt) + (passes ? B.twisted * std::abs(c.bt) : 0);
		}
	}

	// Of the bodies.
	struct Bodies {
		std::vector<Moved> moved;
		std::vector<char> met;
		std::vector<double> asked; // smallest s of the far heavier bodies that it carries [m/s]
	};

} // namespace

double actionOn(const double* w, const ContactRow& c, double n, double t)
{
	const double x = c.nx * c.nx, y = c.ny * c.ny;
	return (x * w[0] + y * w[1] + n * n * w[2]) * std::abs(c.pn) + (y * w[0] + x * w[1] + t * t * w[2]) * std::abs(c.pt);
}

Miss missOf(const ContactRow& c, double compliance, const Moved& a, const Moved& b)
{
	const double ux = b.v[0] - a.v[0], uy = b.v[1] - a.v[1];
	const double ut = uy * c.nx - ux * c.ny + b.v[2] * c.bt - a.v[2] * c.at;
	const double un = ux * c.nx + uy * c.ny + b.v[2] * c.bn - a.v[2] * c.an + c.bias;
	const double square = squaredDifference(c.pn, c.pt, un, ut, c.mu, compliance);
	// A relative velocity is known only to the round-off of the velocities that it is the difference of: a body that glides along another at 1
	// m/s cannot be told from one pressed on it with 1e-16 of its momentum. Velocities are sums of what acts, and known only to the round-off of
	// these sums. That round-off is no violation of the contact law, but it is an error of the bodies.
	const double ofVelocities = roundOff
	    * (std::abs(a.v[0]) + std::abs(a.v[1]) + std::abs(b.v[0]) + std::abs(b.v[1]) + std::abs(c.bias)
		+ std::abs(a.v[2]) * (std::abs(c.an) + std::abs(c.at)) + std::abs(b.v[2]) * (std::abs(c.bn) + std::abs(c.bt)));
	const double least = std::numeric_limits<double>::epsilon() * (a.s + b.s);
	return { beyond(square, (ofVelocities + roundOff * (a.s + b.s)) / compliance),
		std::max(beyond(square, ofVelocities / compliance) * compliance * compliance, least * least) };
}

void ResidualSum::addContact(double difference_, double velocity, double square_, double compliance)
{
	contacts++;
	difference += difference_;
	square += square_;
	differenceEnergy += difference_ * compliance;
	squareEnergy += square_ * compliance;
	raise(worst, difference_);
	missed += velocity;
	raise(mostMissed, velocity);
}

void ResidualSum::addUnderHeavy(double velocity, double s)
{
	if (!std::isfinite(s))
		return;
	raise(missedUnderHeavy, velocity);
	leastHeavy = std::min(leastHeavy, s);
}

void ResidualSum::add(const ResidualSum& other)
{
	contacts += other.contacts;
	difference += other.difference;
	square += other.square;
	differenceEnergy += other.differenceEnergy;
	squareEnergy += other.squareEnergy;
	raise(worst, other.worst);
	missed += other.missed;
	raise(mostMissed, other.mostMissed);
	raise(missedUnderHeavy, other.missedUnderHeavy);
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
	r.norm = std::sqrt(all.difference / all.square);
	r.work = all.squareEnergy;
	r.energy = std::sqrt(all.differenceEnergy / all.squareEnergy);
	r.maximum = std::sqrt(all.worst / (all.square / static_cast<double>(all.contacts)));
	return r;
}

Residual residual(const ContactSystem& system, const std::vector<double>& freeVelocity)
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

void addResiduals(const ContactSystem& system, const std::vector<double>& freeVelocity, const std::vector<int32_t>& islandOf,
    std::vector<ResidualSum>& sums, const int32_t* numbers)
{
	const Borrowed<Bodies> bodies(system.memory);
	auto& [moved, met, asked] = *bodies;
	moveBodies(system, freeVelocity, moved);
	met.assign(moved.size(), 0);
	asked.assign(moved.size(), std::numeric_limits<double>::infinity());
	forEachCarried(system, [&](int32_t light, int32_t heavy) {
		if (moved[heavy].s > 0)
			asked[light] = std::min(asked[light], moved[heavy].s);
	});
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow& c = system.contacts[i];
		const double *ma = system.bodies[c.a].w, *mb = system.bodies[c.b].w;
		const double compliance = c.nx * c.nx * (ma[0] + mb[0]) + c.ny * c.ny * (ma[1] + mb[1]) + c.an * c.an * ma[2] + c.bn * c.bn * mb[2];
		if (islandOf[i] < 0 || ContactRow::held(compliance, c.freedom(ma, mb)))
			continue; // nothing can move along n
		ResidualSum& sum = sums[islandOf[i]];
		const Miss miss = missOf(c, compliance, moved[c.a], moved[c.b]);
		sum.addContact(miss.difference, miss.velocity, c.pn * c.pn + c.pt * c.pt, compliance);
		sum.addUnderHeavy(miss.velocity, std::min(asked[c.a], asked[c.b]));
		// Bodies are added as the contacts meet them, so that the sums do not depend on the numbering of the bodies.
		for (const int32_t body : { c.a, c.b })
			if (!met[body]) {
				met[body] = 1;
				const double* const w = system.bodies[body].w;
				const double inverse = std::max(w[0], w[1]);
				if (inverse > 0 || w[2] > 0)
					sum.addBody(inverse > 0 ? 1 / inverse : 0, moved[body].s, numbers ? numbers[body] : body);
			}
	}
}

Residual residual(const DelassusSystem& system)
{
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
		const double pn = system.p[2 * i], pt = system.p[2 * i + 1], compliance = system.blocks[system.diagonal[i]].nn;
		// u is a sum and is known only to the round-off of its terms.
		const double d = beyond(squaredDifference(pn, pt, un, ut, system.mu[i], compliance), roundOff * size / compliance);
		sum.addContact(d, d * compliance * compliance, pn * pn + pt * pt, compliance);
	}
	Residual r = sum.of();
	r.bodies = 0;
	return r;
}

} // namespace cd
