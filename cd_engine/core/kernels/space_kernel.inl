// group_kernel.cpp includes this file after group_kernel.inl, whose vector types and loops it uses. The same rules hold here.

struct SpaceBodies {
	Vector vx, vy, vz, w, spinX, spinY, spinZ, unused;
};

INLINE SpaceBodies gather(const cd::PackedBody<Space3>* bodies, const int32_t* i)
{
	const Bodies v = gather<2>(bodies, i), spin = gather<2>(&bodies->spinX, i);
	return { v.vx, v.vy, v.spin, v.w, spin.vx, spin.vy, spin.spin, spin.w };
}
INLINE void scatter(cd::PackedBody<Space3>* bodies, const int32_t* i, const SpaceBodies& v)
{
	scatter(Bodies { v.vx, v.vy, v.vz, v.w }, [&](int lane, const Quad& q) { *reinterpret_cast<Quad*>(bodies + i[lane]) = q; });
	scatter(
	    Bodies { v.spinX, v.spinY, v.spinZ, v.unused }, [&](int lane, const Quad& q) { *reinterpret_cast<Quad*>(&bodies[i[lane]].spinX) = q; });
}

INLINE SpatialContact<Vector> contactOf(const cd::Group<Space3>& g, int lane)
{
	return { load(g.nx + lane), load(g.ny + lane), load(g.nz + lane), load(g.at + lane), load(g.bt + lane) };
}
INLINE SpatialMotion<Vector> motionOf(const SpaceBodies& v) { return { v.vx, v.vy, v.vz, v.spinX, v.spinY, v.spinZ }; }
template <class W> INLINE void push(const SpatialAction<Vector>& of, SpaceBodies& a, const W& wa, SpaceBodies& b, const W& wb)
{
	push(of, SpatialMotion<Vector&> { a.vx, a.vy, a.vz, a.spinX, a.spinY, a.spinZ }, SpatialMotion<const W&> { wa, wa, wa, wa, wa, wa },
	    SpatialMotion<Vector&> { b.vx, b.vy, b.vz, b.spinX, b.spinY, b.spinZ }, SpatialMotion<const W&> { wb, wb, wb, wb, wb, wb });
}

INLINE SpatialComponents<Vector> spatialImpulses(const double* n, const double* x, const double* y, const double* z)
{
	return { load(n), load(x), load(y), load(z) };
}
INLINE SpatialComponents<Vector> impulsesOf(const cd::Group<Space3>& g, int lane)
{
	return spatialImpulses(g.pn + lane, g.px + lane, g.py + lane, g.pz + lane);
}
INLINE SpatialComponents<Vector> impulsesOf(const cd::GroupBefore<Space3>& g, int lane)
{
	return spatialImpulses(g.pn + lane, g.px + lane, g.py + lane, g.pz + lane);
}
template <class T> INLINE void setImpulses(T& g, int lane, const SpatialComponents<Vector>& p)
{
	store(g.pn + lane, p.n);
	store(g.px + lane, p.x);
	store(g.py + lane, p.y);
	store(g.pz + lane, p.z);
}

INLINE SpatialComponents<Vector> withoutVelocity(
    const cd::Group<Space3>& g, int lane, const SpatialComponents<Vector>& p, const SpatialComponents<Vector>& u)
{
	const Vector across = load(g.inverseWtt + lane);
	return { p.n - (u.n + load(g.bias + lane)) * load(g.inverseWnn + lane), p.x - u.x * across, p.y - u.y * across, p.z - u.z * across };
}
