// group_kernel.cpp includes this file after group_kernel.inl, whose vector types it uses. The same rules hold here.

// Impulses (p_n, p_t) of LANES contacts: at the places i, or one after the other.
#if LANES == 8

typedef double Pair __attribute__((vector_size(16), aligned(16), may_alias)); // one contact's impulses

INLINE Pair pairAt(const double* p, int32_t i) { return *reinterpret_cast<const Pair*>(p + i); }
INLINE Vector four(const Pair& a, const Pair& b, const Pair& c, const Pair& d)
{
	const Quad low = __builtin_shufflevector(a, b, 0, 1, 2, 3), high = __builtin_shufflevector(c, d, 0, 1, 2, 3);
	return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
INLINE Components<Vector> gatherPairs(const double* p, const int32_t* i)
{
	const Vector even = four(pairAt(p, i[0]), pairAt(p, i[2]), pairAt(p, i[4]), pairAt(p, i[6])),
		     odd = four(pairAt(p, i[1]), pairAt(p, i[3]), pairAt(p, i[5]), pairAt(p, i[7]));
	return { __builtin_shufflevector(even, odd, 0, 8, 2, 10, 4, 12, 6, 14), __builtin_shufflevector(even, odd, 1, 9, 3, 11, 5, 13, 7, 15) };
}

#else

INLINE Components<Vector> gatherPairs(const double* p, const int32_t* i)
{
	Components<Vector> pairs = {};
	for (int l = 0; l < LANES; l++) {
		pairs.n[l] = p[i[l]];
		pairs.t[l] = p[i[l] + 1];
	}
	return pairs;
}

#endif

INLINE void storePairs(double* to, const Components<Vector>& p)
{
	for (int l = 0; l < LANES; l++) {
		to[2 * l] = p.n[l];
		to[2 * l + 1] = p.t[l];
	}
}
INLINE Components<Vector> loadPairs(const double* from)
{
	Components<Vector> p;
	for (int l = 0; l < LANES; l++) {
		p.n[l] = from[2 * l];
		p.t[l] = from[2 * l + 1];
	}
	return p;
}

INLINE Components<Vector> solveRows(const RowGroup& g, int lane, const Components<Vector>& q)
{
	return solveLocal<Vector>(load(g.own.nn + lane), load(g.own.nt + lane), load(g.own.tn + lane), load(g.own.tt + lane), load(g.mu + lane), q);
}

// Adds in a fixed order, the same for every vector width.
INLINE double sumOf(const double* x) { return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7])); }

// Finds new impulses of LANES rows of group k from the velocities that the other contacts cause. For a spread row, returns these velocities.
INLINE Components<Vector> solveGroup(const RowGroups& rows, std::size_t k, int lane)
{
	const RowGroup& g = rows.groups[k];
	const std::size_t end = rows.start[k + 1];
	Components<Vector> q = { load(g.qn + lane), load(g.qt + lane) };
	for (std::size_t s = rows.start[k]; s < end; s++) {
		const BlockSlice& w = rows.slices[s];
		const Components<Vector> p = gatherPairs(rows.impulses->p, rows.columns[s].pair + lane);
		q.n += load(w.nn + lane) * p.n + load(w.nt + lane) * p.t;
		q.t += load(w.tn + lane) * p.n + load(w.tt + lane) * p.t;
	}
	return k < rows.firstSpread ? solveRows(g, lane, q) : q;
}

// Solves a spread row in the first lane, from the sums over all lanes.
INLINE void solveSpread(const RowGroup& g, Components<Vector>* p)
{
	alignas(64) double sum[2][RowGroup::lanes], total[2][LANES] = {};
	for (int part = 0; part < RowGroup::lanes / LANES; part++) {
		store(sum[0] + part * LANES, p[part].n);
		store(sum[1] + part * LANES, p[part].t);
		p[part] = Components<Vector> {};
	}
	total[0][0] = sumOf(sum[0]);
	total[1][0] = sumOf(sum[1]);
	p[0] = solveRows(g, 0, { load(total[0]), load(total[1]) });
}

template <bool ahead>
INLINE void sweepRowGroups(const RowGroups& rows, const ImpulsePairs* before, AheadReport* steps, std::size_t from, std::size_t to)
{
	for (std::size_t k = from; k < to; k++) {
		Components<Vector> next[RowGroup::lanes / LANES];
		for (int part = 0; part < RowGroup::lanes / LANES; part++)
			next[part] = solveGroup(rows, k, part * LANES);
		if (k >= rows.firstSpread)
			solveSpread(rows.groups[k], next);
		alignas(64) double change[RowGroup::lanes], against[RowGroup::lanes];
		for (int part = 0; part < RowGroup::lanes / LANES; part++) {
			double* const own = rows.impulses[k].p + 2 * part * LANES;
			if (ahead) {
				const Components<Vector> y = loadPairs(own), p = loadPairs(before[k].p + 2 * part * LANES);
				store(change + part * LANES, dot(y - next[part], y - next[part]));
				store(against + part * LANES, dot(y - next[part], next[part] - p));
			}
			storePairs(own, next[part]);
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
