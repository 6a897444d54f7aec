// The data of a sweep in space: group.hpp says what it is.
#pragma once

#include "kernels/group.hpp"

namespace cd {

// One cache line a body.
template <> struct alignas(64) PackedBody<Space3> {
	double vx, vy, vz; // [m/s]
	double w; // inverse mass of all [1/kg]; 0: immobile. Where loads are added up: what acts on the body
	double spinX, spinY, spinZ; // k times the angular velocity [m/s]
	double unused;

	static PackedBody of(const BodyVelocity<Space3>& b, double k, double w)
	{
		return { b.v[0], b.v[1], b.v[2], w, b.v[3] * k, b.v[4] * k, b.v[5] * k, 0 };
	}
	void store(BodyVelocity<Space3>& b, const PackedBody& before, double inverseK) const
	{
		b.v[0] = vx;
		b.v[1] = vy;
		b.v[2] = vz;
		b.v[3] += (spinX - before.spinX) * inverseK;
		b.v[4] += (spinY - before.spinY) * inverseK;
		b.v[5] += (spinZ - before.spinZ) * inverseK;
	}
	PackedBody plus(double factor, const PackedBody& o) const
	{
		return { vx + factor * o.vx, vy + factor * o.vy, vz + factor * o.vz, w + factor * o.w, spinX + factor * o.spinX,
			spinY + factor * o.spinY, spinZ + factor * o.spinZ, 0 };
	}
	PackedBody withoutSigns(double now) const { return { vx + 0., vy + 0., vz + 0., now, spinX + 0., spinY + 0., spinZ + 0., 0 }; }
};
static_assert(sizeof(PackedBody<Space3>) == 64);
inline SpatialMotion<double&> velocityOf(PackedBody<Space3>& b) { return { b.vx, b.vy, b.vz, b.spinX, b.spinY, b.spinZ }; }
inline SpatialMotion<double> motionOf(const PackedBody<Space3>& b) { return { b.vx, b.vy, b.vz, b.spinX, b.spinY, b.spinZ }; }

inline PackedKind<Space3> packedKind(const BodyVelocity<Space3>& b)
{
	const double* const w = b.w;
	const bool turns = w[0] > 0 && w[3] > 0, uniform = w[0] == w[1] && w[0] == w[2] && w[3] == w[4] && w[3] == w[5] && (w[0] > 0 || w[3] == 0);
	return { { w[0], w[1], w[2], w[3], w[4], w[5] }, turns ? std::sqrt(w[0] / w[3]) : 1, uniform, turns };
}
inline SpatialMotion<double> packedMasses(const PackedKind<Space3>& kind)
{
	const double square = kind.radius * kind.radius;
	return { kind.w[0], kind.w[1], kind.w[2], kind.w[3] * square, kind.w[4] * square, kind.w[5] * square };
}

// 112 bytes a contact.
template <> struct alignas(64) Group<Space3> {
	static constexpr int lanes = cd::lanes;
	int32_t a[lanes], b[lanes]; // numbers of the packed bodies
	double nx[lanes], ny[lanes], nz[lanes];
	double at[lanes], bt[lanes]; // distances to the contact, divided by k
	double bias[lanes], mu[lanes];
	double inverseWnn[lanes], inverseWtt[lanes];
	double pn[lanes], px[lanes], py[lanes], pz[lanes];

	void set(int lane, const ContactRow<Space3>& c, double scaleA, double scaleB)
	{
		nx[lane] = c.nx;
		ny[lane] = c.ny;
		nz[lane] = c.nz;
		at[lane] = c.at * scaleA;
		bt[lane] = c.bt * scaleB;
		bias[lane] = c.bias;
		mu[lane] = c.mu;
		inverseWnn[lane] = 1 / c.wnn;
		inverseWtt[lane] = 1 / c.wtt;
		pn[lane] = c.pn;
		px[lane] = c.px;
		py[lane] = c.py;
		pz[lane] = c.pz;
	}
	void clear(int lane)
	{
		for (double* const of : { nx, ny, nz, at, bt, bias, mu, inverseWnn, inverseWtt, pn, px, py, pz })
			of[lane] = 0;
	}
	SpatialComponents<double> impulse(std::size_t lane) const { return { pn[lane], px[lane], py[lane], pz[lane] }; }
	double armA(std::size_t lane) const { return at[lane]; }
	double armB(std::size_t lane) const { return bt[lane]; }
	void prefetchImpulses() const
	{
		for (const double* of : { pn, px, py, pz })
			__builtin_prefetch(of);
	}
};
static_assert(sizeof(Group<Space3>) == 14 * 64);

template <> struct alignas(64) GroupBefore<Space3> {
	double pn[lanes], px[lanes], py[lanes], pz[lanes];
};
static_assert(sizeof(GroupBefore<Space3>) == 4 * 64);

// For either of these two as `to` and the other as `from`.
template <class To, class From> void copySpatialImpulses(To& to, const From& from)
{
	std::memcpy(to.pn, from.pn, sizeof to.pn);
	std::memcpy(to.px, from.px, sizeof to.px);
	std::memcpy(to.py, from.py, sizeof to.py);
	std::memcpy(to.pz, from.pz, sizeof to.pz);
}
inline void copyImpulses(GroupBefore<Space3>& to, const Group<Space3>& from) { copySpatialImpulses(to, from); }
inline void copyImpulses(Group<Space3>& to, const GroupBefore<Space3>& from) { copySpatialImpulses(to, from); }

} // namespace cd
