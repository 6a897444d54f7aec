// law.inl includes this file: its formulas for contacts in the plane that resist rolling. Such a contact has a third impulse p_r = m/L, with m the
// moment on b [N m s] and L a length of the contact [m], so that all three have one unit. It works on u_r = L (omega_b - omega_a), and the law adds
//   |p_r| <= eta p_n,   p_r = -eta p_n u_r/|u_r| where the contact rolls
// so that eta L p_n bounds the moment.

// Of an impulse or a relative velocity: along n and t, and of rolling.
template <class N> struct RollingComponents {
	N n, t, r;
};
template <class N> LAW RollingComponents<N> operator-(const RollingComponents<N>& a, const RollingComponents<N>& b)
{
	return { a.n - b.n, a.t - b.t, a.r - b.r };
}
template <class N> LAW N dot(const RollingComponents<N>& a, const RollingComponents<N>& b) { return a.n * b.n + a.t * b.t + a.r * b.r; }
template <class N> LAW RollingComponents<N> extrapolated(const RollingComponents<N>& p, const RollingComponents<N>& before, double beta)
{
	return { p.n + beta * (p.n - before.n), p.t + beta * (p.t - before.t), p.r + beta * (p.r - before.r) };
}
template <class N> LAW Components<N> withoutMoment(const RollingComponents<N>& p) { return { p.n, p.t }; }

// Of a contact with stiffness: the compliances, and the biases of its slip and its rolling.
template <class N> struct RollingSpring {
	N n, t, bias, r, rollBias;
};
template <class N> LAW RollingComponents<N> yielding(const RollingComponents<N>& u, const RollingSpring<N>& by, const RollingComponents<N>& p)
{
	return { u.n + by.n * p.n, u.t + (by.bias + by.t * p.t), u.r + (by.rollBias + by.r * p.r) };
}
template <class N> LAW N sizeOf(const RollingSpring<N>& of, const RollingComponents<N>& p)
{
	return absolute(of.n * p.n) + absolute(of.bias) + absolute(of.t * p.t) + absolute(of.rollBias) + absolute(of.r * p.r);
}

// ar, br: L, or 0 where the body does not turn. ContactRow<RollingPlane> has the same members.
template <class N> struct RollingContact : CentralContact<N> {
	N ar, br;
};
template <class N> struct RollingFriction {
	N mu, eta;
};

template <class N, class Contact> LAW N rolling(const Contact& c, const Motion<N>& a, const Motion<N>& b) { return c.br * b.spin - c.ar * a.spin; }
template <bool spinsFirst, class N> LAW RollingComponents<N> relativeVelocity(const RollingContact<N>& c, const Motion<N>& a, const Motion<N>& b)
{
	const Components<N> u = relativeVelocity<spinsFirst>(static_cast<const CentralContact<N>&>(c), a, b);
	return { u.n, u.t, rolling<N>(c, a, b) };
}
template <class N> LAW N sizeOf(const RollingContact<N>& c, const N& bias, const Motion<N>& a, const Motion<N>& b)
{
	return sizeOf<N>(static_cast<const CentralContact<N>&>(c), bias, a, b) + absolute(c.ar * a.spin) + absolute(c.br * b.spin);
}

template <class N, class Contact> LAW Action<N> actionOf(const Contact& c, const RollingComponents<N>& p)
{
	const Action<N> planar = actionOf(c, withoutMoment(p));
	return { planar.x, planar.y, planar.turnA + c.ar * p.r, planar.turnB + c.br * p.r };
}

template <class N> LAW N actingOnA(const RollingContact<N>& c, const RollingComponents<N>& p)
{
	return actingOn(c.at, withoutMoment(p)) + c.ar * c.ar * absolute(p.r);
}
template <class N> LAW N actingOnB(const RollingContact<N>& c, const RollingComponents<N>& p)
{
	return actingOn(c.bt, withoutMoment(p)) + c.br * c.br * absolute(p.r);
}

template <class N> LAW N within(const N& limit, const N& x) { return larger(smaller(x, limit), -limit); }

// The nearest point of the cone |p_t| <= mu p_n, |p_r| <= eta p_n. Its p_n is the root of a sum of increasing functions of which each is the smaller
// one of two straight lines, so it is the largest of the roots of the lines' four sums.
template <class N> LAW RollingComponents<N> projected(const RollingComponents<N>& q, const RollingFriction<N>& by)
{
	const N t = by.mu * absolute(q.t), r = by.eta * absolute(q.r), tt = by.mu * by.mu, rr = by.eta * by.eta;
	const N either = larger<N>((q.n + t) / (1 + tt), (q.n + r) / (1 + rr)), both = (q.n + t + r) / (1 + tt + rr);
	const N n = larger(larger(q.n, N {}), larger(either, both));
	return { n, within<N>(by.mu * n, q.t), within<N>(by.eta * n, q.r) };
}

// |p - P_K(p - (u + (mu |u_t| + eta |u_r|) n)/W_nn)|^2
template <class N, class W>
LAW N squaredMiss(const RollingComponents<N>& p, const RollingComponents<N>& u, const RollingFriction<N>& by, const W& wnn)
{
	const N along = u.n + by.mu * absolute(u.t) + by.eta * absolute(u.r);
	const RollingComponents<N> q = projected<N>({ p.n - over<N>(along, wnn), p.t - over<N>(u.t, wnn), p.r - over<N>(u.r, wnn) }, by);
	return dot(p - q, p - q);
}

// Of a contact that does not couple n with t and r: one over W_nn, W_tt, W_rr (0: nothing rolls) and W_tt - W_tr^2/W_rr; W_tr and W_tr/W_rr.
template <class N> struct RollingBlock {
	N nn, tt, rr, reduced, tr, ratio;
};

// The impulses of such a contact while all others are held; u: of the impulses p. p_n comes first. Then p_t and p_r solve a convex problem on a
// rectangle. Let p_r be free: its best value is linear in p_t, what is left of the problem depends on p_t alone, and its minimum on an interval is
// the cut one, t. Now the minimum over p_t for each given p_r is convex in p_r, and has its minimum at the p_r that belongs to t. So the best p_r of
// the rectangle is that one, cut, and p_t the best one beside it, cut.
template <class N>
LAW RollingComponents<N> solveRolling(
    const RollingBlock<N>& inverse, const RollingFriction<N>& by, const RollingComponents<N>& p, const RollingComponents<N>& u)
{
	const N n = larger(p.n - u.n * inverse.nn, N {}), most = by.mu * n;
	const N t = within<N>(most, p.t - (u.t - inverse.ratio * u.r) * inverse.reduced);
	const N r = within<N>(by.eta * n, p.r - (u.r + inverse.tr * (t - p.t)) * inverse.rr);
	return { n, within<N>(most, p.t - (u.t + inverse.tr * (r - p.r)) * inverse.tt), r };
}
