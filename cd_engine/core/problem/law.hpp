// The contact law (contact_system.hpp) in formulas. Whoever changes the law changes law.inl, this file, and what stores more numbers a contact.
#pragma once

#include "problem/contact_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {

#include "problem/law.inl"

inline Components<double> impulseOf(const ContactRow<Plane>& c) { return { c.pn, c.pt }; }
inline void setImpulse(ContactRow<Plane>& c, const Components<double>& p)
{
	c.pn = p.n;
	c.pt = p.t;
}
inline double tangentialSquare(const Components<double>& p) { return p.t * p.t; }
inline bool isZero(const Components<double>& p) { return p.n == 0 && p.t == 0; }
inline double length(const Components<double>& p) { return std::hypot(p.n, p.t); }
inline Friction<double> frictionOf(const ContactRow<Plane>& c) { return { c.mu }; }
inline Spring<double> springOf(const ContactRow<Plane>& c) { return { c.cn, c.ct, c.slipBias }; }
inline Motion<double&> velocityOf(BodyVelocity<Plane>& b) { return { b.v[0], b.v[1], b.v[2] }; }
// From an array of the freedoms of a body.
template <class Space> inline MotionOf<Space> motionOf(const double*);
template <> inline Motion<double> motionOf<Plane>(const double* v) { return { v[0], v[1], v[2] }; }
// How much the magnitude of an impulse acts on the bodies of a contact with these inverse masses [m/s].
inline double actingOnA(const Motion<double>& w, const ContactRow<Plane>& c, const Components<double>& p) { return actingOn(w, c, c.an, c.at, p); }
inline double actingOnB(const Motion<double>& w, const ContactRow<Plane>& c, const Components<double>& p) { return actingOn(w, c, c.bn, c.bt, p); }

// u of one contact for the bodies' present velocities, without the bias.
template <class Space> ImpulseOf<Space> relativeVelocity(const ContactRow<Space>& c, const BodyVelocityIn<Space>& A, const BodyVelocityIn<Space>& B)
{
	return relativeVelocity<false>(c, motionOf<Space>(A.v), motionOf<Space>(B.v));
}

// From relative velocities, those that the law is about: with the biases and what a spring yields.
template <class Space> ImpulseOf<Space> inLaw(const ContactRow<Space>& c, ImpulseOf<Space> u, const ImpulseOf<Space>& p)
{
	u.n += c.bias;
	return c.compliant() ? yielding(u, springOf(c), p) : u;
}

// Adds an impulse on `b` and its reaction on `a`.
template <class Space> void applyImpulse(const ContactRow<Space>& c, BodyVelocityIn<Space>& A, BodyVelocityIn<Space>& B, const ImpulseOf<Space>& p)
{
	push(actionOf(c, p), velocityOf(A), motionOf<Space>(A.w), velocityOf(B), motionOf<Space>(B.w));
}

// How far a contact misses its law at the velocities a, b of its bodies; compliance: W_nn + C_n; acts: what acts on both [m/s].
template <class Space>
Miss<double> missOf(const ContactRow<Space>& c, double compliance, const MotionOf<Space>& a, const MotionOf<Space>& b, double acts)
{
	const ImpulseOf<Space> p = impulseOf(c), u = inLaw(c, relativeVelocity<false>(c, a, b), p);
	const double size = sizeOf(c, c.bias, a, b) + (c.compliant() ? sizeOf(springOf(c), p) : 0);
	return missOf<double>(squaredMiss(p, u, frictionOf(c), compliance), compliance, size, acts);
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
inline Components<double> solveContact(const ContactRow<Plane>& c, const Components<double>& u, const Components<double>& p)
{
	assert(c.wnn > 0);
	const double nn = c.nn(), tt = c.tt();
	if (c.wnt == 0 && tt > 0)
		return cut(Components<double> { p.n - u.n / nn, p.t - u.t / tt }, frictionOf(c));
	return solveLocal(nn, c.wnt, c.wnt, tt, c.mu, u.n - (nn * p.n + c.wnt * p.t), u.t - (c.wnt * p.n + tt * p.t));
}
// The same where it has none. -0: 0 - 0 would lose the sign of a zero.
inline Components<double> solveContact(const ContactRow<Plane>& c, const Components<double>& u) { return solveContact(c, u, { -0., -0. }); }

} // namespace cd
