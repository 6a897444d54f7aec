// What law.hpp is for contacts in the plane.
#pragma once

#include "problem/contact_row_in_space.hpp"
#include "problem/law.hpp"

namespace cd {

inline SpatialComponents<double> impulseOf(const ContactRow<Space3>& c) { return { c.pn, c.px, c.py, c.pz }; }
inline void setImpulse(ContactRow<Space3>& c, const SpatialComponents<double>& p)
{
	c.pn = p.n;
	c.px = p.x;
	c.py = p.y;
	c.pz = p.z;
}
inline bool isZero(const SpatialComponents<double>& p) { return p.n == 0 && p.x == 0 && p.y == 0 && p.z == 0; }
inline double length(const SpatialComponents<double>& p) { return std::sqrt(dot(p, p)); }
inline Friction<double> frictionOf(const ContactRow<Space3>& c) { return { c.mu }; }
inline SpatialSpring<double> springOf(const ContactRow<Space3>& c) { return { c.cn, c.ct, c.slipX, c.slipY, c.slipZ }; }
inline SpatialMotion<double&> velocityOf(BodyVelocity<Space3>& b) { return { b.v[0], b.v[1], b.v[2], b.v[3], b.v[4], b.v[5] }; }
template <> inline SpatialMotion<double> motionOf<Space3>(const double* v) { return { v[0], v[1], v[2], v[3], v[4], v[5] }; }

// How much the magnitude of an impulse acts on a body with these inverse masses [m/s].
inline double actingOn(const SpatialMotion<double>& w, const ContactRow<Space3>& c, double arm, const SpatialComponents<double>& p)
{
	const double along = c.nx * c.nx * w.x + c.ny * c.ny * w.y + c.nz * c.nz * w.z;
	return along * std::abs(p.n) + (0.5 * (w.x + w.y + w.z - along) + arm * arm * w.spinX) * std::sqrt(tangentialSquare(p));
}
inline double actingOnA(const SpatialMotion<double>& w, const ContactRow<Space3>& c, const SpatialComponents<double>& p)
{
	return actingOn(w, c, c.at, p);
}
inline double actingOnB(const SpatialMotion<double>& w, const ContactRow<Space3>& c, const SpatialComponents<double>& p)
{
	return actingOn(w, c, c.bt, p);
}

// The impulses of a contact while all others are held; u: inLaw() of the impulses p.
inline SpatialComponents<double> solveContact(const ContactRow<Space3>& c, const SpatialComponents<double>& u, const SpatialComponents<double>& p)
{
	assert(c.wnn > 0);
	const double across = c.tt() > 0 ? 1 / c.tt() : 0;
	return cut(SpatialComponents<double> { p.n - u.n / c.nn(), p.x - u.x * across, p.y - u.y * across, p.z - u.z * across }, frictionOf(c));
}

inline SpatialComponents<double> solveContact(const ContactRow<Space3>& c, const SpatialComponents<double>& u)
{
	return solveContact(c, u, { -0., -0., -0., -0. });
}

} // namespace cd
