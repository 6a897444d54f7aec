// One subproblem of the proximal-point method in space: the contact law between p and u + sigma D (p - pk). D holds W_nn of each contact, pk is the
// centre.
//
// The law as an equation (Alart & Curnier 1991, Comput. Methods Appl. Mech. Eng. 92, 353), in impulses times sqrt(D) and velocities over sqrt(D):
//   p = cut(z),  z = p - r u,  u = W p + q + sigma (p - pk)
// A contact is open (p = 0), sticks (u = 0) or slides (u_n = 0, p_t = mu z_n z_t/|z_t|). Newton's method solves a linear system of what each contact
// now does, with three unknowns for each that is not open, of the true W, whether symmetric or not. In the derivative of z_t/|z_t| one of the two
// directions is p_t/max(mu z_n, |p_t|), which keeps the part of a sliding contact positive (Hueber, Stadler & Wohlmuth 2008, SIAM J. Sci. Comput. 30,
// 572, section 3.3). r = 1/(1 + sigma), the inverse of what a contact has on the diagonal along its normal.
#pragma once

#include "newton/block_matrix.hpp"
#include "problem/problem.hpp"

#include <vector>

namespace cd {

class ConeProximal {
    public:
	// most: limit on the number of factorizations; work: limit on their floating-point operations
	ConeProximal(const ConeSystem&, int most, double work);

	// Solves about the centre pk [N s], from `first`. Returns false if this takes too many steps.
	bool solve(const std::vector<Triple>& pk, const std::vector<Triple>& first, double sigma);

	const std::vector<Triple>& impulses() const { return result; } // of the last attempt, inside the cone [N s]
	int steps() const { return made; } // factorizations
	bool exhausted() const { return made >= mostSteps || work >= mostWork; }

    private:
	void regularize(const std::vector<Triple>& pk, double by);
	Triple point(std::size_t i) const { return { x[i][0] - r * u[i][0], x[i][1] - r * u[i][1], x[i][2] - r * u[i][2] }; } // z
	double measure();
	bool descend();
	bool step();
	void plan();
	void assemble();
	void addContact(std::size_t i, const Triple& z);

	ConeSystem scaled; // W and q in these units, with sigma on the diagonal of W and -sigma pk in q
	const int mostSteps;
	const double mostWork;
	int made = 0;
	double work = 0;
	double sigma = 0, r = 1;
	std::vector<double> root; // sqrt(W_nn)
	std::vector<Triple> q; // without the centre
	std::vector<Triple> x, u, miss, start; // the iterate, its velocities, x - cut(z); where the step starts
	std::vector<Triple> result;
	std::vector<char> loaded; // whether z_n > 0
	std::vector<char> planned; // whether the matrix has a place for a contact
	std::vector<double> change; // right-hand side, then the step: three numbers a contact
	BlockMatrix<3> matrix;
};

} // namespace cd
