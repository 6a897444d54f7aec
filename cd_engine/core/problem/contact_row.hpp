// A body and a contact in the equations of a step. contact_system.hpp has the conventions.
#pragma once

#include "scene/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <iterator>

namespace cd {

// One cache line a body in the plane, because a contact needs the velocity and the inverse mass of a body together.
template <class Space> struct alignas(64) BodyVelocity {
	double v[Space::freedoms]; // along the axes [m/s], then angular velocity [rad/s]
	double pushed; // magnitude of the velocity change by the external force in the step [m/s]; 0 where it is not known
	double w[Space::freedoms]; // 1/m along each axis [1/kg], 1/I [1/(kg m^2)]; 0 where the freedom is blocked
	double twisted; // the same for the angular velocity, by the external torque [rad/s]
};
// Of the bodies of a system.
template <class Space> using BodyVelocityIn = BodyVelocity<typename Space::Scene>;
static_assert(sizeof(BodyVelocity<Plane>) == 64 && offsetof(BodyVelocity<Plane>, w) == 32);

// Whether any inverse mass of a body is not 0.
template <class Body> bool isMovable(const Body& b)
{
	return std::any_of(std::begin(b.w), std::end(b.w), [](double w) { return w > 0; });
}
// One over the mass [1/kg], along the axis in which the body moves most easily; 0: it can at most turn.
template <class Space> double inverseMass(const BodyVelocity<Space>& b) { return *std::max_element(b.w, b.w + Space::components); }

template <class Space> struct ContactRow;

template <> struct ContactRow<Plane> {
	static constexpr bool central = false; // law.inl
	int32_t a = 0, b = 0; // indices of the bodies
	double nx = 0, ny = 0; // unit normal a -> b
	double an = 0, at = 0; // lever arms about the centre of `a`: cross(arm, n), cross(arm, t) [m]
	double bn = 0, bt = 0; // the same about the centre of `b` [m]
	double bias = 0; // [m/s]
	double mu = 0; // Coulomb friction coefficient
	double wnn = 0, wnt = 0, wtt = 0; // own block of W [1/kg]
	double pn = 0, pt = 0; // impulse on `b` [N s]: first guess on entry, solution on exit
	// Of a contact with stiffness (contact_system.hpp); 0: rigid.
	double cn = 0, ct = 0; // compliances C [1/kg]
	double slipBias = 0; // [m/s]

	// Whether a group can hold it, if its bodies are uniform. The normal and tangential directions must be uncoupled, as they are for disks, and
	// for boundaries whose free directions are along n or t. turnsA, turnsB: whether the bodies turn.
	bool groupable(bool turnsA, bool turnsB) const
	{
		return wnn > 0 && wtt > 0 && wnt == 0 && an == 0 && bn == 0 && (turnsA || at == 0) && (turnsB || bt == 0);
	}

	bool compliant() const { return cn > 0; }
	double nn() const { return wnn + cn; } // own block of W + C [1/kg]
	double tt() const { return wtt + ct; }

	// Whether neither body can move along the normal: the compliance `along` the normal is only round-off of the sum of `all` compliances.
	// Example: the normal of a body blocked along x, computed as (1, cos(pi/2)), has 6e-17 along y: an effective mass of 1e32 times its own.
	static constexpr double leastShare = 1e-29; // (14 epsilon)^2
	static bool held(double along, double all) { return along <= leastShare * all; }
	double freedom(const double* a, const double* b) const
	{
		return a[0] + a[1] + b[0] + b[1] + (an * an + at * at) * a[2] + (bn * bn + bt * bt) * b[2];
	}
	// W_nn, from inverse masses.
	double compliance(const double* a, const double* b) const
	{
		return nx * nx * (a[0] + b[0]) + ny * ny * (a[1] + b[1]) + an * an * a[2] + bn * bn * b[2];
	}
	// Of the impulse across the normal [m].
	double armA() const { return std::abs(at); }
	double armB() const { return std::abs(bt); }
	void scaleArms(double a, double b)
	{
		an *= a;
		at *= a;
		bn *= b;
		bt *= b;
	}
	// For asserts: the normal has unit length, and the friction coefficient is not negative.
	bool consistent() const { return std::abs(nx * nx + ny * ny - 1) < 1e-6 && !(mu < 0); }

	// Fills wnn, wnt, wtt from the arms and the inverse masses of the bodies. wnn = 0 if both are immobile along n; solvers skip such contacts.
	void assembleBlock(const BodyVelocity<Plane>& A, const BodyVelocity<Plane>& B)
	{
		// The arms of a body that does not and cannot turn have no effect. Zero arms allow the faster kernel for uncoupled contacts.
		if (A.w[2] == 0 && A.v[2] == 0)
			an = at = 0;
		if (B.w[2] == 0 && B.v[2] == 0)
			bn = bt = 0;
		const double wx = A.w[0] + B.w[0], wy = A.w[1] + B.w[1];
		wnn = compliance(A.w, B.w);
		wtt = ny * ny * wx + nx * nx * wy + at * at * A.w[2] + bt * bt * B.w[2];
		wnt = nx * ny * (wy - wx) + an * at * A.w[2] + bn * bt * B.w[2];
		if (wnn > 0 && held(wnn, freedom(A.w, B.w)))
			wnn = wnt = pn = pt = 0;
	}
};
static_assert(sizeof(ContactRow<Plane>) == 8 + 16 * 8 && offsetof(ContactRow<Plane>, at) == 32 && offsetof(ContactRow<Plane>, mu) == 64
    && offsetof(ContactRow<Plane>, pn) == 96);

} // namespace cd
