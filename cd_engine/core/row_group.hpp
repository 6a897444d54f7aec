// The data of a sweep over W: rows in groups of eight, their blocks in slices of eight.
//
// No two rows of a group couple. The eight contacts are therefore solved at once, and their order in the group has no effect: every vector width
// gives the same bits. A row that fits into no group, or has very many blocks, is spread: it makes a group of its own, and each of its slices holds
// eight of its blocks. Memory: 56 bytes a contact, 36 a block beside the own one (as in W) with about a tenth of them empty, 16 of impulses and 16
// more with momentum.
#pragma once

#include "delassus_system.hpp"
#include "group.hpp"

#include <cstddef>
#include <cstdint>

namespace cd {

// Lane l holds a block of row l of a group, or any block of a spread row; zero if there are no more.
struct alignas(64) BlockSlice {
	static constexpr int lanes = 8;
	double nn[lanes], nt[lanes], tn[lanes], tt[lanes];

	void set(int lane, const Block& w)
	{
		nn[lane] = w.nn;
		nt[lane] = w.nt;
		tn[lane] = w.tn;
		tt[lane] = w.tt;
	}
};
static_assert(sizeof(BlockSlice) == 4 * 64);

struct alignas(64) RowGroup {
	static constexpr int lanes = BlockSlice::lanes;
	double qn[lanes], qt[lanes]; // relative velocities without impulses [m/s]
	double mu[lanes];
	BlockSlice own; // the contacts' own blocks [1/kg]; unused lanes: nn = tt = 1
};
static_assert(sizeof(RowGroup) == 7 * 64);

struct alignas(32) SliceColumns {
	int32_t pair[RowGroup::lanes]; // twice the place of the contact whose impulses the block multiplies
};
static_assert(sizeof(SliceColumns) == 32);

// Impulses (p_n, p_t) of the eight places of one group [N s].
struct alignas(64) ImpulsePairs {
	double p[2 * RowGroup::lanes];
};
static_assert(sizeof(ImpulsePairs) == 2 * 64);

struct RowGroups {
	const RowGroup* groups;
	const std::size_t* start; // group g has the slices start[g] .. start[g + 1] - 1
	const BlockSlice* slices;
	const SliceColumns* columns;
	std::size_t firstSpread; // from this group on, each group has one row
	ImpulsePairs* impulses; // of each group, then one more that is zero, for empty lanes
};

} // namespace cd
