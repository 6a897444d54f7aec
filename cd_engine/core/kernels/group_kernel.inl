// group_kernel.cpp includes this file once for every target, with LANES 2, 4 or 8 and the compiler set to that target. No #include here but of its
// own parts, and no calls but of their functions: the linker could take a function that other files compile, too, from here, and run it on an older
// processor.

typedef double Vector __attribute__((vector_size(8 * LANES)));
typedef double Quad __attribute__((vector_size(32), aligned(32), may_alias)); // a body

INLINE Vector load(const double* p) { return *reinterpret_cast<const Vector*>(p); }
INLINE void store(double* p, const Vector& v) { *reinterpret_cast<Vector*>(p) = v; }
INLINE Vector larger(const Vector& a, const Vector& b) { return a > b ? a : b; }
INLINE Vector smaller(const Vector& a, const Vector& b) { return a < b ? a : b; }
INLINE Vector absolute(const Vector& x) { return larger(x, -x); }

// The four numbers of a body, in an array of structures of `size` times four numbers.
template <int size> INLINE const Quad& body(const void* of, int32_t i) { return static_cast<const Quad*>(of)[size * static_cast<std::size_t>(i)]; }

struct Bodies {
	Vector vx, vy, spin, w;
};

#if LANES == 8

INLINE Vector two(const Quad& a, const Quad& b) { return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7); }

template <int size = 1> INLINE Bodies gather(const void* of, const int32_t* i)
{
	const Vector q0 = two(body<size>(of, i[0]), body<size>(of, i[2])), q1 = two(body<size>(of, i[1]), body<size>(of, i[3]));
	const Vector q2 = two(body<size>(of, i[4]), body<size>(of, i[6])), q3 = two(body<size>(of, i[5]), body<size>(of, i[7]));
	const Vector even01 = __builtin_shufflevector(q0, q1, 0, 8, 2, 10, 4, 12, 6, 14),
		     odd01 = __builtin_shufflevector(q0, q1, 1, 9, 3, 11, 5, 13, 7, 15);
	const Vector even23 = __builtin_shufflevector(q2, q3, 0, 8, 2, 10, 4, 12, 6, 14),
		     odd23 = __builtin_shufflevector(q2, q3, 1, 9, 3, 11, 5, 13, 7, 15);
	return { __builtin_shufflevector(even01, even23, 0, 1, 4, 5, 8, 9, 12, 13), __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5, 8, 9, 12, 13),
		__builtin_shufflevector(even01, even23, 2, 3, 6, 7, 10, 11, 14, 15),
		__builtin_shufflevector(odd01, odd23, 2, 3, 6, 7, 10, 11, 14, 15) };
}

// The inverse: calls put(lane, the four numbers of a body).
template <class Put> INLINE void scatter(const Bodies& v, const Put& put)
{
	const Vector evenV = __builtin_shufflevector(v.vx, v.vy, 0, 8, 2, 10, 4, 12, 6, 14),
		     oddV = __builtin_shufflevector(v.vx, v.vy, 1, 9, 3, 11, 5, 13, 7, 15);
	const Vector evenS = __builtin_shufflevector(v.spin, v.w, 0, 8, 2, 10, 4, 12, 6, 14),
		     oddS = __builtin_shufflevector(v.spin, v.w, 1, 9, 3, 11, 5, 13, 7, 15);
	const Vector b02 = __builtin_shufflevector(evenV, evenS, 0, 1, 8, 9, 2, 3, 10, 11),
		     b46 = __builtin_shufflevector(evenV, evenS, 4, 5, 12, 13, 6, 7, 14, 15);
	const Vector b13 = __builtin_shufflevector(oddV, oddS, 0, 1, 8, 9, 2, 3, 10, 11),
		     b57 = __builtin_shufflevector(oddV, oddS, 4, 5, 12, 13, 6, 7, 14, 15);
	put(0, __builtin_shufflevector(b02, b02, 0, 1, 2, 3));
	put(1, __builtin_shufflevector(b13, b13, 0, 1, 2, 3));
	put(2, __builtin_shufflevector(b02, b02, 4, 5, 6, 7));
	put(3, __builtin_shufflevector(b13, b13, 4, 5, 6, 7));
	put(4, __builtin_shufflevector(b46, b46, 0, 1, 2, 3));
	put(5, __builtin_shufflevector(b57, b57, 0, 1, 2, 3));
	put(6, __builtin_shufflevector(b46, b46, 4, 5, 6, 7));
	put(7, __builtin_shufflevector(b57, b57, 4, 5, 6, 7));
}

#elif LANES == 4

// Four bodies to four vectors and back: the transpose is its own inverse.
INLINE void transpose(Quad& r0, Quad& r1, Quad& r2, Quad& r3)
{
	const Quad even01 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6), odd01 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
	const Quad even23 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6), odd23 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
	r0 = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
	r1 = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
	r2 = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
	r3 = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
}

template <int size = 1> INLINE Bodies gather(const void* of, const int32_t* i)
{
	Quad r0 = body<size>(of, i[0]), r1 = body<size>(of, i[1]), r2 = body<size>(of, i[2]), r3 = body<size>(of, i[3]);
	transpose(r0, r1, r2, r3);
	return { r0, r1, r2, r3 };
}

template <class Put> INLINE void scatter(const Bodies& v, const Put& put)
{
	Quad r0 = v.vx, r1 = v.vy, r2 = v.spin, r3 = v.w;
	transpose(r0, r1, r2, r3);
	put(0, r0);
	put(1, r1);
	put(2, r2);
	put(3, r3);
}

#else

template <int size = 1> INLINE Bodies gather(const void* of, const int32_t* i)
{
	Bodies v;
	for (int lane = 0; lane < LANES; lane++) {
		const Quad& one = body<size>(of, i[lane]);
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

// Solves LANES contacts. The velocities of the bodies already contain the impulses pn, pt.
INLINE void solve(Group& g, int lane, PackedBody* bodies, Vector& pn, Vector& pt)
{
	Bodies A = gather(bodies, g.a + lane), B = gather(bodies, g.b + lane);
	const Vector nx = load(g.nx + lane), ny = load(g.ny + lane), at = load(g.at + lane), bt = load(g.bt + lane);
	const Vector dx = B.vx - A.vx, dy = B.vy - A.vy;
	const Vector un = nx * dx + ny * dy + load(g.bias + lane);
	const Vector ut = (nx * dy - ny * dx) + (bt * B.spin - at * A.spin);
	// n and t do not couple: first the normal law gives n, then the tangential impulse that stops sliding is cut at the friction cone.
	const Vector n = larger(pn - un * load(g.inverseWnn + lane), Vector {});
	const Vector limit = load(g.mu + lane) * n;
	const Vector t = larger(smaller(pt - ut * load(g.inverseWtt + lane), limit), -limit);
	const Vector dn = n - pn, dt = t - pt;
	pn = n;
	pt = t;
	store(g.pn + lane, n);
	store(g.pt + lane, t);
	const Vector px = nx * dn - ny * dt, py = ny * dn + nx * dt;
	A.vx -= A.w * px;
	A.vy -= A.w * py;
	A.spin -= A.w * (at * dt);
	B.vx += B.w * px;
	B.vy += B.w * py;
	B.spin += B.w * (bt * dt);
	scatter(bodies, g.a + lane, A);
	scatter(bodies, g.b + lane, B);
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

static void sweep(Group* groups, std::size_t count, PackedBody* bodies)
{
	for (std::size_t k = 0; k < count; k++) {
		fetch(groups + k + early);
		for (int lane = 0; lane < Group::lanes; lane += LANES) {
			Vector pn = load(groups[k].pn + lane), pt = load(groups[k].pt + lane);
			solve(groups[k], lane, bodies, pn, pt);
		}
	}
}

static void sweepAhead(Group* groups, GroupBefore* before, std::size_t count, PackedBody* bodies, double beta, LaneSums& sums)
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
			Group& g = groups[k];
			const int lane = half * LANES;
			const Vector n = load(g.pn + lane), t = load(g.pt + lane);
			const Vector yn = n + beta * (n - load(before[k].pn + lane)), yt = t + beta * (t - load(before[k].pt + lane));
			store(before[k].pn + lane, n);
			store(before[k].pt + lane, t);
			Vector pn = yn, pt = yt;
			solve(g, lane, bodies, pn, pt);
			const Vector dn = yn - pn, dt = yt - pt;
			change[half] += dn * dn + dt * dt;
			against[half] += dn * (pn - n) + dt * (pt - t);
		}
	}
	for (int half = 0; half < Group::lanes / LANES; half++) {
		store(sums.change + half * LANES, change[half]);
		store(sums.against + half * LANES, against[half]);
	}
}

static void extrapolate(PackedBody* bodies, PackedBody* before, std::size_t count, double beta)
{
	// The inverse masses are extrapolated, too, but do not change: w + beta (w - w) = w.
	for (std::size_t i = 0; i < count; i++) {
		Quad &v = reinterpret_cast<Quad&>(bodies[i]), &last = reinterpret_cast<Quad&>(before[i]);
		const Quad now = v;
		v = now + beta * (now - last);
		last = now;
	}
}

static void press(const Group* groups, std::size_t count, PackedBody* loads)
{
	for (std::size_t k = 0; k < count; k++) {
		fetch(groups + k + early);
		const Group& g = groups[k];
		for (int lane = 0; lane < Group::lanes; lane += LANES) {
			Bodies A = gather(loads, g.a + lane), B = gather(loads, g.b + lane);
			const Vector nx = load(g.nx + lane), ny = load(g.ny + lane), at = load(g.at + lane), bt = load(g.bt + lane);
			const Vector pn = load(g.pn + lane), pt = load(g.pt + lane);
			const Vector px = nx * pn - ny * pt, py = ny * pn + nx * pt, t = absolute(pt), both = absolute(pn) + t;
			A.vx -= px;
			A.vy -= py;
			A.spin -= at * pt;
			A.w += both + at * at * t;
			B.vx += px;
			B.vy += py;
			B.spin += bt * pt;
			B.w += both + bt * bt * t;
			scatter(loads, g.a + lane, A);
			scatter(loads, g.b + lane, B);
		}
	}
}

// What residual.cpp adds for one contact, here for LANES contacts. `each` may be null.
static void miss(const Group* groups, std::size_t count, const PackedBody* moved, LaneMisses& sums, GroupMiss* each)
{
	constexpr double epsilon = 2.220446049250313e-16, roundOff = 4 * epsilon;
	const Vector none = {};
	for (std::size_t k = 0; k < count; k++) {
		fetch(groups + k + early);
		const Group& g = groups[k];
		for (int lane = 0; lane < Group::lanes; lane += LANES) {
			const Bodies A = gather(moved, g.a + lane), B = gather(moved, g.b + lane);
			const Vector nx = load(g.nx + lane), ny = load(g.ny + lane), at = load(g.at + lane), bt = load(g.bt + lane);
			const Vector pn = load(g.pn + lane), pt = load(g.pt + lane), mu = load(g.mu + lane), bias = load(g.bias + lane);
			const Vector inverse = load(g.inverseWnn + lane), wnn = inverse > none ? 1 / inverse : none;
			const Vector ux = B.vx - A.vx, uy = B.vy - A.vy, aTurns = at * A.spin, bTurns = bt * B.spin;
			const Vector un = ux * nx + uy * ny + bias, ut = uy * nx - ux * ny + (bTurns - aTurns);
			const Vector qn = pn - (un + mu * absolute(ut)) * inverse, qt = pt - ut * inverse, length = absolute(qt);
			const auto inside = (qn >= none) & (length <= mu * qn), behind = mu * length <= -qn;
			const Vector along = (qn + mu * length) / (1 + mu * mu), across = mu * along;
			const Vector n = inside ? qn : behind ? none : along, t = inside ? qt : behind ? none : qt < none ? -across : across;
			const Vector dn = pn - n, dt = pt - t, square = dn * dn + dt * dt, own = pn * pn + pt * pt;
			const Vector ofVelocities = roundOff
			    * (absolute(A.vx) + absolute(A.vy) + absolute(B.vx) + absolute(B.vy) + absolute(bias) + absolute(aTurns)
				+ absolute(bTurns));
			const Vector acts = A.w + B.w, least = epsilon * acts;
			const Vector known = ofVelocities * inverse, knownOfSums = (ofVelocities + roundOff * acts) * inverse;
			const Vector difference = square <= knownOfSums * knownOfSums ? none : square;
			const Vector velocity = larger(square <= known * known ? none : square * wnn * wnn, least * least);
			const auto add = [lane](double* sum, const Vector& x) { store(sum + lane, load(sum + lane) + x); };
			const auto raise = [lane](double* most, const Vector& x) { store(most + lane, larger(x, load(most + lane))); };
			add(sums.difference, difference);
			add(sums.square, own);
			add(sums.differenceEnergy, difference * wnn);
			add(sums.squareEnergy, own * wnn);
			add(sums.velocity, velocity);
			raise(sums.worst, difference);
			raise(sums.mostVelocity, velocity);
			if (each) {
				store(each[k].difference + lane, difference);
				store(each[k].velocity + lane, velocity);
				store(each[k].wnn + lane, wnn);
			}
		}
	}
}

#include "kernels/row_kernel.inl"
#include "kernels/pair_kernel.inl"
