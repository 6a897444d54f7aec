// group_kernel.cpp includes this file after group_kernel.inl, whose vector types it uses. The same rules hold here.

// Impulses (p_n, p_t) of LANES contacts: at the places i, or one after the other.
#if LANES == 8

typedef double Pair __attribute__((vector_size(16), aligned(16), may_alias)); // one contact's impulses

INLINE Pair pairAt(const double* p, int32_t i) { return *reinterpret_cast<const Pair*>(p + i); }
INLINE Vector four(const Pair& a, const Pair& b, const Pair& c, const Pair& d)
{
	return two(__builtin_shufflevector(a, b, 0, 1, 2, 3), __builtin_shufflevector(c, d, 0, 1, 2, 3));
}
INLINE void gather(const double* p, const int32_t* i, Vector& n, Vector& t)
{
	const Vector even = four(pairAt(p, i[0]), pairAt(p, i[2]), pairAt(p, i[4]), pairAt(p, i[6])),
		     odd = four(pairAt(p, i[1]), pairAt(p, i[3]), pairAt(p, i[5]), pairAt(p, i[7]));
	n = __builtin_shufflevector(even, odd, 0, 8, 2, 10, 4, 12, 6, 14);
	t = __builtin_shufflevector(even, odd, 1, 9, 3, 11, 5, 13, 7, 15);
}

#else

INLINE void gather(const double* p, const int32_t* i, Vector& n, Vector& t)
{
	for (int l = 0; l < LANES; l++) {
		n[l] = p[i[l]];
		t[l] = p[i[l] + 1];
	}
}

#endif

INLINE void storePairs(double* p, const Vector& n, const Vector& t)
{
	for (int l = 0; l < LANES; l++) {
		p[2 * l] = n[l];
		p[2 * l + 1] = t[l];
	}
}
INLINE void loadPairs(const double* p, Vector& n, Vector& t)
{
	for (int l = 0; l < LANES; l++) {
		n[l] = p[2 * l];
		t[l] = p[2 * l + 1];
	}
}

// solveLocal of local_problem.hpp for LANES contacts. Products instead of quotients distinguish the cases, which leaves one division.
INLINE void solveRows(const RowGroup& g, int lane, const Vector& qn, const Vector& qt, Vector& pn, Vector& pt)
{
	const Vector none = {};
	const Vector nn = load(g.own.nn + lane), nt = load(g.own.nt + lane), tn = load(g.own.tn + lane), tt = load(g.own.tt + lane),
		     mu = load(g.mu + lane);
	const Vector determinant = nn * tt - nt * tn;
	const auto regular = determinant > 1e-14 * nn * tt, stiff = tt <= 1e-14 * nn;
	const Vector stickN = qt * nt - qn * tt, stickT = qn * tn - qt * nn;
	const auto sticks = regular & (stickN >= none) & (absolute(stickT) <= mu * stickN);
	const Vector wBack = nn - mu * nt, wForth = nn + mu * nt;
	const auto driven = absolute(qt * nn - tn * qn) > 1e-12 * absolute(qt * nn) - 1e-10 * qn * nn; // along t, where nothing can move
	const auto canSlide = regular | ~stiff | driven;
	const auto slidesBack = canSlide & (wBack > none) & (qt * wBack >= (tn - mu * tt) * qn);
	const auto slidesForth = canSlide & (wForth > none) & (qt * wForth <= (tn + mu * tt) * qn);
	const Vector ratio = slidesBack ? -mu : slidesForth ? mu : none;
	const Vector inverse = 1 / (sticks ? determinant : slidesBack ? wBack : slidesForth ? wForth : nn);
	const Vector n = (sticks ? stickN : -qn) * inverse, t = sticks ? stickT * inverse : ratio * n;
	pn = qn < none ? n : none;
	pt = qn < none ? t : none;
}

// Adds in a fixed order, the same for every vector width.
INLINE double sumOf(const double* x) { return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7])); }

// Finds new impulses of LANES rows of group k from the velocities that the other contacts cause. For a spread row, returns these velocities.
INLINE void solveGroup(const RowGroups& rows, std::size_t k, int lane, Vector& pn, Vector& pt)
{
	const RowGroup& g = rows.groups[k];
	const double* const p = rows.impulses->p;
	const std::size_t end = rows.start[k + 1];
	Vector qn = load(g.qn + lane), qt = load(g.qt + lane);
	for (std::size_t s = rows.start[k]; s < end; s++) {
		const BlockSlice& w = rows.slices[s];
		Vector n, t;
		gather(p, rows.columns[s].pair + lane, n, t);
		qn += load(w.nn + lane) * n + load(w.nt + lane) * t;
		qt += load(w.tn + lane) * n + load(w.tt + lane) * t;
	}
	if (k < rows.firstSpread) {
		solveRows(g, lane, qn, qt, pn, pt);
		return;
	}
	pn = qn;
	pt = qt;
}

// Solves a spread row in the first lane, from the sums over all lanes.
INLINE void solveSpread(const RowGroup& g, Vector* pn, Vector* pt)
{
	alignas(64) double sum[RowGroup::lanes], total[2][LANES] = {};
	for (int part = 0; part < RowGroup::lanes / LANES; part++)
		store(sum + part * LANES, pn[part]);
	total[0][0] = sumOf(sum);
	for (int part = 0; part < RowGroup::lanes / LANES; part++)
		store(sum + part * LANES, pt[part]);
	total[1][0] = sumOf(sum);
	for (int part = 1; part < RowGroup::lanes / LANES; part++)
		pn[part] = pt[part] = Vector {};
	solveRows(g, 0, load(total[0]), load(total[1]), pn[0], pt[0]);
}

INLINE void solveOne(const RowGroups& rows, std::size_t k, Vector* pn, Vector* pt)
{
	for (int part = 0; part < RowGroup::lanes / LANES; part++)
		solveGroup(rows, k, part * LANES, pn[part], pt[part]);
	if (k >= rows.firstSpread)
		solveSpread(rows.groups[k], pn, pt);
}

template <bool ahead>
INLINE void sweepRowGroups(const RowGroups& rows, const ImpulsePairs* before, AheadReport* steps, std::size_t from, std::size_t to)
{
	for (std::size_t k = from; k < to; k++) {
		Vector pn[RowGroup::lanes / LANES], pt[RowGroup::lanes / LANES];
		solveOne(rows, k, pn, pt);
		alignas(64) double change[RowGroup::lanes], against[RowGroup::lanes];
		for (int part = 0; part < RowGroup::lanes / LANES; part++) {
			double* const p = rows.impulses[k].p + 2 * part * LANES;
			if (ahead) {
				Vector yn, yt, n, t;
				loadPairs(p, yn, yt);
				loadPairs(before[k].p + 2 * part * LANES, n, t);
				const Vector dn = yn - pn[part], dt = yt - pt[part];
				store(change + part * LANES, dn * dn + dt * dt);
				store(against + part * LANES, dn * (pn[part] - n) + dt * (pt[part] - t));
			}
			storePairs(p, pn[part], pt[part]);
		}
		if (ahead)
			steps[k] = { sumOf(change), sumOf(against) };
	}
}

static void sweepRows(const RowGroups& rows, const ImpulsePairs* before, AheadReport* steps, std::size_t from, std::size_t to)
{
	if (before)
		sweepRowGroups<true>(rows, before, steps, from, to);
	else
		sweepRowGroups<false>(rows, before, steps, from, to);
}

static void extrapolateRows(ImpulsePairs* impulses, ImpulsePairs* before, const double* beta, std::size_t count)
{
	for (std::size_t k = 0; k < count; k++)
		for (int i = 0; i < 2 * RowGroup::lanes; i += LANES) {
			const Vector now = load(impulses[k].p + i);
			store(impulses[k].p + i, now + beta[k] * (now - load(before[k].p + i)));
			store(before[k].p + i, now);
		}
}
