// Gauss-Seidel sweeps over packed contacts, in the velocities of the bodies: the inner loop that all sweeping solvers share.
#pragma once

#include "contact_system.hpp"
#include "random_order.hpp"
#include "residual.hpp"

namespace cd {

// What a method needs of the form a problem is given in; DelassusSweep has the same functions for the other form.
class Sweep {
    public:
	using System = ContactSystem;

	// Packs the contacts and puts their first-guess impulses on the bodies.
	// seed > 0: each sweep visits the contacts in a new random order.
	Sweep(ContactSystem& system, unsigned seed);

	// Solves every contact once, exactly, the others held. About 112 bytes and 45 operations a contact.
	void operator()();

	// Copies the impulses back to `system.contacts`.
	void storeImpulses();
	// Recomputes the bodies' velocities from the packed impulses, which clears the round-off that updates in place leave behind.
	void restoreVelocities();
	// The error of the impulses last stored.
	Residual error() const { return residual(system, freeVelocity); }

	// Calls f(p_n, p_t, i) with the impulses of every contact that can be solved, i counting them in a fixed order.
	template <class F> void forEachImpulse(F&& f)
	{
		std::size_t i = 0;
		for (Diagonal& c : diagonal)
			f(c.pn, c.pt, i++);
		for (const int32_t row : generalRows)
			f(system.contacts[row].pn, system.contacts[row].pt, i++);
	}
	std::size_t size() const { return diagonal.size() + generalRows.size(); }

	// Calls f(v, i) with every velocity kept; they are linear in the impulses, and have to be moved as those are.
	template <class F> void forEachVelocity(F&& f)
	{
		for (std::size_t i = 0; i < system.bodies.size(); i++)
			for (int k = 0; k < 3; k++)
				f(system.bodies[i].v[k], 3 * i + k);
	}
	std::size_t velocities() const { return 3 * system.bodies.size(); }

    private:
	// A contact without coupling between n and t, and no lever arm of the normal force: the closed form needs no cases.
	struct Diagonal {
		int32_t a, b;
		double nx, ny, at, bt, bias, mu, inverseWnn, inverseWtt, pn, pt;
	};
	static void solveDiagonal(Diagonal&, BodyVelocity* bodies);
	static void solveGeneral(ContactRow&, BodyVelocity* bodies);

	ContactSystem& system;
	std::vector<double> freeVelocity; // as in residual.hpp
	std::vector<Diagonal> diagonal;
	std::vector<int32_t> diagonalRows, generalRows; // where each lies in system.contacts
	RandomOrder order;
};

} // namespace cd
