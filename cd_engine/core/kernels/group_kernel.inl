// group_kernel.cpp includes this file once for every target, with LANES 2, 4 or 8 and the compiler set to that target. No #include here but of its
// own parts, and no calls but of their functions: the linker could take a function that other files compile, too, from here, and run it on an older
// processor.

#include "problem/law.inl"

using PackedBody = cd::PackedBody<Plane>;
using Group = cd::Group<Plane>;
using GroupBefore = cd::GroupBefore<Plane>;
using GroupSprings = cd::GroupSprings<Plane>;
using BodyVelocity = cd::BodyVelocity<Plane>;
using ContactRow = cd::ContactRow<Plane>;

typedef double Vector __attribute__((vector_size(8 * LANES)));
typedef double Quad __attribute__((vector_size(32), aligned(32), may_alias)); // a body

INLINE Vector load(const double* p) { return *reinterpret_cast<const Vector*>(p); }
INLINE void store(double* p, const Vector& v) { *reinterpret_cast<Vector*>(p) = v; }

// The four numbers of a body, in an array of structures of `size` times four numbers.
template <int size> INLINE const Quad& body(const void* of, int32_t i) { return static_cast<const Quad*>(of)[size * static_cast<std::size_t>(i)]; }

struct Bodies {
	Vector vx, vy, spin, w;
};

#if LANES > 2

// Four bodies to four vectors and back: the transpose is its own inverse.
INLINE void transpose(Quad* r)
{
	const Quad even01 = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), odd01 = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
	const Quad even23 = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6), odd23 = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
	r[0] = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
	r[1] = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
	r[2] = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
	r[3] = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
}

// A vector of one quad or two, the second four quads later.
INLINE Vector joined(const Quad* q)
{
#if LANES == 8
	return __builtin_shufflevector(q[0], q[4], 0, 1, 2, 3, 4, 5, 6, 7);
#else
	return *q;
#endif
}
INLINE void split(const Vector& v, Quad* q)
{
	q[0] = __builtin_shufflevector(v, v, 0, 1, 2, 3);
#if LANES == 8
	q[4] = __builtin_shufflevector(v, v, 4, 5, 6, 7);
#endif
}

// quad(i): the four numbers of a body.
template <class Get> INLINE Bodies gatherBy(const Get& quad, const int32_t* i)
{
	Quad r[LANES];
	for (int lane = 0; lane < LANES; lane++)
		r[lane] = quad(i[lane]);
	for (int lane = 0; lane < LANES; lane += 4)
		transpose(r + lane);
	return { joined(r), joined(r + 1), joined(r + 2), joined(r + 3) };
}

// The inverse: calls put(lane, the four numbers of a body).
template <class Put> INLINE void scatter(const Bodies& v, const Put& put)
{
	Quad r[LANES];
	split(v.vx, r);
	split(v.vy, r + 1);
	split(v.spin, r + 2);
	split(v.w, r + 3);
	for (int lane = 0; lane < LANES; lane += 4)
		transpose(r + lane);
	for (int lane = 0; lane < LANES; lane++)
		put(lane, r[lane]);
}

#else

template <class Get> INLINE Bodies gatherBy(const Get& quad, const int32_t* i)
{
	Bodies v;
	for (int lane = 0; lane < LANES; lane++) {
		const Quad one = quad(i[lane]);
		v.vx[lane] = one[0];
		v.vy[lane] = one[1];
		v.spin[lane] = one[2];
		v.w[lane] = one[3];
	}
	return v;
}

template <class Put> INLINE void scatter(const Bodies& v, const Put& put)
{
	for (int lane = 0; lane < LANES; lane++)
		put(lane, Quad { v.vx[lane], v.vy[lane], v.spin[lane], v.w[lane] });
}

#endif

INLINE void scatter(PackedBody* bodies, const int32_t* i, const Bodies& v)
{
	scatter(v, [&](int lane, const Quad& q) { *reinterpret_cast<Quad*>(bodies + i[lane]) = q; });
}

template <int size = 1> INLINE Bodies gather(const void* of, const int32_t* i)
{
	return gatherBy([of](int32_t k) -> const Quad& { return body<size>(of, k); }, i);
}
INLINE Bodies gather(const PackedBody* bodies, const int32_t* i) { return gather<1>(bodies, i); }

INLINE CentralContact<Vector> contactOf(const Group& g, int lane)
{
	return { load(g.nx + lane), load(g.ny + lane), load(g.at + lane), load(g.bt + lane) };
}
template <class T> INLINE Friction<Vector> frictionOf(const T& g, int lane) { return { load(g.mu + lane) }; }
INLINE Motion<Vector> motionOf(const Bodies& v) { return { v.vx, v.vy, v.spin }; }
template <class W> INLINE void push(const Action<Vector>& of, Bodies& a, const W& wa, Bodies& b, const W& wb)
{
	push(of, Motion<Vector&> { a.vx, a.vy, a.spin }, Motion<const W&> { wa, wa, wa }, Motion<Vector&> { b.vx, b.vy, b.spin },
	    Motion<const W&> { wb, wb, wb });
}

INLINE Components<Vector> impulsesOf(const Group& g, int lane) { return { load(g.pn + lane), load(g.pt + lane) }; }
INLINE Components<Vector> impulsesOf(const GroupBefore& g, int lane) { return { load(g.pn + lane), load(g.pt + lane) }; }
template <class T> INLINE void setImpulses(T& g, int lane, const Components<Vector>& p)
{
	store(g.pn + lane, p.n);
	store(g.pt + lane, p.t);
}

// The impulses that would leave no velocity.
INLINE Components<Vector> withoutVelocity(const Group& g, int lane, const Components<Vector>& p, const Components<Vector>& u)
{
	return { p.n - (u.n + load(g.bias + lane)) * load(g.inverseWnn + lane), p.t - u.t * load(g.inverseWtt + lane) };
}

INLINE Spring<Vector> springOf(const GroupSprings& g, int lane) { return { load(g.n + lane), load(g.t + lane), load(g.bias + lane) }; }

#include "kernels/space_kernel.inl"

// Solves LANES contacts. The velocities of the bodies already contain the impulses p. Returns the new ones.
template <bool compliant, class Space, class Impulse>
INLINE Impulse solve(cd::Group<Space>& g, const cd::GroupSprings<Space>* springs, int lane, cd::PackedBody<Space>* bodies, const Impulse& p)
{
	auto A = gather(bodies, g.a + lane), B = gather(bodies, g.b + lane);
	const auto c = contactOf(g, lane);
	Impulse u = relativeVelocity<true>(c, motionOf(A), motionOf(B));
	if constexpr (compliant)
		u = yielding(u, springOf(*springs, lane), p);
	const Impulse next = cut<Vector>(withoutVelocity(g, lane, p, u), frictionOf(g, lane));
	setImpulses(g, lane, next);
	push(actionOf(c, next - p), A, A.w, B, B.w);
	scatter(bodies, g.a + lane, A);
	scatter(bodies, g.b + lane, B);
	return next;
}

// Prefetches the item that is read `early` groups later. The processor itself prefetches a stream only to the end of its page. With contacts that fit
// no cache a sweep takes about half the time. In cache nothing changes. Beyond the end of the array comes the next block. Prefetching an address that
// does not exist is allowed.
constexpr std::size_t early = 12; // groups; 4 to 24 work equally well

template <class T> INLINE void fetch(const T* item)
{
	for (std::size_t line = 0; line < sizeof(T); line += 64)
		__builtin_prefetch(reinterpret_cast<const char*>(item) + line);
}

template <bool compliant, class Space>
INLINE void sweepGroups(cd::Group<Space>* groups, const cd::GroupSprings<Space>* springs, std::size_t count, cd::PackedBody<Space>* bodies)
{
	for (std::size_t k = 0; k < count; k++) {
		fetch(groups + k + early);
		for (int lane = 0; lane < Group::lanes; lane += LANES)
			solve<compliant>(groups[k], springs + (compliant ? k : 0), lane, bodies, impulsesOf(groups[k], lane));
	}
}

template <class Space>
static void sweep(cd::Group<Space>* groups, const cd::GroupSprings<Space>* springs, std::size_t count, cd::PackedBody<Space>* bodies)
{
	if (springs)
		sweepGroups<true>(groups, springs, count, bodies);
	else
		sweepGroups<false>(groups, springs, count, bodies);
}

template <bool compliant, class Space>
INLINE void sweepGroupsAhead(cd::Group<Space>* groups, const cd::GroupSprings<Space>* springs, cd::GroupBefore<Space>* before, std::size_t count,
    cd::PackedBody<Space>* bodies, double beta, LaneSums& sums)
{
	Vector change[Group::lanes / LANES], against[Group::lanes / LANES];
	for (int half = 0; half < Group::lanes / LANES; half++) {
		change[half] = load(sums.change + half * LANES);
		against[half] = load(sums.against + half * LANES);
	}
	for (std::size_t k = 0; k < count; k++) {
		fetch(groups + k + early);
		fetch(before + k + early);
		for (int half = 0; half < Group::lanes / LANES; half++) {
			const int lane = half * LANES;
			const auto p = impulsesOf(groups[k], lane), y = extrapolated(p, impulsesOf(before[k], lane), beta);
			setImpulses(before[k], lane, p);
			const auto next = solve<compliant>(groups[k], springs + (compliant ? k : 0), lane, bodies, y);
			change[half] += dot(y - next, y - next);
			against[half] += dot(y - next, next - p);
		}
	}
	for (int half = 0; half < Group::lanes / LANES; half++) {
		store(sums.change + half * LANES, change[half]);
		store(sums.against + half * LANES, against[half]);
	}
}

template <class Space>
static void sweepAhead(cd::Group<Space>* groups, const cd::GroupSprings<Space>* springs, cd::GroupBefore<Space>* before, std::size_t count,
    cd::PackedBody<Space>* bodies, double beta, LaneSums& sums)
{
	if (springs)
		sweepGroupsAhead<true>(groups, springs, before, count, bodies, beta, sums);
	else
		sweepGroupsAhead<false>(groups, springs, before, count, bodies, beta, sums);
}

template <class Space> static void extrapolate(cd::PackedBody<Space>* bodies, cd::PackedBody<Space>* before, std::size_t count, double beta)
{
	// The inverse masses are extrapolated, too, but do not change: w + beta (w - w) = w.
	Quad *const of = reinterpret_cast<Quad*>(bodies), *const were = reinterpret_cast<Quad*>(before);
	for (std::size_t i = 0; i < count * (sizeof *bodies / sizeof(Quad)); i++) {
		Quad &v = of[i], &last = were[i];
		const Quad now = v;
		v = now + beta * (now - last);
		last = now;
	}
}

template <class Space> static void addImpulses(const cd::Group<Space>* groups, std::size_t count, cd::PackedBody<Space>* loads)
{
	for (std::size_t k = 0; k < count; k++) {
		fetch(groups + k + early);
		const auto& g = groups[k];
		for (int lane = 0; lane < Group::lanes; lane += LANES) {
			auto A = gather(loads, g.a + lane), B = gather(loads, g.b + lane);
			const auto c = contactOf(g, lane);
			const auto p = impulsesOf(g, lane);
			push(actionOf(c, p), A, UnitMass {}, B, UnitMass {});
			A.w += actingOn(c.at, p);
			B.w += actingOn(c.bt, p);
			scatter(loads, g.a + lane, A);
			scatter(loads, g.b + lane, B);
		}
	}
}

template <bool compliant, class Space>
INLINE void missOfGroups(const cd::Group<Space>* groups, const cd::GroupSprings<Space>* springs, std::size_t count,
    const cd::PackedBody<Space>* moved, LaneMisses& sums, GroupMiss* each)
{
	for (std::size_t k = 0; k < count; k++) {
		fetch(groups + k + early);
		const auto& g = groups[k];
		for (int lane = 0; lane < Group::lanes; lane += LANES) {
			const auto A = gather(moved, g.a + lane), B = gather(moved, g.b + lane);
			const auto c = contactOf(g, lane);
			const auto p = impulsesOf(g, lane);
			const Vector bias = load(g.bias + lane), inverse = load(g.inverseWnn + lane), none = {};
			const Compliance<Vector> wnn = { inverse > none ? 1 / inverse : none, inverse };
			auto u = relativeVelocity<true>(c, motionOf(A), motionOf(B));
			u.n += bias;
			Vector size = sizeOf(c, bias, motionOf(A), motionOf(B));
			if constexpr (compliant) {
				const auto spring = springOf(springs[k], lane);
				u = yielding(u, spring, p);
				size += sizeOf(spring, p);
			}
			const Miss<Vector> miss = missOf<Vector>(squaredMiss(p, u, frictionOf(g, lane), wnn), wnn, size, A.w + B.w);
			const auto of = [lane](double* sum) -> Vector& { return *reinterpret_cast<Vector*>(sum + lane); };
			struct {
				Vector &difference, &square, &differenceEnergy, &squareEnergy, &missed, &worst, &mostMissed, &stale;
			} here { of(sums.difference), of(sums.square), of(sums.differenceEnergy), of(sums.squareEnergy), of(sums.missed),
				of(sums.worst), of(sums.mostMissed), of(sums.stale) };
			addTo<decltype(here), Vector>(here, miss, dot(p, p), wnn.value);
			if (each) {
				store(each[k].difference + lane, miss.difference);
				store(each[k].velocity + lane, miss.velocity);
			}
		}
	}
}

template <class Space>
static void miss(const cd::Group<Space>* groups, const cd::GroupSprings<Space>* springs, std::size_t count, const cd::PackedBody<Space>* moved,
    LaneMisses& sums, GroupMiss* each)
{
	if (springs)
		missOfGroups<true>(groups, springs, count, moved, sums, each);
	else
		missOfGroups<false>(groups, springs, count, moved, sums, each);
}

#include "kernels/row_kernel.inl"
#include "kernels/pair_kernel.inl"
