// Gauss-Seidel sweeps over the rows of W, for bodies of any kind. sweep.hpp does the same in the velocities of disks.
#pragma once

#include "problem/problem.hpp"
#include "graph/graph.hpp"
#include "base/base.hpp"
#include "error/error.hpp"
#include "matrix/row_momentum.hpp"

namespace cd {

class DelassusSweep {
    public:
	using System = DelassusSystem;

	// Packs the rows and the impulses of the first guess; this costs about as much as fifteen sweeps.
	// seed > 0: each sweep visits the groups of rows in a new random order.
	// Uses one thread, whatever threads are passed.
	DelassusSweep(DelassusSystem& system, unsigned seed, Threads* = nullptr);

	// Solves every contact once, exactly, the others being held. A block of W takes 36 bytes and 8 operations; disks in a dense packing have
	// seven blocks a contact.
	void operator()();
	// The same with momentum (row_momentum.hpp). If a few groups made nearly all of a sweep's change, the next call solves only these, again and
	// again, as many rows in all as a sweep: contacts in hyperstatic clusters settle by a drift of 1e5 sweeps while next to nothing else moves.
	// Siconos's problems of 7002 and 2020 contacts reach 1e-8 this way; without it they stop at 2e-8 and 2e-7.
	void ahead();

	// Does nothing: no velocity is stored. Each is computed from a row and the impulses when needed.
	void restoreVelocities() { }
	// Copies the impulses back to `system.p`.
	void store();
	// The error of the packed impulses.
	Residual error()
	{
		store();
		return residual(system);
	}

	// The impulses of an iterate, saved to restore it later.
	using Iterate = std::vector<ImpulsePairs>;
	Workspace* memory() const { return system.memory; }
	void copyTo(Iterate& p) const { p = packed.impulses; }
	void copyFrom(const Iterate& p) { packed.impulses = p; }

    private:
	// The packed problem. The next DelassusSweep takes over its memory.
	struct Packed {
		RowGrouping grouping;
		std::vector<int32_t> place; // of each row: its lane, counted over all groups
		std::vector<RowGroup> groups;
		std::vector<std::size_t> start; // as in RowGroups
		std::vector<BlockSlice> slices;
		std::vector<SliceColumns> columns;
		std::vector<ImpulsePairs> impulses, before; // of each group: now, and one sweep ago
		RowMomentum momentum;
		std::vector<AheadReport> steps; // of each group: its last step
		std::vector<int32_t> focus; // the only groups that the next sweep with momentum solves; empty: all
	};
	void fillGroup(std::size_t group);
	void fillSlices(std::size_t group);
	// Solves groups as the kernel does.
	void sweep(const ImpulsePairs* before, AheadReport* steps, std::size_t from, std::size_t to);
	void aheadInFocus();
	void chooseFocus();

	DelassusSystem& system;
	Borrowed<Packed> kept;
	Packed& packed;
	bool remembered = false; // whether `before` and `momentum` are set
	RandomOrder order;
};

} // namespace cd
