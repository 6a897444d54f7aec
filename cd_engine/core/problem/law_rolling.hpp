// What law.hpp is, for contacts that resist rolling.
#pragma once

#include "problem/contact_row_rolling.hpp"
#include "problem/law.hpp"

namespace cd {

inline RollingComponents<double> impulseOf(const ContactRow<RollingPlane>& c) { return { c.pn, c.pt, c.pr }; }
inline void setImpulse(ContactRow<RollingPlane>& c, const RollingComponents<double>& p)
{
	c.pn = p.n;
	c.pt = p.t;
	c.pr = p.r;
}
inline bool isZero(const RollingComponents<double>& p) { return p.n == 0 && p.t == 0 && p.r == 0; }
inline double length(const RollingComponents<double>& p) { return std::hypot(p.n, p.t, p.r); }
inline double tangentialSquare(const RollingComponents<double>& p) { return p.t * p.t + p.r * p.r; }
inline RollingFriction<double> frictionOf(const ContactRow<RollingPlane>& c) { return { c.mu, c.eta }; }
inline RollingSpring<double> springOf(const ContactRow<RollingPlane>& c) { return { c.cn, c.ct, c.slipBias, c.cr, c.rollBias }; }
template <> inline Motion<double> motionOf<RollingPlane>(const double* v) { return motionOf<Plane>(v); }

template <bool spinsFirst>
RollingComponents<double> relativeVelocity(const ContactRow<RollingPlane>& c, const Motion<double>& a, const Motion<double>& b)
{
	const Components<double> u = relativeVelocity<spinsFirst>(static_cast<const ContactRow<Plane>&>(c), a, b);
	return { u.n, u.t, rolling<double>(c, a, b) };
}
inline double sizeOf(const ContactRow<RollingPlane>& c, double bias, const Motion<double>& a, const Motion<double>& b)
{
	return sizeOf<double>(static_cast<const ContactRow<Plane>&>(c), bias, a, b) + std::abs(c.ar * a.spin) + std::abs(c.br * b.spin);
}
inline double actingOnA(const Motion<double>& w, const ContactRow<RollingPlane>& c, const RollingComponents<double>& p)
{
	return actingOn(w, c, c.an, c.at, withoutMoment(p)) + c.ar * c.ar * w.spin * std::abs(p.r);
}
inline double actingOnB(const Motion<double>& w, const ContactRow<RollingPlane>& c, const RollingComponents<double>& p)
{
	return actingOn(w, c, c.bn, c.bt, withoutMoment(p)) + c.br * c.br * w.spin * std::abs(p.r);
}

// What solveRolling() needs of a contact. Where t and r move as one, the share of t alone is only round-off, and p_t may stay as it is.
inline RollingBlock<double> inverseBlockOf(const ContactRow<RollingPlane>& c)
{
	const double tt = c.tt(), rr = c.rr(), ratio = rr > 0 ? c.wtr / rr : 0;
	return { 1 / c.nn(), 1 / tt, rr > 0 ? 1 / rr : 0, 1 / std::max(tt - ratio * c.wtr, 1e-14 * tt), c.wtr, ratio };
}

// Of a contact that couples all three: q, the relative velocities without its own impulses.
RollingComponents<double> solveCoupled(const ContactRow<RollingPlane>& c, const RollingComponents<double>& q);

// The impulses of a contact while all others are held; u: inLaw() of the impulses p.
inline RollingComponents<double> solveContact(
    const ContactRow<RollingPlane>& c, const RollingComponents<double>& u, const RollingComponents<double>& p)
{
	assert(c.wnn > 0);
	if (c.wnt == 0 && c.wnr == 0 && c.tt() > 0 && (c.eta == 0 || c.rr() > 0))
		return solveRolling(inverseBlockOf(c), frictionOf(c), p, u);
	return solveCoupled(c,
	    { u.n - (c.nn() * p.n + c.wnt * p.t + c.wnr * p.r), u.t - (c.wnt * p.n + c.tt() * p.t + c.wtr * p.r),
		u.r - (c.wnr * p.n + c.wtr * p.t + c.rr() * p.r) });
}
inline RollingComponents<double> solveContact(const ContactRow<RollingPlane>& c, const RollingComponents<double>& u)
{
	return solveContact(c, u, { -0., -0., -0. });
}

} // namespace cd
