// The contact problem of one time step, formulated in the velocities of the bodies (matrix-free). Every solver works on it.
//
// Conventions, defined here and nowhere else (SI units throughout, plane motion in x, y, rotation about z):
//   n  unit normal from body `a` to body `b`;  t = (-n_y, n_x), n turned by +90 degrees
//   p  = (p_n, p_t) impulse [N s] on body `b`; body `a` takes -p.  Compression: p_n >= 0
//   u  = H^T v relative velocity [m/s] of `b` against `a` at the contact point, u_n < 0: closing
//   W  = H^T M^-1 H  Delassus operator [1/kg], never assembled; a contact knows only its own 2 x 2 block
// Contact law in one step (Signorini in velocity form and Coulomb; Jean 1999, Comput. Methods Appl. Mech. Eng. 177, eqs. 6 and 9):
//   0 <= u_n + bias  _|_  p_n >= 0,   |p_t| <= mu p_n,   p_t = -mu p_n u_t/|u_t| where the contact slides
// `bias` [m/s] carries the gap of the step (gap/h) or Newton's restitution (e u_n before the step).
//
// A contact with stiffness obeys the same law with W + C and biases of both components:
//   0 <= u_n + bias + C_n p_n  _|_  p_n >= 0,   |p_t| <= mu p_n,   p_t = -mu p_n s/|s| where s = u_t + slipBias + C_t p_t is not 0
// With springs k_n, k_t and a normal dashpot c, at the end of a step h (backward Euler), gap g of either sign and tangential force f before it:
//   p_n = h max(0, -k_n (g + h u_n) - c u_n):      C_n = 1/(h (k_n h + c)),   bias = k_n g/(k_n h + c)
//   p_t = h (f - k_t h u_t), cut to mu p_n:        C_t = 1/(k_t h^2),         slipBias = -C_t h f
// k -> infinity is the rigid contact. If all contacts have a stiffness there is always a solution.
#pragma once

#include "problem/contact_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cd {

class Workspace;

template <class Space> struct ContactSystem {
	std::vector<std::array<double, Space::components>> places; // of the bodies' centres [m]; empty where they are not known
	std::vector<BodyVelocityIn<Space>> bodies; // v: the free velocity (after external forces) on entry, the solution on exit
	ContactRows<Space> contacts; // solvers may sweep them in any order but must not reorder them
	Workspace* memory = nullptr; // for those who work on it (workspace.hpp); null: they allocate their own each time
	// Systems with the same memory and the same number have contacts between the same bodies, of the same masses. 0: nothing is known.
	std::size_t contactSet = 0;
	const std::vector<uint8_t>* still = nullptr; // World::still of the first bodies; null: not known

	bool isStill(std::size_t body) const { return still && body < still->size() && (*still)[body]; }
	// Calls f(body) for the bodies of all contacts, for each at least once; in many threads for all bodies, unless there are few contacts.
	template <class F> void forBodies(Threads* threads, const F& f) const
	{
		if (contacts.postponed() || 4 * contacts.size() > bodies.size())
			return forRanges(threads, bodies.size(), [&](std::size_t from, std::size_t to) {
				for (std::size_t i = from; i < to; i++)
					f(i);
			});
		for (const ContactRow<Space>& c : contacts)
			for (const int32_t i : { c.a, c.b })
				f(static_cast<std::size_t>(i));
	}

	// For asserts: bodies of contacts exist, normals have unit length, and no friction coefficient is negative.
	bool consistent() const
	{
		const auto body = [this](int32_t i) { return i >= 0 && static_cast<std::size_t>(i) < bodies.size(); };
		return (places.empty() || places.size() == bodies.size())
		    && std::all_of(contacts.begin(), contacts.end(), [&](const auto& c) { return body(c.a) && body(c.b) && c.consistent(); });
	}

	void assembleBlocks()
	{
		for (ContactRow<Space>& c : contacts)
			c.assembleBlock(bodies[c.a], bodies[c.b]);
	}
};

} // namespace cd
