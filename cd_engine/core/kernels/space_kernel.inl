// group_kernel.cpp includes this file after group_kernel.inl, whose vector types and loops it uses. The same rules hold here.

struct SpaceBodies {
	Vector vx, vy, vz, w, spinX, spinY, spinZ, unused;
};

#if LANES == 8

typedef double Line __attribute__((vector_size(64), aligned(64), may_alias)); // a body

// Eight bodies to eight vectors and back: the transpose is its own inverse. Half as many instructions as by halves of a body.
INLINE void transpose(Line* r)
{
	Line pairs[8];
	for (int i = 0; i < 8; i += 2) {
		pairs[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
		pairs[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
	}
	for (int odd = 0; odd < 2; odd++) {
		Line half[4]; // numbers 0 and 4 of the first four bodies, of the others; numbers 2 and 6
		for (int i = 0; i < 2; i++) {
			half[i] = __builtin_shufflevector(pairs[4 * i + odd], pairs[4 * i + 2 + odd], 0, 1, 4, 5, 8, 9, 12, 13);
			half[2 + i] = __builtin_shufflevector(pairs[4 * i + odd], pairs[4 * i + 2 + odd], 2, 3, 6, 7, 10, 11, 14, 15);
		}
		for (int i = 0; i < 2; i++) {
			r[2 * i + odd] = __builtin_shufflevector(half[2 * i], half[2 * i + 1], 0, 1, 4, 5, 8, 9, 12, 13);
			r[4 + 2 * i + odd] = __builtin_shufflevector(half[2 * i], half[2 * i + 1], 2, 3, 6, 7, 10, 11, 14, 15);
		}
	}
}

INLINE SpaceBodies gather(const cd::PackedBody<Space3>* bodies, const int32_t* i)
{
	Line r[LANES];
	for (int lane = 0; lane < LANES; lane++)
		r[lane] = *reinterpret_cast<const Line*>(bodies + i[lane]);
	transpose(r);
	return { r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7] };
}
INLINE void scatter(cd::PackedBody<Space3>* bodies, const int32_t* i, const SpaceBodies& v)
{
	Line r[LANES] = { v.vx, v.vy, v.vz, v.w, v.spinX, v.spinY, v.spinZ, v.unused };
	transpose(r);
	for (int lane = 0; lane < LANES; lane++)
		*reinterpret_cast<Line*>(bodies + i[lane]) = r[lane];
}

#else

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

#endif

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

INLINE SpatialSpring<Vector> springOf(const cd::GroupSprings<Space3>& g, int lane)
{
	return { load(g.n + lane), load(g.t + lane), load(g.x + lane), load(g.y + lane), load(g.z + lane) };
}
