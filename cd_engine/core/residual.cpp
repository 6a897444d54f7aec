#include "residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd {
namespace {

	constexpr double roundOff = 4 * std::numeric_limits<double>::epsilon();

	// Euclidean projection of (pn, pt) on the cone |p_t| <= mu p_n.
	void projectOnCone(double mu, double& pn, double& pt)
	{
		const double size = std::abs(pt);
		if (pn >= 0 && size <= mu * pn)
			return;
		if (mu * size <= -pn) {
			pn = pt = 0;
			return;
		}
		const double along = (pn + mu * size) / (1 + mu * mu);
		pt = std::copysign(mu * along, pt);
		pn = along;
	}

	// u: relative velocity with the bias; compliance: W_nn; floor: round-off of u over W_nn, below which a difference counts as none. A call a
	// contact would cost a quarter of it.
	[[gnu::always_inline]] inline void add(
	    ResidualSum& to, double pn, double pt, double un, double ut, double mu, double compliance, double floor)
	{
		double qn = pn - (un + mu * std::abs(ut)) / compliance, qt = pt - ut / compliance;
		projectOnCone(mu, qn, qt);
		const double difference = (pn - qn) * (pn - qn) + (pt - qt) * (pt - qt);
		const double d = difference <= floor * floor ? 0 : difference, square = pn * pn + pt * pt;
		to.difference += d;
		to.square += square;
		to.differenceEnergy += d * compliance;
		to.squareEnergy += square * compliance;
		// Written so that a NaN is kept and reported instead of being lost in a comparison.
		if (!(d <= to.worst))
			to.worst = d;
	}

	// Calls f(contact, its place, u_n, u_t, W_nn, floor) for every contact whose impulse can change anything, with the velocities that belong to
	// the impulses.
	template <class F> void forEachContact(const ContactSystem& system, const std::vector<double>& freeVelocity, const F& f)
	{
		static thread_local std::vector<double> v;
		v = freeVelocity;
		for (const ContactRow& c : system.contacts) {
			const double fx = c.pn * c.nx - c.pt * c.ny, fy = c.pn * c.ny + c.pt * c.nx;
			const double *ma = system.bodies[c.a].w, *mb = system.bodies[c.b].w;
			double *va = &v[3 * c.a], *vb = &v[3 * c.b];
			va[0] -= ma[0] * fx;
			va[1] -= ma[1] * fy;
			va[2] -= ma[2] * (c.pn * c.an + c.pt * c.at);
			vb[0] += mb[0] * fx;
			vb[1] += mb[1] * fy;
			vb[2] += mb[2] * (c.pn * c.bn + c.pt * c.bt);
		}
		for (std::size_t i = 0; i < system.contacts.size(); i++) {
			const ContactRow& c = system.contacts[i];
			const double *ma = system.bodies[c.a].w, *mb = system.bodies[c.b].w;
			const double *va = &v[3 * c.a], *vb = &v[3 * c.b];
			const double compliance
			    = c.nx * c.nx * (ma[0] + mb[0]) + c.ny * c.ny * (ma[1] + mb[1]) + c.an * c.an * ma[2] + c.bn * c.bn * mb[2];
			if (ContactRow::held(compliance, c.freedom(ma, mb)))
				continue; // nothing that can move along n
			const double ux = vb[0] - va[0], uy = vb[1] - va[1];
			const double ut = uy * c.nx - ux * c.ny + vb[2] * c.bt - va[2] * c.at;
			const double un = ux * c.nx + uy * c.ny + vb[2] * c.bn - va[2] * c.an + c.bias;
			// The relative velocity is known to the round-off of the velocities it is a difference of, and no better: a body gliding
			// along another at 1 m/s cannot be told from one pressed with 1e-16 of its momentum.
			const double floor
			    = roundOff * (std::abs(va[0]) + std::abs(va[1]) + std::abs(vb[0]) + std::abs(vb[1]) + std::abs(c.bias)) / compliance;
			f(c, i, un, ut, compliance, floor);
		}
	}

} // namespace

void ResidualSum::operator+=(const ResidualSum& other)
{
	difference += other.difference;
	square += other.square;
	differenceEnergy += other.differenceEnergy;
	squareEnergy += other.squareEnergy;
	if (!(other.worst <= worst))
		worst = other.worst;
}

Residual ResidualSum::of(std::size_t contacts) const
{
	if (square == 0) {
		const double e = difference == 0 ? 0 : std::numeric_limits<double>::infinity();
		return { e, e, e, std::sqrt(difference), 0 };
	}
	const double meanSquare = square / static_cast<double>(contacts);
	return { std::sqrt(difference / square), std::sqrt(differenceEnergy / squareEnergy), std::sqrt(worst / meanSquare), std::sqrt(difference),
		std::sqrt(square) };
}

Residual residual(const ContactSystem& system, const std::vector<double>& freeVelocity)
{
	ResidualSum sum;
	forEachContact(system, freeVelocity, [&](const ContactRow& c, std::size_t, double un, double ut, double compliance, double floor) {
		add(sum, c.pn, c.pt, un, ut, c.mu, compliance, floor);
	});
	return sum.of(system.contacts.size());
}

void addResiduals(
    const ContactSystem& system, const std::vector<double>& freeVelocity, const std::vector<int32_t>& partOf, std::vector<ResidualSum>& sums)
{
	forEachContact(system, freeVelocity, [&](const ContactRow& c, std::size_t i, double un, double ut, double compliance, double floor) {
		if (partOf[i] >= 0)
			add(sums[partOf[i]], c.pn, c.pt, un, ut, c.mu, compliance, floor);
	});
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
		// u is a sum, known to the round-off of its terms.
		add(sum, pn, pt, un, ut, system.mu[i], compliance, roundOff * size / compliance);
	}
	return sum.of(system.contacts());
}

} // namespace cd
