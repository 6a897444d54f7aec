// What a sweep reads and writes: contacts eight by eight, and a body in one 32-byte load.
//
// In a group no two contacts share a body that can move, so its eight are solved at once and their order within it means nothing: every
// width of vectors gives the same bits. The rotation of a body is counted in k omega [m/s], k its radius of gyration (m k^2 = I), in
// which its inverse inertia is 1/m, too.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cd {

struct alignas(32) PackedBody {
	double vx, vy, spin; // [m/s], spin = k omega
	double w; // 1/m along x and y, and of the spin [1/kg]; 0: immobile
};
static_assert(sizeof(PackedBody) == 32);

// Contacts without coupling of n and t between bodies of equal mass in both directions; lanes not needed are without normal and impulse.
struct alignas(64) Group {
	static constexpr int lanes = 8;
	int32_t a[lanes], b[lanes]; // packed bodies
	double nx[lanes], ny[lanes];
	double at[lanes], bt[lanes]; // lever arms of the tangential impulse over k
	double bias[lanes], mu[lanes];
	double inverseWnn[lanes], inverseWtt[lanes];
	double pn[lanes], pt[lanes];
};
static_assert(sizeof(Group) == 11 * 64 && offsetof(Group, nx) == 64); // no gaps: each member begins on a boundary of its own size

// What the contacts of a group miss of their law (residual.hpp), squared.
struct alignas(64) GroupMiss {
	double difference[Group::lanes]; // of the impulse [N^2 s^2]
	double velocity[Group::lanes]; // [m^2/s^2]
};
static_assert(sizeof(GroupMiss) == 2 * 64);

// The impulses of a group one sweep ago.
struct alignas(64) GroupBefore {
	double pn[Group::lanes], pt[Group::lanes];
};
static_assert(sizeof(GroupBefore) == 2 * 64);

} // namespace cd
