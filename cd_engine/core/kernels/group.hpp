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
#include <cstring>

namespace cd {

template <class Space> struct PackedBody;
template <class Space> using PackedBodyIn = PackedBody<typename Space::Scene>;
template <class Space> struct Group;
template <class Space> struct GroupSprings;
template <class Space> struct GroupBefore; // the impulses of a group one sweep ago

template <> struct alignas(32) PackedBody<Plane> {
	double vx, vy, spin; // [m/s], spin = k omega
	double w; // inverse mass of vx, vy and spin [1/kg]; 0: immobile. Where loads are added up: what acts on the body

	// k: radius of gyration [m].
	static PackedBody of(const BodyVelocity<Plane>& b, double k, double w) { return { b.v[0], b.v[1], b.v[2] * k, w }; }
	// Adds only the change of the spin, so that one that nothing changes stays the same to the last bit.
	void store(BodyVelocity<Plane>& b, const PackedBody& before, double inverseK) const
	{
		b.v[0] = vx;
		b.v[1] = vy;
		b.v[2] += (spin - before.spin) * inverseK;
	}
	// This + factor times other.
	PackedBody plus(double factor, const PackedBody& other) const
	{
		return { vx + factor * other.vx, vy + factor * other.vy, spin + factor * other.spin, w + factor * other.w };
	}
	// With +0 for -0, and another member w.
	PackedBody withoutSigns(double w) const { return { vx + 0., vy + 0., spin + 0., w }; }
};
static_assert(sizeof(PackedBody<Plane>) == 32);
inline Motion<double&> velocityOf(PackedBody<Plane>& b) { return { b.vx, b.vy, b.spin }; }
inline Motion<double> motionOf(const PackedBody<Plane>& b) { return { b.vx, b.vy, b.spin }; }

// How sweeps treat a body of these inverse masses.
template <class Space> struct PackedKind {
	double w[Space::freedoms];
	double radius; // k [m]; 1 where the body does not turn
	bool uniform; // all its freedoms have one inverse mass: its contacts may be in a group
	bool turns;
};
inline PackedKind<Plane> packedKind(const BodyVelocity<Plane>& b)
{
	const double x = b.w[0], y = b.w[1], spin = b.w[2];
	const bool turns = x > 0 && spin > 0, uniform = x == y && (x > 0 || spin == 0);
	return { { x, y, spin }, turns ? std::sqrt(x / spin) : 1, uniform, turns };
}
// The inverse masses of x, y and k omega.
inline Motion<double> packedMasses(const PackedKind<Plane>& kind) { return { kind.w[0], kind.w[1], kind.w[2] * (kind.radius * kind.radius) }; }

// Contacts that do not couple n and t, between bodies with equal mass in both directions. Unused lanes have neither normal nor impulse.
template <> struct alignas(64) Group<Plane> {
	static constexpr int lanes = cd::lanes;
	int32_t a[lanes], b[lanes]; // numbers of the packed bodies
	double nx[lanes], ny[lanes];
	double at[lanes], bt[lanes]; // lever arms of the tangential impulse, divided by k
	double bias[lanes], mu[lanes];
	double inverseWnn[lanes], inverseWtt[lanes];
	double pn[lanes], pt[lanes];

	// scaleA, scaleB: 1/k of the bodies.
	void set(int lane, const ContactRow<Plane>& c, double scaleA, double scaleB)
	{
		nx[lane] = c.nx;
		ny[lane] = c.ny;
		at[lane] = c.at * scaleA;
		bt[lane] = c.bt * scaleB;
		bias[lane] = c.bias;
		mu[lane] = c.mu;
		pn[lane] = c.pn;
		pt[lane] = c.pt;
		inverseWnn[lane] = 1 / c.nn();
		inverseWtt[lane] = 1 / c.tt();
	}
	void clear(int lane)
	{
		for (double* const of : { nx, ny, at, bt, bias, mu, pn, pt, inverseWnn, inverseWtt })
			of[lane] = 0;
	}
	double armA(std::size_t lane) const { return std::abs(at[lane]); }
	double armB(std::size_t lane) const { return std::abs(bt[lane]); }
	Components<double> impulse(std::size_t lane) const { return { pn[lane], pt[lane] }; }
	void prefetchImpulses() const
	{
		__builtin_prefetch(&pn);
		__builtin_prefetch(&pt);
	}
};
static_assert(sizeof(Group<Plane>) == 11 * 64 && offsetof(Group<Plane>, nx) == 64); // no gaps: each member begins on a boundary of its own size

// Of the contacts of a group that have a stiffness. A rigid problem has none.
template <> struct alignas(64) GroupSprings<Plane> {
	double n[lanes], t[lanes], bias[lanes];

	void set(int lane, const ContactRow<Plane>& c)
	{
		n[lane] = c.cn;
		t[lane] = c.ct;
		bias[lane] = c.slipBias;
	}
	void clear(int lane) { n[lane] = t[lane] = bias[lane] = 0; }
};
static_assert(sizeof(GroupSprings<Plane>) == 3 * 64);

// How far the contacts of a group miss the contact law (Miss in law.inl).
struct alignas(64) GroupMiss {
	double difference[lanes], velocity[lanes];
};
static_assert(sizeof(GroupMiss) == 2 * 64);

// Result of a sweep from an extrapolated point y. p are the impulses before the sweep, p+ those after it.
struct AheadReport {
	double change = 0; // |y - p+|^2 [N^2 s^2]
	double against = 0; // (y - p+) . (p+ - p) [N^2 s^2]; positive if the sweep turned back against the momentum
};

template <> struct alignas(64) GroupBefore<Plane> {
	double pn[lanes], pt[lanes];
};
static_assert(sizeof(GroupBefore<Plane>) == 2 * 64);

// From one of these two to the other.
template <class To, class From> void copyImpulses(To& to, const From& from)
{
	std::memcpy(to.pn, from.pn, sizeof to.pn); // std::copy_n would be a call
	std::memcpy(to.pt, from.pt, sizeof to.pt);
}

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
