// group_kernel.cpp includes this file after group_kernel.inl, whose vector types and loops it uses. The same rules hold here.

INLINE RollingContact<Vector> contactOf(const cd::Group<RollingPlane>& g, int lane)
{
	return { contactOf(static_cast<const Group&>(g), lane), load(g.ar + lane), load(g.br + lane) };
}
INLINE RollingFriction<Vector> frictionOf(const cd::Group<RollingPlane>& g, int lane) { return { load(g.mu + lane), load(g.eta + lane) }; }
INLINE RollingSpring<Vector> springOf(const cd::GroupSprings<RollingPlane>& g, int lane)
{
	return { load(g.n + lane), load(g.t + lane), load(g.bias + lane), load(g.r + lane), load(g.rollBias + lane) };
}

INLINE RollingComponents<Vector> impulsesOf(const cd::Group<RollingPlane>& g, int lane)
{
	return { load(g.pn + lane), load(g.pt + lane), load(g.pr + lane) };
}
INLINE RollingComponents<Vector> impulsesOf(const cd::GroupBefore<RollingPlane>& g, int lane)
{
	return { load(g.pn + lane), load(g.pt + lane), load(g.pr + lane) };
}
template <class T> INLINE void setImpulses(T& g, int lane, const RollingComponents<Vector>& p)
{
	setImpulses(g, lane, withoutMoment(p));
	store(g.pr + lane, p.r);
}

INLINE RollingComponents<Vector> solution(
    const cd::Group<RollingPlane>& g, int lane, const RollingComponents<Vector>& p, const RollingComponents<Vector>& u)
{
	const RollingBlock<Vector> inverse { load(g.inverseWnn + lane), load(g.inverseWtt + lane), load(g.inverseWrr + lane),
		load(g.inverseReduced + lane), load(g.wtr + lane), load(g.ratio + lane) };
	const Vector un = u.n + load(g.bias + lane);
	return solveRolling<Vector>(inverse, frictionOf(g, lane), p, { un, u.t, u.r });
}
