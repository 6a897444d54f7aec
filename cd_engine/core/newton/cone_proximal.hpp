// One subproblem of the proximal-point method in space: the contact law between p and u + sigma D (p - pk). D holds W_nn of each contact, pk is the
// centre.
//
// The law as an equation (Alart & Curnier 1991, Comput. Methods Appl. Mech. Eng. 92, 353), in impulses times sqrt(D) and velocities over sqrt(D):
//   p = cut(p - r u),   u = W p + q + sigma (p - pk)
// Where a contact sticks, this says u = 0; where it is open, p = 0; where it slides, u_n = 0 and p_t = mu z_n z_t/|z_t| with z = p - r u. Newton's
// method solves it with the derivative of what each contact now does: a linear system with three unknowns for each contact that is not open,
// of the true W, whether symmetric or not.
#pragma once

#include "newton/block_matrix.hpp"
#include "problem/problem.hpp"

#include <vector>

namespace cd {

class ConeProximal {
    public:
	ConeProximal(const ConeSystem&, int mostSteps, double mostWork);

	// Solves about the centre pk [N s] from `first`. Returns whether it got there.
	bool solve(const std::vector<Triple>& pk, const std::vector<Triple>& first, double sigma);
	// The result, inside the cone [N s].
	const std::vector<Triple>& impulses() const { return result; }

	int steps() const { return made; } // factorizations
	bool exhausted() const { return made >= mostSteps || work >= mostWork; }

    private:
	void velocities(const std::vector<Triple>& p, std::vector<Triple>& u) const;
	// Of a point: its velocities and its misses p - cut(p - r u). Returns their sum of squares.
	double measure(const std::vector<Triple>& p, std::vector<Triple>& u, std::vector<Triple>& miss) const;
	bool plan();
	void assemble();
	bool step();

	const ConeSystem& system;
	const int mostSteps;
	const double mostWork;
	int made = 0;
	double work = 0;
	double sigma = 0, r = 0;
	std::vector<double> root; // sqrt(W_nn)
	std::vector<Triple> q, centre, x, u, miss, xNew, uNew, missNew; // scaled
	std::vector<Triple> result;
	std::vector<double> change; // the step, three numbers a contact
	std::vector<char> planned; // whether the matrix has a place for a contact
	BlockMatrix<3> matrix;
};

} // namespace cd
