// Gauss-Seidel sweeps over the rows of W in space.
#pragma once

#include "problem/problem.hpp"
#include "base/base.hpp"
#include "error/error.hpp"
#include "matrix/row_momentum.hpp"

namespace cd {

class ConeSweep {
    public:
	using System = ConeSystem;

	// seed > 0: each sweep visits the contacts in a new random order.
	ConeSweep(ConeSystem& system, unsigned seed, Threads* = nullptr);

	// Solves every contact once, exactly, the others being held. A block of W takes 76 bytes and 18 operations.
	void operator()();
	// The same with momentum, of each contact separately (row_momentum.hpp).
	void ahead();

	void restoreVelocities() { } // no velocity is stored
	void store() { } // nor are other impulses
	Residual error() { return residual(system); }

	// The impulses of an iterate, saved to restore it later.
	using Iterate = std::vector<Triple>;
	Workspace* memory() const { return system.memory; }
	void copyTo(Iterate& p) const { p = system.p; }
	void copyFrom(const Iterate& p) { system.p = p; }

    private:
	Triple solved(std::size_t contact) const;

	ConeSystem& system;
	std::vector<Triple> before; // one sweep ago
	std::vector<AheadReport> steps; // of each contact: its last step
	RowMomentum momentum;
	RandomOrder order;
};

} // namespace cd
