// The contact law, each of its formulas once: for a double, and for a vector of lanes, one of GCC's vector types (N below). law.hpp includes this
// file for all rooms, and group_kernel.cpp once for every instruction set; so it has no include guard, and its functions are always inlined and call
// nothing else. The order of the operations is part of every result.

#define LAW static inline __attribute__((always_inline))

template <class N> LAW N larger(const N& a, const N& b) { return a > b ? a : b; }
template <class N> LAW N smaller(const N& a, const N& b) { return a < b ? a : b; }
template <class N> LAW N absolute(const N& x) { return larger(x, -x); }
LAW double absolute(double x) { return __builtin_fabs(x); }
// The larger one; a NaN in x is kept, but not in lanes.
template <class N> LAW N atLeast(const N& least, const N& x) { return larger(x, least); }
LAW double atLeast(double least, double x) { return x <= least ? least : x; }

// Of an impulse or a relative velocity: along n and t.
template <class N> struct Components {
	N n, t;
};
template <class N> LAW Components<N> operator-(const Components<N>& a, const Components<N>& b) { return { a.n - b.n, a.t - b.t }; }
template <class N> LAW N dot(const Components<N>& a, const Components<N>& b) { return a.n * b.n + a.t * b.t; }
// p + beta (p - before)
template <class N> LAW Components<N> extrapolated(const Components<N>& p, const Components<N>& before, double beta)
{
	return { p.n + beta * (p.n - before.n), p.t + beta * (p.t - before.t) };
}

// Of a contact with stiffness: the compliances, and the bias of its slip.
template <class N> struct Spring {
	N n, t, bias;
};
// u_n + C_n p_n, u_t + slipBias + C_t p_t
template <class N> LAW Components<N> yielding(const Components<N>& u, const Spring<N>& by, const Components<N>& p)
{
	return { u.n + by.n * p.n, u.t + (by.bias + by.t * p.t) };
}
// The sum of the magnitudes of what this adds.
template <class N> LAW N sizeOf(const Spring<N>& of, const Components<N>& p)
{
	return absolute(of.n * p.n) + absolute(of.bias) + absolute(of.t * p.t);
}

// Of a body: velocity and angular velocity, or the inverses of its masses.
template <class N> struct Motion {
	N x, y, spin;
};
// What an impulse on b does: itself, and its moments about the centres of a, which takes the opposite, and of b.
template <class N> struct Action {
	N x, y, turnA, turnB;
};
// A contact whose normal passes through the centres of both bodies. ContactRow has the same members, and an, bn.
template <class N> struct CentralContact {
	static constexpr bool central = true;
	N nx, ny, at, bt;
};
// How far a contact resists sliding: Coulomb's coefficient.
template <class N> struct Friction {
	N mu;
};
// The inverse mass of a body whose impulses are added up.
struct UnitMass { };
template <class N> LAW const N& operator*(UnitMass, const N& x) { return x; }
// A compliance whose inverse is known. Whatever takes a compliance takes a plain number, too, by which it divides.
template <class N> struct Compliance {
	N value, inverse;
};
template <class N> LAW N over(const N& x, double compliance) { return x / compliance; }
template <class N> LAW N over(const N& x, const Compliance<N>& compliance) { return x * compliance.inverse; }
LAW double value(double compliance) { return compliance; }
template <class N> LAW const N& value(const Compliance<N>& compliance) { return compliance.value; }

// u = H^T v, without the bias. spinsFirst: the order in which sweeps add.
template <bool spinsFirst, class N, class Contact> LAW Components<N> relativeVelocity(const Contact& c, const Motion<N>& a, const Motion<N>& b)
{
	const N dx = b.x - a.x, dy = b.y - a.y;
	Components<N> u = { c.nx * dx + c.ny * dy, c.nx * dy - c.ny * dx };
	const auto add = [](N& to, const N& ofB, const N& ofA) { to = spinsFirst ? to + (ofB - ofA) : to + ofB - ofA; };
	if constexpr (!Contact::central)
		add(u.n, c.bn * b.spin, c.an * a.spin);
	add(u.t, c.bt * b.spin, c.at * a.spin);
	return u;
}

// The sum of the magnitudes of the terms of u. A relative velocity is known only to their round-off.
template <class N, class Contact> LAW N sizeOf(const Contact& c, const N& bias, const Motion<N>& a, const Motion<N>& b)
{
	const N sum = absolute(a.x) + absolute(a.y) + absolute(b.x) + absolute(b.y) + absolute(bias);
	if constexpr (Contact::central)
		return sum + absolute(c.at * a.spin) + absolute(c.bt * b.spin);
	else
		return sum + absolute(a.spin) * (absolute(c.an) + absolute(c.at)) + absolute(b.spin) * (absolute(c.bn) + absolute(c.bt));
}

// H p
template <class N, class Contact> LAW Action<N> actionOf(const Contact& c, const Components<N>& p)
{
	const N x = c.nx * p.n - c.ny * p.t, y = c.ny * p.n + c.nx * p.t;
	if constexpr (Contact::central)
		return { x, y, c.at * p.t, c.bt * p.t };
	else
		return { x, y, c.an * p.n + c.at * p.t, c.bn * p.n + c.bt * p.t };
}

// v += M^-1 H p, for velocities a, b and inverse masses wa, wb.
template <class N, class V, class W> LAW void push(const Action<N>& of, V&& a, const W& wa, V&& b, const W& wb)
{
	a.x -= wa.x * of.x;
	a.y -= wa.y * of.y;
	a.spin -= wa.spin * of.turnA;
	b.x += wb.x * of.x;
	b.y += wb.y * of.y;
	b.spin += wb.spin * of.turnB;
}

// How much the magnitude of an impulse acts on a body of these inverse masses and lever arms [m/s]; for unit masses and a central contact the same
// without them.
template <class N, class Contact> LAW N actingOn(const Motion<N>& w, const Contact& c, const N& n, const N& t, const Components<N>& p)
{
	const N x = c.nx * c.nx, y = c.ny * c.ny;
	return (x * w.x + y * w.y + n * n * w.spin) * absolute(p.n) + (y * w.x + x * w.y + t * t * w.spin) * absolute(p.t);
}
template <class N> LAW N actingOn(const N& t, const Components<N>& p) { return absolute(p.n) + absolute(p.t) + t * t * absolute(p.t); }

// Coulomb's cut of each component for itself: p_n >= 0, |p_t| <= mu p_n. This solves a contact that does not couple n and t, exactly.
template <class N> LAW Components<N> cut(const Components<N>& p, const Friction<N>& by)
{
	const N n = larger(p.n, N {}), limit = by.mu * n;
	return { n, larger(smaller(p.t, limit), -limit) };
}

// The same for the impulses of a step before, up to the round-off of dt times force and back: `coneFactor` is the factor on mu p_n.
template <class N> LAW N cutGuess(const Components<N>& p, const N& mu, double coneFactor)
{
	const N most = mu * p.n;
	return absolute(p.t) > most * coneFactor ? (p.t < N {} ? -most : most) : p.t;
}

// The nearest point of Coulomb's cone.
template <class N> LAW Components<N> projected(const Components<N>& q, const N& mu)
{
	const N none = {}, length = absolute(q.t);
	const auto inside = (q.n >= none) & (length <= mu * q.n), behind = mu * length <= -q.n;
	const N along = (q.n + mu * length) / (1 + mu * mu), across = mu * along;
	return { inside ? q.n : behind ? none : along, inside ? q.t : behind ? none : q.t < none ? -across : across };
}

// |p - P_K(p - (u + mu |u_t| n)/W_nn)|^2 (residual.hpp), with the bias in u.
template <class N, class W> LAW N squaredMiss(const Components<N>& p, const Components<N>& u, const Friction<N>& by, const W& wnn)
{
	const Components<N> q = projected<N>({ p.n - over<N>(u.n + by.mu * absolute(u.t), wnn), p.t - over<N>(u.t, wnn) }, by.mu);
	return dot(p - q, p - q);
}

// How far a contact misses the law, squared.
template <class N> struct Miss {
	N difference, velocity; // in its impulse [N^2 s^2], in its velocity [m^2/s^2]
};

// Without what round-off explains. A body that glides along another at 1 m/s cannot be told from one pressed on it with 1e-16 of its momentum.
// Velocities are sums of what acts, and known only to the round-off of these sums. That round-off is no violation of the law, but it is an error of
// the bodies. square: squaredMiss(); size: sizeOf(); acts: on both bodies [m/s].
template <class N, class W> LAW Miss<N> missOf(const N& square, const W& wnn, const N& size, const N& acts)
{
	constexpr double epsilon = 2.220446049250313e-16, roundOff = 4 * epsilon;
	const N none = {};
	const N ofVelocities = roundOff * size, least = epsilon * acts;
	const N known = over<N>(ofVelocities, wnn), knownOfSums = over<N>(ofVelocities + roundOff * acts, wnn);
	return { square <= knownOfSums * knownOfSums ? none : square,
		atLeast<N>(least * least, square <= known * known ? none : square * value(wnn) * value(wnn)) };
}

// Adds a contact to the sums that make the error (ResidualSum). square: |p|^2. An impulse of which the law would take half or more is stale.
template <class Sums, class N> LAW void addTo(Sums& sums, const Miss<N>& miss, const N& square, const N& wnn)
{
	sums.difference += miss.difference;
	sums.square += square;
	sums.differenceEnergy += miss.difference * wnn;
	sums.squareEnergy += square * wnn;
	sums.missed += miss.velocity;
	sums.worst = atLeast(sums.worst, miss.difference);
	sums.mostMissed = atLeast(sums.mostMissed, miss.velocity);
	sums.stale += 4 * miss.difference >= square ? square : N {};
}

// Finds p such that u = w p + q obeys the law, with a full 2 x 2 block. Tries in this order: open, sticking, sliding either way. If
// mu |W_nt| >= W_nn or W_tt (a contact that can wedge), several cases may hold; the first one is taken. Products instead of quotients distinguish the
// cases, which leaves one division. solveLocal() in law.hpp is the same for one contact, with other round-off.
template <class N> LAW Components<N> solveLocal(const N& nn, const N& nt, const N& tn, const N& tt, const N& mu, const Components<N>& q)
{
	const N none = {}, determinant = nn * tt - nt * tn;
	const auto regular = determinant > 1e-14 * nn * tt, stiff = tt <= 1e-14 * nn;
	const N stickN = q.t * nt - q.n * tt, stickT = q.n * tn - q.t * nn;
	const auto sticks = regular & (stickN >= none) & (absolute(stickT) <= mu * stickN);
	const N wBack = nn - mu * nt, wForth = nn + mu * nt;
	const auto driven = absolute(q.t * nn - tn * q.n) > 1e-12 * absolute(q.t * nn) - 1e-10 * q.n * nn; // along t, where nothing can move
	const auto canSlide = regular | ~stiff | driven;
	const auto slidesBack = canSlide & (wBack > none) & (q.t * wBack >= (tn - mu * tt) * q.n);
	const auto slidesForth = canSlide & (wForth > none) & (q.t * wForth <= (tn + mu * tt) * q.n);
	const N ratio = slidesBack ? -mu : slidesForth ? mu : none;
	const N inverse = 1 / (sticks ? determinant : slidesBack ? wBack : slidesForth ? wForth : nn);
	const N n = (sticks ? stickN : -q.n) * inverse, t = sticks ? stickT * inverse : ratio * n;
	return { q.n < none ? n : none, q.n < none ? t : none };
}

// How much an impulse acts on the bodies of a contact, for unit masses.
template <class Contact, class Impulse> LAW auto actingOnA(const Contact& c, const Impulse& p) { return actingOn(c.at, p); }
template <class Contact, class Impulse> LAW auto actingOnB(const Contact& c, const Impulse& p) { return actingOn(c.bt, p); }

#include "problem/springs.inl"

#include "problem/law_in_space.inl"
#include "problem/law_rolling.inl"

#undef LAW
