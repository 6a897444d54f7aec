// The linear system of a Newton step, for a problem given by its bodies or by its matrix. newton.cpp contains the method.
//
// The unknowns are the impulses p of the proximal problem: the contact law between p and u + sigma D (p - pk), with D the diagonal of W. Each contact
// is in one of four states. For given states the problem is linear:
//   open    p = 0
//   stick   u_n + sigma D_n (p_n - pk_n) = 0,   u_t + sigma D_t (p_t - pk_t) = 0
//   slide   u_n + sigma D_n (p_n - pk_n) = 0,   p_t = +-(coupled ? mu p_n : bound)
#pragma once

#include "newton/block_matrix.hpp"
#include "problem/problem.hpp"
#include "error/error.hpp"

#include <cstdint>
#include <vector>

namespace cd {

enum class ContactState : int8_t { open, stick, slidePlus, slideMinus }; // slidePlus: p_t > 0

inline double side(ContactState s) { return s == ContactState::slidePlus ? 1 : s == ContactState::slideMinus ? -1 : 0; }

// The parameters of the linear system; two numbers a contact unless said otherwise.
struct Proximal {
	double sigma = 0;
	std::vector<double> pk, u; // u = W pk + q
	std::vector<ContactState> states; // one a contact
	std::vector<double> bounds; // of |p_t| [N s], one a contact
	bool coupled = true; // true: sliding friction follows the normal impulse; false: it keeps its bound
};

// B: unknowns a block of the matrix.
template <int B> class NewtonMatrix {
    public:
	const std::vector<double>& diagonal() const { return d; } // of W, 2 a contact
	// Floating-point operations of the last solution: those of the factorization, plus an estimate for the loops over the unknowns.
	double work() const { return matrix.operations() + 3000. * static_cast<double>(matrix.rows()); }

    protected:
	std::vector<double> d;
	std::vector<char> planned; // whether the matrix has a place for a contact
	BlockMatrix<B> matrix;
};

template <class System> class NewtonSystem;

// In the velocities of the bodies: three unknowns a body. Bodies that touch couple.
template <> class NewtonSystem<ContactSystem<Plane>> : public NewtonMatrix<3> {
    public:
	explicit NewtonSystem(ContactSystem<Plane>&);

	std::size_t size() const { return rows.size(); } // contacts that can be solved; the others keep their impulses
	double friction(std::size_t i) const { return system.contacts[rows[i]].mu; }

	void load(std::vector<double>& p) const; // from the system
	void store(const std::vector<double>& p); // to the system, with the velocities that belong to them
	Residual error() const { return residual(system, freeVelocity); } // of the stored impulses

	// Computes u = W p + q, 2 numbers a contact. Also stores p.
	void velocities(const std::vector<double>& p, std::vector<double>& u);
	// Solves the linear system for p. Returns false if its matrix is singular to working precision.
	bool solve(const Proximal&, std::vector<double>& p);

    private:
	void plan(const std::vector<ContactState>&);
	void assemble(const Proximal&);

	ContactSystem<Plane>& system;
	std::vector<int32_t> rows; // of the contacts in system.contacts
	std::vector<double> freeVelocity; // as in residual.hpp
	// Of each contact: how u_n and u_t depend on the velocities of a and b, times the square roots of their inverse masses. In the order n of a,
	// n of b, t of a, t of b.
	std::vector<double> arms;
	std::vector<double> z; // changes of the bodies' velocities over the square roots of their inverse masses
};

// In the impulses: two unknowns a contact, coupled as in W.
template <> class NewtonSystem<DelassusSystem> : public NewtonMatrix<2> {
    public:
	explicit NewtonSystem(DelassusSystem&);

	std::size_t size() const { return system.contacts(); }
	double friction(std::size_t i) const { return system.mu[i]; }

	void load(std::vector<double>& p) const { p = system.p; }
	void store(const std::vector<double>& p) { system.p = p; }
	Residual error() const { return residual(system); }

	void velocities(const std::vector<double>& p, std::vector<double>& u) { system.velocities(p, u); }
	bool solve(const Proximal&, std::vector<double>& p);

    private:
	void plan(const std::vector<ContactState>&);
	void assemble(const Proximal&, std::vector<double>& p);

	DelassusSystem& system;
	std::vector<double> root; // the square root of d
};

} // namespace cd
