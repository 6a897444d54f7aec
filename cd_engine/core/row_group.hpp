// What a sweep over W reads and writes: rows eight by eight, their blocks in slices of eight.
//
// In a group no two rows couple, so its eight contacts are solved at once and their order within it means nothing: every width of vectors
// gives the same bits. A row that finds no such company, or has very many blocks, is spread: a group of its own whose slices hold eight of
// its blocks each. Memory: 56 bytes a contact, 36 a block beside the own one (W has as many) with about a tenth of them empty, 16 of impulses and
// 16 more with momentum.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cd {

struct alignas(64) RowGroup {
	static constexpr int lanes = 8;
	double qn[lanes], qt[lanes]; // relative velocities without impulses [m/s]
	double mu[lanes];
	double nn[lanes], nt[lanes], tn[lanes], tt[lanes]; // the contacts' own blocks [1/kg]; lanes not needed: nn = tt = 1
};
static_assert(sizeof(RowGroup) == 7 * 64);

// Lane l: a block of row l of the group, or any of the row that is spread; zero where there are no more.
struct alignas(64) BlockSlice {
	double nn[RowGroup::lanes], nt[RowGroup::lanes], tn[RowGroup::lanes], tt[RowGroup::lanes];
};
static_assert(sizeof(BlockSlice) == 4 * 64);
struct alignas(32) SliceColumns {
	int32_t pair[RowGroup::lanes]; // twice the place of the contact whose impulses the block multiplies
};
static_assert(sizeof(SliceColumns) == 32);

// Impulses (p_n, p_t) of eight places, one group's [N s].
struct alignas(64) ImpulsePairs {
	double p[2 * RowGroup::lanes];
};
static_assert(sizeof(ImpulsePairs) == 2 * 64);

// What a sweep from an extrapolated point did to a group [N^2 s^2]: y the point, p before, p+ after the sweep.
struct GroupStep {
	double change; // |y - p+|^2
	double against; // (y - p+) . (p+ - p)
};

struct RowGroups {
	const RowGroup* groups;
	const std::size_t* start; // group g has the slices start[g] .. start[g + 1] - 1
	const BlockSlice* slices;
	const SliceColumns* columns;
	std::size_t firstSpread; // the groups from here on have one row each
	ImpulsePairs* impulses; // of each group, and behind them one without, for empty lanes
};

} // namespace cd
