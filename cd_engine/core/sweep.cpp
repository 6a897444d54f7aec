#include "sweep.hpp"
#include "local_problem.hpp"

#include <algorithm>
#include <cmath>

namespace cd {

Sweep::Sweep(ContactSystem& s, unsigned seed)
    : system(s)
    , freeVelocity(3 * s.bodies.size())
    , order(seed)
{
	for (size_t i = 0; i < s.bodies.size(); i++)
		std::copy_n(s.bodies[i].v, 3, &freeVelocity[3 * i]);
	diagonal.resize(s.contacts.size());
	diagonalRows.reserve(s.contacts.size());
	for (size_t i = 0; i < s.contacts.size(); i++) {
		const ContactRow& c = s.contacts[i];
		if (!(c.wnn > 0))
			continue; // two immobile bodies
		if (!c.diagonal() || !(c.wtt > 0)) {
			generalRows.push_back(static_cast<int32_t>(i));
			continue;
		}
		// Member by member: a whole struct would be built on the stack and copied, at three times the cost.
		Diagonal& d = diagonal[diagonalRows.size()];
		d.a = c.a;
		d.b = c.b;
		d.nx = c.nx;
		d.ny = c.ny;
		d.at = c.at;
		d.bt = c.bt;
		d.bias = c.bias;
		d.mu = c.mu;
		d.inverseWnn = 1 / c.wnn;
		d.inverseWtt = 1 / c.wtt;
		d.pn = c.pn;
		d.pt = c.pt;
		diagonalRows.push_back(static_cast<int32_t>(i));
	}
	diagonal.resize(diagonalRows.size());
	restoreVelocities();
}

void Sweep::restoreVelocities()
{
	for (size_t i = 0; i < system.bodies.size(); i++)
		for (int k = 0; k < 3; k++)
			system.bodies[i].v[k] = freeVelocity[3 * i + k];
	storeImpulses();
	for (const ContactRow& c : system.contacts)
		applyImpulse(c, system.bodies[c.a], system.bodies[c.b], c.pn, c.pt);
}

void Sweep::storeImpulses()
{
	for (size_t i = 0; i < diagonal.size(); i++) {
		ContactRow& c = system.contacts[diagonalRows[i]];
		c.pn = diagonal[i].pn;
		c.pt = diagonal[i].pt;
	}
}

inline void Sweep::solveDiagonal(Diagonal& c, BodyVelocity* bodies)
{
	BodyVelocity &A = bodies[c.a], &B = bodies[c.b];
	const double dx = B.v[0] - A.v[0], dy = B.v[1] - A.v[1];
	const double un = c.nx * dx + c.ny * dy + c.bias;
	const double ut = c.nx * dy - c.ny * dx + (c.bt * B.v[2] - c.at * A.v[2]);
	// Without coupling the normal law decides alone, then the tangential impulse that stops sliding is cut at the cone.
	const double pn = std::max(0., c.pn - un * c.inverseWnn);
	const double limit = c.mu * pn;
	const double pt = std::max(-limit, std::min(limit, c.pt - ut * c.inverseWtt));
	const double dn = pn - c.pn, dt = pt - c.pt;
	c.pn = pn;
	c.pt = pt;
	const double px = c.nx * dn - c.ny * dt, py = c.ny * dn + c.nx * dt;
	A.v[0] -= A.w[0] * px;
	A.v[1] -= A.w[1] * py;
	A.v[2] -= A.w[2] * (c.at * dt);
	B.v[0] += B.w[0] * px;
	B.v[1] += B.w[1] * py;
	B.v[2] += B.w[2] * (c.bt * dt);
}

void Sweep::solveGeneral(ContactRow& c, BodyVelocity* bodies)
{
	BodyVelocity &A = bodies[c.a], &B = bodies[c.b];
	double un, ut, pn, pt;
	relativeVelocity(c, A, B, un, ut);
	const double qn = un + c.bias - (c.wnn * c.pn + c.wnt * c.pt), qt = ut - (c.wnt * c.pn + c.wtt * c.pt);
	solveLocal(c.wnn, c.wnt, c.wnt, c.wtt, c.mu, qn, qt, pn, pt);
	applyImpulse(c, A, B, pn - c.pn, pt - c.pt);
	c.pn = pn;
	c.pt = pt;
}

void Sweep::operator()()
{
	BodyVelocity* const bodies = system.bodies.data();
	if (order) {
		for (const int32_t i : order.next(size())) {
			if (static_cast<size_t>(i) < diagonal.size())
				solveDiagonal(diagonal[i], bodies);
			else
				solveGeneral(system.contacts[generalRows[i - diagonal.size()]], bodies);
		}
		return;
	}
	for (Diagonal& c : diagonal)
		solveDiagonal(c, bodies);
	for (const int32_t i : generalRows)
		solveGeneral(system.contacts[i], bodies);
}

} // namespace cd
