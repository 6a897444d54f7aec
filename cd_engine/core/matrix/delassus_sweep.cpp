#include "matrix/delassus_sweep.hpp"
#include "kernels/kernels.hpp"

#include <algorithm>
#include <cassert>

namespace cd {

DelassusSweep::DelassusSweep(DelassusSystem& s, unsigned seed, Threads*)
    : system(s)
    , kept(s.memory)
    , packed(*kept)
    , order(seed, s.memory)
{
	assert(system.consistent());
	packed.grouping.group(system);
	const std::size_t count = packed.grouping.groups();
	packed.place.resize(system.contacts());
	for (std::size_t place = 0; place < packed.grouping.members.size(); place++)
		if (packed.grouping.members[place] >= 0)
			packed.place[packed.grouping.members[place]] = static_cast<int32_t>(place);
	packed.groups.resize(count);
	packed.impulses.resize(count + 1);
	packed.impulses[count] = {};
	packed.start.assign(1, 0);
	packed.slices.clear();
	packed.slices.reserve(system.blocks.size() / RowGroup::lanes); // about a tenth of them stay empty, and own blocks are not among them
	packed.columns.clear();
	packed.columns.reserve(packed.slices.capacity());
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
		g.own.set(lane, row < 0 ? Block { 1, 0, 0, 1 } : system.blocks[system.diagonal[row]]);
		g.qn[lane] = row < 0 ? 0 : system.q[2 * row];
		g.qt[lane] = row < 0 ? 0 : system.q[2 * row + 1];
		g.mu[lane] = row < 0 ? 0 : system.mu[row];
		p[0] = row < 0 ? 0 : system.p[2 * row];
		p[1] = row < 0 ? 0 : system.p[2 * row + 1];
	}
}

// A row with one lane puts all its blocks there. A spread row puts every eighth block in each lane.
void DelassusSweep::fillSlices(std::size_t group)
{
	constexpr std::size_t lanes = RowGroup::lanes;
	const auto nobody = static_cast<int32_t>(2 * lanes * packed.groups.size());
	const bool spread = group >= packed.grouping.firstSpread;
	const int32_t* const members = &packed.grouping.members[group * lanes];
	const std::size_t first = packed.start[group];
	std::size_t slices = 0;
	for (std::size_t lane = 0; lane < lanes; lane++)
		if (members[lane] >= 0)
			slices = std::max(slices, spread ? (system.others(members[lane]) + lanes - 1) / lanes : system.others(members[lane]));
	packed.start.push_back(first + slices);
	packed.slices.resize(first + slices);
	packed.columns.resize(first + slices, { { nobody, nobody, nobody, nobody, nobody, nobody, nobody, nobody } });
	for (std::size_t lane = 0; lane < lanes && members[lane] >= 0; lane++) {
		std::size_t to = spread ? first * lanes : first * lanes + lane; // place of the next block, counted over the lanes of all slices
		for (std::size_t k = system.start[members[lane]]; k < system.start[members[lane] + 1]; k++) {
			if (k == system.diagonal[members[lane]])
				continue;
			packed.slices[to / lanes].set(static_cast<int>(to % lanes), system.blocks[k]);
			packed.columns[to / lanes].pair[to % lanes] = 2 * packed.place[system.column[k]];
			to += spread ? 1 : lanes;
		}
	}
}

void DelassusSweep::sweep(const ImpulsePairs* before, AheadReport* steps, std::size_t from, std::size_t to)
{
	const RowGroups rows { packed.groups.data(), packed.start.data(), packed.slices.data(), packed.columns.data(), packed.grouping.firstSpread,
		packed.impulses.data() };
	groupKernel<Plane>().sweepRows(rows, before, steps, from, to);
}

void DelassusSweep::operator()()
{
	order.visit(packed.groups.size(), [&](std::size_t from, std::size_t to) { sweep(nullptr, nullptr, from, to); });
}

void DelassusSweep::ahead()
{
	const std::size_t count = packed.groups.size();
	if (!remembered) {
		packed.before = packed.impulses;
		packed.momentum.begin(count);
		packed.steps.resize(count);
		packed.focus.clear();
		remembered = true;
	}
	if (!packed.focus.empty())
		return aheadInFocus();
	groupKernel<Plane>().extrapolateRows(packed.impulses.data(), packed.before.data(), packed.momentum.betas.data(), count);
	order.visit(count, [&](std::size_t from, std::size_t to) { sweep(packed.before.data(), packed.steps.data(), from, to); });
	for (std::size_t g = 0; g < count; g++)
		packed.momentum.afterStep(g, packed.steps[g]);
	packed.momentum.afterSweep(packed.steps);
	chooseFocus();
}

void DelassusSweep::aheadInFocus()
{
	for (std::size_t round = packed.groups.size() / packed.focus.size(); round > 0; round--) {
		for (const int32_t g : packed.focus)
			groupKernel<Plane>().extrapolateRows(&packed.impulses[g], &packed.before[g], &packed.momentum.betas[g], 1);
		for (const int32_t g : packed.focus) {
			sweep(packed.before.data(), packed.steps.data(), g, g + 1);
			packed.momentum.afterStep(g, packed.steps[g]);
		}
	}
	packed.focus.clear();
}

void DelassusSweep::chooseFocus()
{
	double total = 0, inFocus = 0;
	for (const AheadReport& s : packed.steps)
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

void DelassusSweep::store()
{
	for (std::size_t place = 0; place < packed.grouping.members.size(); place++)
		if (packed.grouping.members[place] >= 0)
			std::copy_n(packed.impulses.data()->p + 2 * place, 2, &system.p[2 * packed.grouping.members[place]]);
}

} // namespace cd
