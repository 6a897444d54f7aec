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
		store(p.beyond + lane, d.radiusA > none ? gap - nearby * smaller(d.radiusA, d.radiusB) : never);
	}
}

// ContactRow::assembleBlock for arms an = bn = 0, and firstGuess(). A lane without a result gets wnn = 0.
static void assemble(
    const Place* places, const BodyVelocity* bodies, const PairLanes* pairs, RowLanes* rows, std::size_t count, const RowSettings& settings)
{
	const Vector none = {};
	for (std::size_t i = 0; i < count * PairLanes::lanes; i += LANES) {
		const PairLanes& p = pairs[i / PairLanes::lanes];
		RowLanes& r = rows[i / PairLanes::lanes];
		const int lane = i % PairLanes::lanes;
		const Disks d = locateDisks(places, p, lane);
		const Bodies A = gather<2>(bodies->w, p.a + lane), B = gather<2>(bodies->w, p.b + lane); // the inverse masses, and what is not used
		const Vector nx = d.nx, ny = d.ny, at = d.radiusA - 0.5 * d.overlap, bt = -(d.radiusB - 0.5 * d.overlap);
		const Vector gap = load(p.reference + lane) - d.overlap, pushed = gap < settings.pushedOut * d.radiusB ? settings.gapCorrection * gap : none;
		const Vector wx = A.vx + B.vx, wy = A.vy + B.vy;
		const Vector wnn = nx * nx * wx + ny * ny * wy, wtt = ny * ny * wx + nx * nx * wy + at * at * A.spin + bt * bt * B.spin;
		const Vector freedom = A.vx + A.vy + B.vx + B.vy + at * at * A.spin + bt * bt * B.spin;
		const auto known = (d.radiusA > none) & (A.spin > none) & (B.spin > none) & (wnn > ContactRow::leastShare * freedom);
		store(r.nx + lane, nx);
		store(r.ny + lane, ny);
		store(r.at + lane, at);
		store(r.bt + lane, bt);
		store(r.bias + lane, ((gap > none ? gap : pushed) + none) / settings.dt);
		store(r.wnn + lane, known ? wnn : none);
		store(r.wnt + lane, nx * ny * (wy - wx) + none * at * A.spin + none * bt * B.spin);
		store(r.wtt + lane, wtt);
		const Vector mx = load(r.was[0] + lane), my = load(r.was[1] + lane), square = mx * mx + my * my;
		const Vector normal = mx * load(r.was[2] + lane) + my * load(r.was[3] + lane);
		const Vector tangential = mx * load(r.was[5] + lane) - my * load(r.was[4] + lane);
		const auto carries = (normal > none) & (tangential * none == none);
		const Vector pn = carries ? settings.dt * normal / square : none, pt = carries ? settings.dt * tangential / square : none;
		const Vector most = load(r.mu + lane) * pn;
		store(r.pn + lane, pn);
		store(r.pt + lane, absolute(pt) > most * settings.onCone ? (pt < none ? -most : most) : pt);
	}
}
