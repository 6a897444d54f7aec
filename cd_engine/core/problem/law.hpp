// The contact law (contact_system.hpp) in formulas. Whoever changes the law changes law.inl, this file, and what stores more numbers a contact.
#pragma once

#include "problem/contact_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {

#include "problem/law.inl"

inline Components<double> impulseOf(const ContactRow& c) { return { c.pn, c.pt }; }
inline void setImpulse(ContactRow& c, const Components<double>& p)
{
	c.pn = p.n;
	c.pt = p.t;
}
inline Friction<double> frictionOf(const ContactRow& c) { return { c.mu }; }
inline Spring<double> springOf(const ContactRow& c) { return { c.cn, c.ct, c.slipBias }; }
inline Motion<double> motionOf(const double* v) { return { v[0], v[1], v[2] }; }

// u_n and u_t of one contact for the bodies' present velocities.
inline void relativeVelocity(const ContactRow& c, const BodyVelocity& A, const BodyVelocity& B, double& un, double& ut)
{
	const Components<double> u = relativeVelocity<false>(c, motionOf(A.v), motionOf(B.v));
	un = u.n;
	ut = u.t;
}

// From relative velocities, those that the law is about: with the biases and what a spring yields.
inline Components<double> inLaw(const ContactRow& c, Components<double> u, const Components<double>& p)
{
	u.n += c.bias;
	return c.compliant() ? yielding(u, springOf(c), p) : u;
}

// Adds the impulse (pn, pt) on `b` and its reaction on `a`.
inline void applyImpulse(const ContactRow& c, BodyVelocity& A, BodyVelocity& B, double pn, double pt)
{
	const auto velocity = [](BodyVelocity& b) { return Motion<double&> { b.v[0], b.v[1], b.v[2] }; };
	push(actionOf(c, Components<double> { pn, pt }), velocity(A), motionOf(A.w), velocity(B), motionOf(B.w));
}

// |p - P_K(...)|^2; un, ut: relative velocity, with the bias.
inline double squaredDifference(double pn, double pt, double un, double ut, double mu, double compliance)
{
	return squaredMiss<double>({ pn, pt }, { un, ut }, { mu }, compliance);
}

// cut() that keeps a NaN and the sign of a zero: a NaN tells that a solution has failed.
inline Components<double> cutKeeping(const Components<double>& z, double mu)
{
	const double n = std::max(z.n, 0.);
	return { n, std::clamp(z.t, -mu * n, mu * n) };
}

// As in law.inl, for one contact.
inline Components<double> solveLocal(double wnn, double wnt, double wtn, double wtt, double mu, double qn, double qt)
{
	if (!(qn < 0))
		return { 0, 0 };
	const double determinant = wnn * wtt - wnt * wtn;
	const bool regular = determinant > 1e-14 * wnn * wtt;
	if (regular) {
		const double pn = (-qn * wtt + qt * wnt) / determinant, pt = (-qt * wnn + qn * wtn) / determinant;
		if (pn >= 0 && std::abs(pt) <= mu * pn)
			return { pn, pt };
	}
	const Components<double> stops = { -qn / wnn, 0 };
	// No impulse changes the velocity along t, which is qt + wtn pn. Where bodies are driven so that they slide, friction opposes it. Where they
	// do not, up to round-off (beside the velocity -qn with which they would close), any friction within the cone would do, and none is taken.
	if (!regular && wtt <= 1e-14 * wnn && !(std::abs(qt * wnn - wtn * qn) > 1e-12 * std::abs(qt * wnn) - 1e-10 * qn * wnn))
		return stops;
	for (const double side : { -1., 1. }) {
		const double w = wnn + side * mu * wnt;
		if (w <= 0)
			continue;
		const double pn = -qn / w;
		if (!(side * (qt + (wtn + side * mu * wtt) * pn) > 0)) // else friction would push along the motion
			return { pn, side * mu * pn };
	}
	return stops;
}

// The impulses of a contact while all others are held; u: inLaw() of the impulses p.
inline Components<double> solveContact(const ContactRow& c, const Components<double>& u, const Components<double>& p)
{
	assert(c.wnn > 0);
	const double nn = c.nn(), tt = c.tt();
	if (c.wnt == 0 && tt > 0)
		return cut<double>({ p.n - u.n / nn, p.t - u.t / tt }, frictionOf(c));
	return solveLocal(nn, c.wnt, c.wnt, tt, c.mu, u.n - (nn * p.n + c.wnt * p.t), u.t - (c.wnt * p.n + tt * p.t));
}

} // namespace cd
