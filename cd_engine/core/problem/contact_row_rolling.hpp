// A contact in the plane that resists rolling (law_rolling.inl).
#pragma once

#include "problem/contact_row.hpp"

namespace cd {

template <> struct ContactRow<RollingPlane> : ContactRow<Plane> {
	double length = 0; // L [m]
	double ar = 0, br = 0; // lever arms of p_r: L, or 0 where the body does not turn [m]
	double eta = 0; // eta L p_n bounds the moment; 0: the contact does not resist rolling
	double wnr = 0, wtr = 0, wrr = 0; // own block of W [1/kg]
	double pr = 0; // moment on `b` over L [N s]
	// Of a contact with stiffness; 0: rigid.
	double cr = 0; // compliance [1/kg]
	double rollBias = 0; // [m/s]

	double rr() const { return wrr + cr; }
	// Beside what is so of any contact: n and r must be uncoupled, and p_r must have an effect.
	bool groupable(bool turnsA, bool turnsB) const
	{
		return ContactRow<Plane>::groupable(turnsA, turnsB) && wnr == 0 && (eta == 0 || wrr > 0) && (turnsA || ar == 0)
		    && (turnsB || br == 0);
	}
	void scaleArms(double a, double b)
	{
		ContactRow<Plane>::scaleArms(a, b);
		ar *= a;
		br *= b;
	}
	bool consistent() const { return ContactRow<Plane>::consistent() && eta >= 0 && length >= 0; }

	void assembleBlock(const BodyVelocity<Plane>& A, const BodyVelocity<Plane>& B)
	{
		ContactRow<Plane>::assembleBlock(A, B);
		ar = A.w[2] == 0 && A.v[2] == 0 ? 0 : length;
		br = B.w[2] == 0 && B.v[2] == 0 ? 0 : length;
		wnr = an * ar * A.w[2] + bn * br * B.w[2];
		wtr = at * ar * A.w[2] + bt * br * B.w[2];
		wrr = ar * ar * A.w[2] + br * br * B.w[2];
		if (!(wnn > 0))
			pr = 0;
	}
};

} // namespace cd
