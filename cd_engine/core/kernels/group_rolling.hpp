// The data of a sweep over contacts that resist rolling: group.hpp says what it is.
#pragma once

#include "kernels/group.hpp"

namespace cd {

template <> struct alignas(64) Group<RollingPlane> : Group<Plane> {
	double ar[lanes], br[lanes]; // lever arms of p_r, divided by k
	double eta[lanes];
	double inverseWrr[lanes], inverseReduced[lanes], wtr[lanes], ratio[lanes]; // RollingBlock
	double pr[lanes];

	void set(int lane, const ContactRow<RollingPlane>& c, double scaleA, double scaleB)
	{
		Group<Plane>::set(lane, c, scaleA, scaleB);
		const RollingBlock<double> of = inverseBlockOf(c);
		ar[lane] = c.ar * scaleA;
		br[lane] = c.br * scaleB;
		eta[lane] = c.eta;
		inverseWrr[lane] = of.rr;
		inverseReduced[lane] = of.reduced;
		wtr[lane] = of.tr;
		ratio[lane] = of.ratio;
		pr[lane] = c.pr;
	}
	void clear(int lane)
	{
		Group<Plane>::clear(lane);
		for (double* const of : { ar, br, eta, inverseWrr, inverseReduced, wtr, ratio, pr })
			of[lane] = 0;
	}
	RollingComponents<double> impulse(std::size_t lane) const { return { pn[lane], pt[lane], pr[lane] }; }
};
static_assert(sizeof(Group<RollingPlane>) == 19 * 64);

template <> struct alignas(64) GroupSprings<RollingPlane> : GroupSprings<Plane> {
	double r[lanes], rollBias[lanes];

	void set(int lane, const ContactRow<RollingPlane>& c)
	{
		GroupSprings<Plane>::set(lane, c);
		r[lane] = c.cr;
		rollBias[lane] = c.rollBias;
	}
	void clear(int lane)
	{
		GroupSprings<Plane>::clear(lane);
		r[lane] = rollBias[lane] = 0;
	}
};

template <> struct alignas(64) GroupBefore<RollingPlane> : GroupBefore<Plane> {
	double pr[lanes];
};

template <class To, class From> void copyRollingImpulses(To& to, const From& from)
{
	copyImpulses<To, From>(to, from);
	std::memcpy(to.pr, from.pr, sizeof to.pr);
}
inline void copyImpulses(GroupBefore<RollingPlane>& to, const Group<RollingPlane>& from) { copyRollingImpulses(to, from); }
inline void copyImpulses(Group<RollingPlane>& to, const GroupBefore<RollingPlane>& from) { copyRollingImpulses(to, from); }

} // namespace cd
