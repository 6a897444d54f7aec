// The contact problem given by its Delassus matrix, as other codes exchange it (Siconos, FCLIB), for bodies of any kind.
//
// Conventions as in contact_system.hpp; the bias is part of q:
//   u = W p + q,   per contact the normal component, then the tangential one
//   0 <= u_n  _|_  p_n >= 0,   |p_t| <= mu p_n,   p_t = -mu p_n u_t/|u_t| where the contact slides
#pragma once

#include "problem/contact_system.hpp"

namespace cd {

// The 2 x 2 coupling of two contacts [1/kg]. W is symmetric in mechanics, but in files not to the last bit, so symmetry is not assumed.
struct Block {
	double nn, nt, tn, tt;
};

struct DelassusSystem {
	std::vector<std::size_t> start; // row i holds the blocks start[i] .. start[i + 1] - 1
	std::vector<int32_t> column; // of each block: the contact that the row couples to, ascending in a row
	std::vector<Block> blocks;
	std::vector<std::size_t> diagonal; // of each row: the index of its own block, whose nn and tt are positive
	std::vector<double> q; // relative velocities without impulses [m/s], 2 a contact
	std::vector<double> mu; // Coulomb friction coefficients
	std::vector<double> p; // impulses [N s], 2 a contact: first guess on entry, solution on exit
	Workspace* memory = nullptr; // as in ContactSystem

	std::size_t contacts() const { return mu.size(); }
	// For asserts: the sizes agree, blocks belong to contacts, and no friction coefficient is negative.
	bool consistent() const
	{
		const std::size_t n = contacts();
		return start.size() == n + 1 && start[n] == blocks.size() && column.size() == blocks.size() && diagonal.size() == n
		    && q.size() == 2 * n && p.size() == 2 * n
		    && std::all_of(column.begin(), column.end(), [n](int32_t i) { return i >= 0 && static_cast<std::size_t>(i) < n; })
		    && std::none_of(mu.begin(), mu.end(), [](double x) { return x < 0; });
	}
	// u = W p + q
	void velocities(const std::vector<double>& p, std::vector<double>& u) const
	{
		u = q;
		for (std::size_t i = 0; i < contacts(); i++)
			for (std::size_t k = start[i]; k < start[i + 1]; k++) {
				const Block& w = blocks[k];
				const double* from = &p[2 * static_cast<std::size_t>(column[k])];
				u[2 * i] += w.nn * from[0] + w.nt * from[1];
				u[2 * i + 1] += w.tn * from[0] + w.tt * from[1];
			}
	}
	std::size_t others(int32_t row) const { return start[row + 1] - start[row] - 1; } // blocks of a row beside its own
};

} // namespace cd
