// A contact in space whose normal passes through the centre of every body that can turn (law_in_space.inl): between spheres, or a sphere and a
// boundary. Other contacts need the full inertia, in cone_system.hpp.
#pragma once

#include "problem/contact_row.hpp"

#include <cmath>

namespace cd {

template <> struct ContactRow<Space3> {
	static constexpr bool central = true;
	int32_t a = 0, b = 0; // indices of the bodies
	double nx = 0, ny = 0, nz = 0; // unit normal a -> b
	double at = 0, bt = 0; // from the centres of `a` and `b` to the contact [m]; 0 where the body does not turn
	double bias = 0; // [m/s]
	double mu = 0; // Coulomb friction coefficient
	double wnn = 0, wtt = 0; // own block of W [1/kg]
	double pn = 0, px = 0, py = 0, pz = 0; // impulse on `b` [N s], along the normal and across it
	double cn = 0, ct = 0; // compliances C [1/kg]; 0: rigid
	double slipX = 0, slipY = 0, slipZ = 0; // slipBias in space [m/s]

	bool compliant() const { return cn > 0; }
	double nn() const { return wnn + cn; } // own block of W + C [1/kg]
	double tt() const { return wtt + ct; }

	bool groupable(bool turnsA, bool turnsB) const { return wnn > 0 && wtt > 0 && (turnsA || at == 0) && (turnsB || bt == 0); }
	static bool held(double along, double all) { return along <= 1e-29 * all; } // as in the plane
	double freedom(const double* a, const double* b) const { return a[0] + a[1] + a[2] + b[0] + b[1] + b[2] + at * at * a[3] + bt * bt * b[3]; }
	double compliance(const double* a, const double* b) const
	{
		return nx * nx * (a[0] + b[0]) + ny * ny * (a[1] + b[1]) + nz * nz * (a[2] + b[2]);
	}
	void scaleArms(double a, double b)
	{
		at *= a;
		bt *= b;
	}
	double armA() const { return at; }
	double armB() const { return bt; }
	bool consistent() const { return std::abs(nx * nx + ny * ny + nz * nz - 1) < 1e-6 && !(mu < 0) && at >= 0 && bt >= 0; }

	static double turning(const double* w) { return std::max({ w[3], w[4], w[5] }); }

	// The larger eigenvalue of the part of a diagonal matrix that acts across n, from the trace and the trace of the square of that part.
	double largestAcross(double x, double y, double z) const
	{
		const double mean = 0.5 * (x + y + z - wnn);
		const double square = x * x * (1 - 2 * nx * nx) + y * y * (1 - 2 * ny * ny) + z * z * (1 - 2 * nz * nz) + wnn * wnn;
		const double spread = 0.5 * square - mean * mean, roundOff = 1e-12 * mean * mean;
		return spread > roundOff ? mean + std::sqrt(spread) : mean;
	}

	// wtt holds for all directions where boundaries that can move do so along their normals or alike in all directions, and spheres turn freely.
	// Elsewhere it is an upper bound: with half of the true value sweeps would overshoot and never end.
	void assembleBlock(const BodyVelocity<Space3>& A, const BodyVelocity<Space3>& B)
	{
		const double all = A.w[0] + A.w[1] + A.w[2] + B.w[0] + B.w[1] + B.w[2];
		wnn = compliance(A.w, B.w);
		const double x = A.w[0] + B.w[0], y = A.w[1] + B.w[1], z = A.w[2] + B.w[2];
		wtt = (x == y && y == z ? 0.5 * (all - wnn) : largestAcross(x, y, z)) + at * at * turning(A.w) + bt * bt * turning(B.w);
		if (wnn > 0 && held(wnn, freedom(A.w, B.w)))
			wnn = pn = px = py = pz = 0;
	}
};

} // namespace cd
