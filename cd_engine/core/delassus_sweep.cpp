#include "delassus_sweep.hpp"
#include "group_kernel.hpp"

#include <algorithm>
#include <utility>

namespace cd {

DelassusSweep::DelassusSweep(DelassusSystem& s, unsigned seed, Threads*)
    : system(s)
    , kept(s.memory)
    , packed(*kept)
    , order(seed, s.memory)
{
	packed.grouping.group(system);
	const std::size_t count = packed.grouping.groups();
	packed.place.resize(system.contacts());
	for (std::size_t place = 0; place < packed.grouping.members.size(); place++)
		if (packed.grouping.members[place] >= 0)
			packed.place[packed.grouping.members[place]] = static_cast<int32_t>(place);
	packed.groups.resize(count);
	packed.impulses.resize(count + 1);
	packed.impulses[count] = {};
	countSlices();
	for (std::size_t g = 0; g < count; g++) {
		fillGroup(g);
		fillSlices(g);
	}
}

void DelassusSweep::fillGroup(std::size_t group)
{
	RowGroup& g = packed.groups[group];
	for (int lane = 0; lane < RowGroup::lanes; lane++) {
		const int32_t row = packed.grouping.members[group * RowGroup::lanes + lane];
		double* const p = &packed.impulses[group].p[2 * lane];
		if (row < 0) {
			g.qn[lane] = g.qt[lane] = g.mu[lane] = g.nt[lane] = g.tn[lane] = p[0] = p[1] = 0;
			g.nn[lane] = g.tt[lane] = 1;
			continue;
		}
		const Block& own = system.blocks[system.diagonal[row]];
		g.qn[lane] = system.q[2 * row];
		g.qt[lane] = system.q[2 * row + 1];
		g.mu[lane] = system.mu[row];
		g.nn[lane] = own.nn;
		g.nt[lane] = own.nt;
		g.tn[lane] = own.tn;
		g.tt[lane] = own.tt;
		p[0] = system.p[2 * row];
		p[1] = system.p[2 * row + 1];
	}
}

void DelassusSweep::countSlices()
{
	const auto others = [&](int32_t row) { return row < 0 ? 0 : system.start[row + 1] - system.start[row] - 1; };
	packed.start.resize(packed.groups.size() + 1);
	packed.start[0] = 0;
	for (std::size_t g = 0; g < packed.groups.size(); g++) {
		const int32_t* const member = &packed.grouping.members[g * RowGroup::lanes];
		std::size_t slices = (others(member[0]) + RowGroup::lanes - 1) / RowGroup::lanes;
		if (g < packed.grouping.firstSpread) {
			slices = 0;
			for (int lane = 0; lane < RowGroup::lanes; lane++)
				slices = std::max(slices, others(member[lane]));
		}
		packed.start[g + 1] = packed.start[g] + slices;
	}
	packed.slices.resize(packed.start.back());
	packed.columns.resize(packed.start.back());
}

void DelassusSweep::fillSlices(std::size_t group)
{
	const auto nobody = static_cast<int32_t>(2 * RowGroup::lanes * packed.groups.size());
	const bool spread = group >= packed.grouping.firstSpread;
	const std::size_t first = packed.start[group], end = packed.start[group + 1];
	const auto put = [&](std::size_t slice, int lane, const Block& w, int32_t pair) {
		BlockSlice& s = packed.slices[slice];
		s.nn[lane] = w.nn;
		s.nt[lane] = w.nt;
		s.tn[lane] = w.tn;
		s.tt[lane] = w.tt;
		packed.columns[slice].pair[lane] = pair;
	};
	for (int lane = 0; lane < RowGroup::lanes; lane++) {
		const int32_t row = packed.grouping.members[group * RowGroup::lanes + (spread ? 0 : lane)];
		// A row with one lane puts all its blocks there. A spread row puts every eighth block in each lane.
		std::size_t slice = first, seen = 0;
		if (row >= 0)
			for (std::size_t k = system.start[row]; k < system.start[row + 1]; k++)
				if (k != system.diagonal[row] && (!spread || static_cast<int>(seen++ % RowGroup::lanes) == lane))
					put(slice++, lane, system.blocks[k], 2 * packed.place[system.column[k]]);
		for (; slice < end; slice++)
			put(slice, lane, { 0, 0, 0, 0 }, nobody);
	}
}

RowGroups DelassusSweep::rows()
{
	return { packed.groups.data(), packed.start.data(), packed.slices.data(), packed.columns.data(), packed.grouping.firstSpread,
		packed.impulses.data() };
}

void DelassusSweep::operator()()
{
	const GroupKernel& kernel = groupKernel();
	if (!order)
		return kernel.sweepRows(rows(), 0, packed.groups.size());
	for (const int32_t g : order.next(packed.groups.size()))
		kernel.sweepRows(rows(), g, g + 1);
}

void DelassusSweep::ahead()
{
	const GroupKernel& kernel = groupKernel();
	const std::size_t count = packed.groups.size();
	if (!remembered)
		remember();
	if (!packed.focus.empty())
		return aheadInFocus();
	kernel.extrapolateRows(packed.impulses.data(), packed.before.data(), packed.momentum.betas().data(), count);
	if (order) {
		for (const int32_t g : order.next(count))
			kernel.sweepRowsAhead(rows(), packed.before.data(), packed.steps.data(), g, g + 1);
	} else
		kernel.sweepRowsAhead(rows(), packed.before.data(), packed.steps.data(), 0, count);
	for (std::size_t g = 0; g < count; g++)
		packed.momentum.add(g, packed.steps[g]);
	packed.momentum.watch(packed.steps);
	chooseFocus();
}

void DelassusSweep::aheadInFocus()
{
	const GroupKernel& kernel = groupKernel();
	for (std::size_t round = packed.groups.size() / packed.focus.size(); round > 0; round--) {
		for (const int32_t g : packed.focus)
			kernel.extrapolateRows(&packed.impulses[g], &packed.before[g], &packed.momentum.betas()[g], 1);
		for (const int32_t g : packed.focus) {
			kernel.sweepRowsAhead(rows(), packed.before.data(), packed.steps.data(), g, g + 1);
			packed.momentum.add(g, packed.steps[g]);
		}
	}
	packed.focus.clear();
}

void DelassusSweep::chooseFocus()
{
	double total = 0, inFocus = 0;
	for (const GroupStep& s : packed.steps)
		total += s.change;
	for (std::size_t g = 0; g < packed.steps.size(); g++)
		if (packed.steps[g].change > 1e-3 * total) {
			packed.focus.push_back(static_cast<int32_t>(g));
			inFocus += packed.steps[g].change;
		}
	// The focus has at most an eighth of the groups, and the others keep at most a tenth of the change (in the 2-norm).
	if (8 * packed.focus.size() > packed.groups.size() || !(inFocus > 0.99 * total))
		packed.focus.clear();
}

void DelassusSweep::remember()
{
	packed.before = packed.impulses;
	packed.momentum.begin(packed.groups.size());
	packed.steps.resize(packed.groups.size());
	packed.focus.clear();
	remembered = true;
}

void DelassusSweep::store()
{
	for (std::size_t place = 0; place < packed.grouping.members.size(); place++)
		if (packed.grouping.members[place] >= 0)
			std::copy_n(pairAt(place), 2, &system.p[2 * packed.grouping.members[place]]);
}

} // namespace cd
