#include "solvability/resolution.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace cd {
namespace {

	// Power with which loaded contacts close, less that with which they part, over the sum of both. It is 1 where boundaries close in on
	// bodies; the errors of sweeps have either sign and mostly cancel.
	constexpr double yielding = 0.4;
	constexpr double sixDigits = 1e-5; // round-off of p . W p relative to its terms, if the numbers of W come from a file with six digits

	class Sum {
	    public:
		// un, free: normal velocities with and without the impulses p; terms: the magnitudes of what adds up to un.
		// tangential: |p_t|^2.
		void add(int32_t contact, double compliance, double un, double free, double terms, double pn, double tangential)
		{
			const double square = compliance * (pn * pn + tangential), power = -pn * un;
			if (!std::isfinite(un) || !std::isfinite(square)) {
				if (found.finite)
					found.contact = contact;
				found.finite = false;
				return;
			}
			const double miss = std::abs(std::min(un, compliance * pn));
			found.miss = std::max(found.miss, miss - roundOff * terms);
			most = std::max(most, compliance);
			found.free = std::max(found.free, -free);
			impulses += square;
			alone += free < 0 ? free * free / compliance : 0;
			closing += power;
			all += std::abs(power);
			if (found.finite && (power > strongest || (strongest <= 0 && square > largest))) {
				found.contact = contact;
				strongest = std::max(power, 0.);
				largest = square;
			}
		}
		Resolution result()
		{
			// The velocities of a body are sums over all its impulses.
			found.miss = std::max(0., found.miss - roundOff * std::sqrt(most * impulses));
			found.yields = closing > yielding * all;
			found.growth = !found.finite ? std::numeric_limits<double>::infinity() : alone > 0 ? std::sqrt(impulses / alone) : 0;
			return found;
		}

		Resolution found;

	    private:
		double impulses = 0, alone = 0; // [J]
		double closing = 0, all = 0; // powers, as all powers here impulse times velocity [J]
		double most = 0; // compliance [1/kg]
		double strongest = 0, largest = 0;
	};

} // namespace

template <class Space> Resolution resolution(const ContactSystem<Space>& s, const std::vector<double>& freeVelocity)
{
	assert(freeVelocity.size() == Space::freedoms * s.bodies.size());
	Sum sum;
	for (std::size_t i = 0; i < s.contacts.size(); i++) {
		const ContactRow<Space>& c = s.contacts[i];
		if (!(c.wnn > 0))
			continue;
		constexpr int n = Space::freedoms;
		const double un = relativeVelocity(c, s.bodies[c.a], s.bodies[c.b]).n;
		const double free = relativeVelocity<false>(c, motionOf<Space>(&freeVelocity[n * c.a]), motionOf<Space>(&freeVelocity[n * c.b])).n;
		const double size = sizeOf(c, c.bias, motionOf<Space>(s.bodies[c.a].v), motionOf<Space>(s.bodies[c.b].v));
		sum.add(static_cast<int32_t>(i), c.wnn, un + c.bias, free + c.bias, size, c.pn, tangentialSquare(impulseOf(c)));
	}
	return sum.result();
}
template Resolution resolution(const ContactSystem<Plane>&, const std::vector<double>&);
template Resolution resolution(const ContactSystem<Space3>&, const std::vector<double>&);
template Resolution resolution(const ContactSystem<RollingPlane>&, const std::vector<double>&);

Resolution resolution(const DelassusSystem& s)
{
	Sum sum;
	double energy = 0, terms = 0;
	for (std::size_t i = 0; i < s.contacts(); i++) {
		double n = 0, t = 0, sizes[2] = { 0, 0 };
		for (std::size_t k = s.start[i]; k < s.start[i + 1]; k++) {
			const Block& w = s.blocks[k];
			const double pn = s.p[2 * s.column[k]], pt = s.p[2 * s.column[k] + 1];
			n += w.nn * pn + w.nt * pt;
			t += w.tn * pn + w.tt * pt;
			sizes[0] += std::abs(w.nn * pn) + std::abs(w.nt * pt);
			sizes[1] += std::abs(w.tn * pn) + std::abs(w.tt * pt);
		}
		const double pn = s.p[2 * i], pt = s.p[2 * i + 1];
		energy += pn * n + pt * t;
		terms += std::abs(pn) * sizes[0] + std::abs(pt) * sizes[1];
		sum.add(
		    static_cast<int32_t>(i), s.blocks[s.diagonal[i]].nn, n + s.q[2 * i], s.q[2 * i], sizes[0] + std::abs(s.q[2 * i]), pn, pt * pt);
	}
	sum.found.indefinite = energy < -sixDigits * terms;
	return sum.result();
}

Resolution resolution(const ConeSystem& s)
{
	Sum sum;
	double energy = 0, terms = 0;
	for (std::size_t i = 0; i < s.contacts(); i++) {
		const Triple u = difference(s.velocity(i, s.p), s.q[i]), &p = s.p[i];
		Triple sizes = { 0, 0, 0 };
		for (std::size_t k = s.start[i]; k < s.start[i + 1]; k++)
			for (std::size_t c = 0; c < 9; c++)
				sizes[c / 3] += std::abs(s.blocks[k][c] * s.p[s.column[k]][c % 3]);
		for (std::size_t c = 0; c < 3; c++) {
			energy += p[c] * u[c];
			terms += std::abs(p[c]) * sizes[c];
		}
		const double free = s.q[i][0];
		sum.add(static_cast<int32_t>(i), s.own(i)[0], u[0] + free, free, sizes[0] + std::abs(free), p[0], p[1] * p[1] + p[2] * p[2]);
	}
	sum.found.indefinite = energy < -sixDigits * terms;
	return sum.result();
}

template <class Space> double energyGain(const ContactSystem<Space>& s, const std::vector<double>& freeVelocity)
{
	double after = 0, before = 0; // twice the energies [J]
	for (std::size_t i = 0; i < s.bodies.size(); i++)
		for (int k = 0; k < Space::freedoms; k++)
			if (const double w = s.bodies[i].w[k]; w > 0) {
				const double v = s.bodies[i].v[k], free = freeVelocity[Space::freedoms * i + k];
				after += v * v / w;
				before += free * free / w;
			}
	return after > 0 ? after / before : 0;
}
template double energyGain(const ContactSystem<Plane>&, const std::vector<double>&);
template double energyGain(const ContactSystem<Space3>&, const std::vector<double>&);
template double energyGain(const ContactSystem<RollingPlane>&, const std::vector<double>&);

} // namespace cd
