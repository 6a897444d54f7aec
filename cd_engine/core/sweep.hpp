// Gauss-Seidel sweeps over packed contacts: the inner loop that all sweeping solvers share.
#pragma once

#include "contact_system.hpp"

#include <random>

namespace cd {

class Sweep {
    public:
	// Packs the contacts and puts their first-guess impulses on the bodies. freeVelocity as in residual.hpp.
	// seed > 0: each sweep visits the contacts in a new random order.
	Sweep(ContactSystem& system, const std::vector<double>& freeVelocity, unsigned seed);

	// Solves every contact once, exactly, the others held. About 112 bytes and 45 operations a contact.
	void operator()();

	// Copies the impulses back to `system.contacts`.
	void storeImpulses();
	// Recomputes the bodies' velocities from the packed impulses, which clears the round-off that updates in place leave behind.
	void restoreVelocities(const std::vector<double>& freeVelocity);

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
	std::vector<BodyVelocity>& bodies() { return system.bodies; }

    private:
	// A contact without coupling between n and t, and no lever arm of the normal force: the closed form needs no cases.
	struct Diagonal {
		int32_t a, b;
		double nx, ny, at, bt, bias, mu, inverseWnn, inverseWtt, pn, pt;
	};
	static void solveDiagonal(Diagonal&, BodyVelocity* bodies);
	static void solveGeneral(ContactRow&, BodyVelocity* bodies);

	ContactSystem& system;
	std::vector<Diagonal> diagonal;
	std::vector<int32_t> diagonalRows, generalRows; // where each lies in system.contacts
	std::vector<int32_t> order; // of the random sweeps
	std::mt19937_64 random;
	bool shuffled;
};

} // namespace cd
