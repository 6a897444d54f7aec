// group_kernel.cpp includes this file after group_kernel.inl, whose vector types it uses. The same rules hold here.

INLINE Vector root(const Vector& x)
{
	Vector r;
	for (int i = 0; i < LANES; i++)
		r[i] = __builtin_sqrt(x[i]);
	return r;
}

// locateContact() for LANES pairs of disks, which has the formulas.
struct Disks {
	Vector nx, ny, overlap, radiusA, radiusB;
};
INLINE Disks locateDisks(const Place* places, const PairLanes& p, int lane)
{
	const Bodies A = gather(places, p.a + lane), B = gather(places, p.b + lane); // x, y, rotation, radius
	const Vector dx = B.vx - A.vx, dy = B.vy - A.vy, centres = root(dx * dx + dy * dy), inverse = 1 / centres;
	return { dx * inverse, dy * inverse, -((centres - A.w) - B.w), A.w, B.w };
}

static void overlaps(const Place* places, PairLanes* pairs, std::size_t count, double nearby)
{
	const Vector none = {}, never = none + __builtin_inf();
	for (std::size_t i = 0; i < count * PairLanes::lanes; i += LANES) {
		PairLanes& p = pairs[i / PairLanes::lanes];
		const int lane = i % PairLanes::lanes;
		const Disks d = locateDisks(places, p, lane);
		const Vector reference = load(p.reference + lane);
		const auto apart = (reference > none) & (d.overlap <= none);
		const Vector gap = apart ? -d.overlap : reference - d.overlap;
		store(p.overlap + lane, d.overlap);
		store(p.gap + lane, gap);
		store(p.beyond + lane, d.radiusA > none ? gap - nearby * smaller(d.radiusA, d.radiusB) : never);
	}
}

typedef double RowPart __attribute__((vector_size(32), aligned(8), may_alias));

// Rows of LANES contacts between two disks; wnn = 0 where one of them cannot turn or can hardly move, or `a` is no disk.
struct Rows {
	Vector nx, ny, at, bt, bias, mu, wnn, wnt, wtt, pn, pt;
	Springs<Vector> springs; // of contacts with stiffness
	Spring<Vector> yields; // the same in the law; 0: rigid
};

// ProblemBuilder::soften(). gap, held: as in Springs.
INLINE void soften(Rows& r, const PairLanes& p, int lane, const Vector& gap, const Vector& held, const RowSettings& settings)
{
	const Vector none = {};
	r.springs = { load(p.kn + lane), load(p.kt + lane), none, gap, held };
	if (settings.dampingRatio > 0)
		r.springs.dashpot = 2 * settings.dampingRatio * root(r.springs.kn / r.wnn);
	r.yields = yieldOf(r.springs, settings.dt);
	r.bias = biasOf(r.springs, settings.dt);
	// Loaded as four numbers, of which the last one is not used.
	const auto before = [&settings](int32_t i) { return Quad(*reinterpret_cast<const RowPart*>(settings.before[i].v)); };
	const Bodies A = gatherBy(before, p.a + lane), B = gatherBy(before, p.b + lane);
	const CentralContact<Vector> c = { r.nx, r.ny, r.at, r.bt };
	const Components<Vector> u = relativeVelocity<false>(c, motionOf(A), motionOf(B));
	const Components<Vector> guess = movedOn<Vector>({ r.pn, r.pt }, u, r.springs.kn, r.yields.t, settings.dt);
	r.mu = r.springs.kt > none ? r.mu : none;
	r.pn = guess.n;
	r.pt = r.mu > none ? cutGuess<Vector>(guess, r.mu, settings.coneFactor) : none;
}

// ContactRow::assembleBlock for arms an = bn = 0, and ProblemBuilder::guess().
template <bool compliant>
INLINE Rows rowsOf(const Place* places, const BodyVelocity* bodies, const Carried* carried, const PairLanes& p, int lane, const RowSettings& settings)
{
	const Vector none = {};
	const Disks d = locateDisks(places, p, lane);
	const Bodies A = gather<2>(bodies->w, p.a + lane), B = gather<2>(bodies->w, p.b + lane); // the inverse masses
	const Bodies was = gather<2>(&carried->nx, p.index + lane), tangent = gather<2>(carried->ft, p.index + lane);
	const Vector nx = d.nx, ny = d.ny, at = d.radiusA - 0.5 * d.overlap, bt = -(d.radiusB - 0.5 * d.overlap), mu = load(p.mu + lane);
	const Vector gap = load(p.reference + lane) - d.overlap, radius = smaller(d.radiusA, d.radiusB),
		     pushed = gap < settings.pushedOut * radius ? settings.gapCorrection * (gap + settings.allowedOverlap * radius) : none;
	const Vector wx = A.vx + B.vx, wy = A.vy + B.vy;
	const Vector wnn = nx * nx * wx + ny * ny * wy, wtt = ny * ny * wx + nx * nx * wy + at * at * A.spin + bt * bt * B.spin;
	const Vector wnt = nx * ny * (wy - wx) + none * at * A.spin + none * bt * B.spin;
	const Vector freedom = A.vx + A.vy + B.vx + B.vy + at * at * A.spin + bt * bt * B.spin;
	const auto known
	    = (d.radiusA > none) & (A.spin > none) & (B.spin > none) & (A.vx == A.vy) & (B.vx == B.vy) & (wnn > ContactRow::leastShare * freedom);
	const Vector square = was.vx * was.vx + was.vy * was.vy, normal = was.vx * was.spin + was.vy * was.w;
	const Vector tangential = was.vx * tangent.vy - was.vy * tangent.vx;
	const auto carries = (normal > none) & (tangential * none == none);
	const Vector pn = carries ? settings.dt * normal / square : none, pt = carries ? settings.dt * tangential / square : none;
	Rows r = { nx, ny, at, bt, ((gap > none ? gap : pushed) + none) / settings.dt, mu, known ? wnn : none, wnt, wtt, pn,
		cutGuess<Vector>({ pn, pt }, mu, settings.coneFactor), {}, {} };
	if constexpr (compliant)
		soften(r, p, lane, gap, pt, settings);
	return r;
}

template <bool compliant>
INLINE void assembleRows(const Place* places, const BodyVelocity* bodies, const Carried* carried, const PairLanes* pairs, ContactRow* rows,
    std::size_t count, const RowSettings& settings)
{
	const Vector none = {};
	for (std::size_t i = 0; i < count; i += LANES) {
		const PairLanes& p = pairs[i / PairLanes::lanes];
		const int lane = i % PairLanes::lanes;
		const Rows r = rowsOf<compliant>(places, bodies, carried, p, lane, settings);
		char* const row = reinterpret_cast<char*>(rows + i);
		const int here = count - i < LANES ? static_cast<int>(count - i) : LANES;
		const auto to = [&](std::size_t member) {
			return [=](int l, const Quad& q) {
				if (l < here)
					*reinterpret_cast<RowPart*>(row + l * sizeof(ContactRow) + member) = q;
			};
		};
		scatter({ load(reinterpret_cast<const double*>(p.ends + lane)), r.nx, r.ny, none }, to(0));
		scatter({ r.at, none, r.bt, r.bias }, to(offsetof(ContactRow, at)));
		scatter({ r.mu, r.wnn, r.wnt, r.wtt }, to(offsetof(ContactRow, mu)));
		scatter({ r.pn, r.pt, r.yields.n, r.yields.t }, to(offsetof(ContactRow, pn)));
		alignas(sizeof(Vector)) double slipBias[LANES];
		store(slipBias, r.yields.bias);
		for (int l = 0; l < here; l++)
			rows[i + l].slipBias = slipBias[l];
	}
}
static void assemble(const Place* places, const BodyVelocity* bodies, const Carried* carried, const PairLanes* pairs, ContactRow* rows,
    std::size_t count, const RowSettings& settings)
{
	if (settings.compliant)
		assembleRows<true>(places, bodies, carried, pairs, rows, count, settings);
	else
		assembleRows<false>(places, bodies, carried, pairs, rows, count, settings);
}

// The same straight into the lanes of a group. Returns the lanes where wnn = 0, one bit each.
template <bool compliant>
INLINE unsigned assembleLanes(const Place* places, const BodyVelocity* bodies, const Carried* carried, const PairLanes& p, Group& g,
    GroupSprings* springs, const RowSettings& settings)
{
	unsigned unknown = 0;
	for (int lane = 0; lane < Group::lanes; lane += LANES) {
		const Rows r = rowsOf<compliant>(places, bodies, carried, p, lane, settings);
		store(g.nx + lane, r.nx);
		store(g.ny + lane, r.ny);
		store(g.at + lane, r.at * load(p.scaleA + lane));
		store(g.bt + lane, r.bt * load(p.scaleB + lane));
		store(g.bias + lane, r.bias);
		store(g.mu + lane, r.mu);
		if constexpr (compliant) {
			store(g.inverseWnn + lane, 1 / (r.wnn + r.yields.n));
			store(g.inverseWtt + lane, 1 / (r.wtt + r.yields.t));
			store(springs->n + lane, r.yields.n);
			store(springs->t + lane, r.yields.t);
			store(springs->bias + lane, r.yields.bias);
		} else {
			store(g.inverseWnn + lane, 1 / r.wnn);
			store(g.inverseWtt + lane, 1 / r.wtt);
		}
		store(g.pn + lane, r.pn);
		store(g.pt + lane, r.pt);
		alignas(sizeof(Vector)) double wnn[LANES]; // an index into the vector itself is miscompiled by GCC 12 with -fsanitize=undefined
		store(wnn, r.wnn);
		for (int l = 0; l < LANES; l++)
			unknown |= static_cast<unsigned>(!(wnn[l] > 0)) << (lane + l);
	}
	return unknown;
}
static unsigned assembleGroup(const Place* places, const BodyVelocity* bodies, const Carried* carried, const PairLanes& p, Group& g,
    GroupSprings* springs, const RowSettings& settings)
{
	return settings.compliant ? assembleLanes<true>(places, bodies, carried, p, g, springs, settings)
				  : assembleLanes<false>(places, bodies, carried, p, g, springs, settings);
}

// The formulas of effectOf() in account.cpp, for arms an = bn = 0.
static void effects(const Place* places, const Mean* means, const BodyVelocity* bodies, const Carried* carried, const Plane::Impulse* p,
    std::size_t count, const PairLanes* pairs, PairEffects* effects, std::size_t groups, const RowSettings& settings)
{
	for (std::size_t i = 0; i < groups * PairLanes::lanes; i += LANES) {
		const PairLanes& pair = pairs[i / PairLanes::lanes];
		PairEffects& e = effects[i / PairLanes::lanes];
		const int lane = i % PairLanes::lanes;
		const Disks d = locateDisks(places, pair, lane);
		const Bodies A = gather(means, pair.a + lane), B = gather(means, pair.b + lane);
		Vector pn, pt;
		for (int l = 0; l < LANES; l++) {
			const std::size_t at = i + l < count ? i + l : 0;
			pn[l] = p[at].n;
			pt[l] = p[at].t;
		}
		const Vector nx = d.nx, ny = d.ny;
		const CentralContact<Vector> c = { nx, ny, d.radiusA - 0.5 * d.overlap, -(d.radiusB - 0.5 * d.overlap) };
		const Components<Vector> u = relativeVelocity<false>(c, motionOf(A), motionOf(B));
		store(e.nx + lane, nx);
		store(e.ny + lane, ny);
		store(e.work + lane, dot<Vector>({ pn, pt }, u));
		if (settings.compliant) {
			const Rows r = rowsOf<true>(places, bodies, carried, pair, lane, settings);
			const SpringEnergies<Vector> energies = energiesOf<Vector>(r.springs, { pn, pt }, settings.dt);
			store(e.stored + lane, energies.stored);
			store(e.before + lane, energies.before);
			store(e.absorbed + lane, energies.absorbed);
			store(e.dashpots + lane, energies.dashpots);
		}
	}
}
