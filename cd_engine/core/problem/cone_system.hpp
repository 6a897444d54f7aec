// The contact problem in space, given by its Delassus matrix, for bodies of any kind; delassus_system.hpp is the same in the plane.
//
//   u = W p + q,   per contact the normal component, then two tangential ones
//   0 <= u_n  _|_  p_n >= 0,   |p_t| <= mu p_n,   p_t = -mu p_n u_t/|u_t| where the contact slides; p_t, u_t have two components
#pragma once

#include "problem/contact_system.hpp"

#include <array>

namespace cd {

// Of an impulse or a velocity: along the normal, along two tangents.
using Triple = std::array<double, 3>;

// The 3 x 3 coupling of two contacts [1/kg], row by row. Some codes make W unsymmetric, so symmetry is not assumed.
using ConeBlock = std::array<double, 9>;

struct ConeSystem {
	std::vector<std::size_t> start; // row i holds the blocks start[i] .. start[i + 1] - 1
	std::vector<int32_t> column; // of each block: the contact that the row couples to, ascending in a row
	std::vector<ConeBlock> blocks;
	std::vector<std::size_t> diagonal; // of each row: the index of its own block, whose diagonal is positive
	std::vector<Triple> q; // relative velocities without impulses [m/s]
	std::vector<double> mu; // Coulomb friction coefficients
	std::vector<Triple> p; // impulses [N s]: first guess on entry, solution on exit
	Workspace* memory = nullptr; // as in ContactSystem

	std::size_t contacts() const { return mu.size(); }
	// For asserts: the sizes agree, blocks belong to contacts, and no friction coefficient is negative.
	bool consistent() const
	{
		const std::size_t n = contacts();
		return start.size() == n + 1 && start[n] == blocks.size() && column.size() == blocks.size() && diagonal.size() == n && q.size() == n
		    && p.size() == n
		    && std::all_of(column.begin(), column.end(), [n](int32_t i) { return i >= 0 && static_cast<std::size_t>(i) < n; })
		    && std::none_of(mu.begin(), mu.end(), [](double x) { return x < 0; });
	}
	const ConeBlock& own(std::size_t i) const { return blocks[diagonal[i]]; }
	// u = W p + q of one contact.
	Triple velocity(std::size_t i, const std::vector<Triple>& impulses) const
	{
		Triple u = q[i];
		for (std::size_t k = start[i]; k < start[i + 1]; k++)
			addProduct(u, blocks[k], impulses[column[k]]);
		return u;
	}
	// u += w p
	static void addProduct(Triple& u, const ConeBlock& w, const Triple& p)
	{
		u[0] += w[0] * p[0] + w[1] * p[1] + w[2] * p[2];
		u[1] += w[3] * p[0] + w[4] * p[1] + w[5] * p[2];
		u[2] += w[6] * p[0] + w[7] * p[1] + w[8] * p[2];
	}
};

} // namespace cd
