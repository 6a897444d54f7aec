// The data that a sweep reads and writes: contacts in groups of eight, and bodies of 32 bytes, each read by one load.
//
// No two contacts of a group share a movable body. The eight are therefore solved at once, and their order in the group has no effect: every vector
// width gives the same bits. The rotation of a body is stored as k omega [m/s], with k its radius of gyration (m k^2 = I). The inverse inertia of
// this variable is 1/m, too.
#pragma once

#include "base/base.hpp"
#include "problem/problem.hpp"

#include <cstddef>
#include <cstdint>

namespace cd {

struct alignas(32) PackedBody {
	double vx, vy, spin; // [m/s], spin = k omega
	double w; // inverse mass of vx, vy and spin [1/kg]; 0: immobile
};
static_assert(sizeof(PackedBody) == 32);
inline Motion<double&> velocityOf(PackedBody& b) { return { b.vx, b.vy, b.spin }; }

// Contacts that do not couple n and t, between bodies with equal mass in both directions. Unused lanes have neither normal nor impulse.
struct alignas(64) Group {
	static constexpr int lanes = cd::lanes;
	int32_t a[lanes], b[lanes]; // numbers of the packed bodies
	double nx[lanes], ny[lanes];
	double at[lanes], bt[lanes]; // lever arms of the tangential impulse, divided by k
	double bias[lanes], mu[lanes];
	double inverseWnn[lanes], inverseWtt[lanes];
	double pn[lanes], pt[lanes];
};
static_assert(sizeof(Group) == 11 * 64 && offsetof(Group, nx) == 64); // no gaps: each member begins on a boundary of its own size

// Of the contacts of a group that have a stiffness. A rigid problem has none.
struct alignas(64) GroupSprings {
	double n[Group::lanes], t[Group::lanes], bias[Group::lanes];
};
static_assert(sizeof(GroupSprings) == 3 * 64);

// How far the contacts of a group miss the contact law (Miss in law.inl).
struct alignas(64) GroupMiss {
	double difference[Group::lanes], velocity[Group::lanes];
};
static_assert(sizeof(GroupMiss) == 2 * 64);

// Result of a sweep from an extrapolated point y. p are the impulses before the sweep, p+ those after it.
struct AheadReport {
	double change = 0; // |y - p+|^2 [N^2 s^2]
	double against = 0; // (y - p+) . (p+ - p) [N^2 s^2]; positive if the sweep turned back against the momentum
};

// The impulses of a group one sweep ago.
struct alignas(64) GroupBefore {
	double pn[Group::lanes], pt[Group::lanes];
};
static_assert(sizeof(GroupBefore) == 2 * 64);

// The data of a sweep over W: rows in groups of eight, their blocks in slices of eight. Rows of a group do not couple, either. A row that fits into
// no group, or has very many blocks, is spread: it makes a group of its own, and each of its slices holds eight of its blocks. Memory: 56 bytes a
// contact, 36 a block beside the own one (as in W) with about a tenth of them empty, 16 of impulses and 16 more with momentum.

// Lane l holds a block of row l of a group, or any block of a spread row; zero if there are no more.
struct alignas(64) BlockSlice {
	static constexpr int lanes = cd::lanes;
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
