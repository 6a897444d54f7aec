// Gauss-Seidel sweeps over the rows of W: what sweep.hpp does in the velocities of disks, for any bodies.
#pragma once

#include "delassus_system.hpp"
#include "random_order.hpp"
#include "residual.hpp"
#include "row_grouping.hpp"
#include "row_momentum.hpp"
#include "threads.hpp"

#include <memory>

namespace cd {

class DelassusSweep {
    public:
	using System = DelassusSystem;

	// Packs the rows and the first-guess impulses; costs about as much as fifteen sweeps.
	// seed > 0: each sweep visits the groups of rows in a new random order.
	// By one thread, whatever threads there are.
	DelassusSweep(DelassusSystem& system, unsigned seed, Threads* = nullptr);
	~DelassusSweep();
	DelassusSweep(const DelassusSweep&) = delete;
	DelassusSweep& operator=(const DelassusSweep&) = delete;

	// Solves every contact once, exactly, the others held. A block of W is 36 bytes and 8 operations; disks in a dense packing have seven a
	// contact.
	void operator()();
	// The same with momentum (row_momentum.hpp). Where nearly all of a sweep's change was in a few groups, the next solves these again and again,
	// as many rows in all: contacts that hold each other in more ways than they have bodies settle by a drift of 1e5 sweeps, next to nothing else
	// moving. Siconos's problems of 7002 and 2020 contacts come to 1e-8 this way, and stop at 2e-8 and 2e-7 without.
	void ahead();

	// No velocity is kept: each is the product of a row with the impulses, made when needed.
	void restoreVelocities() { }
	// Copies the impulses back to `system.p`.
	void store();
	// The error of the packed impulses.
	Residual error()
	{
		store();
		return residual(system);
	}

	// The impulses of an iterate, to come back to.
	using Iterate = std::vector<ImpulsePairs>;
	void copyTo(Iterate& p) const { p = packed.impulses; }
	void copyFrom(const Iterate& p) { packed.impulses = p; }

    private:
	// The packed problem. Its memory is kept from one sweep of a thread to the next.
	struct Packed {
		RowGrouping grouping;
		RowGroupBuilder builder;
		std::vector<int32_t> place; // of each row: its lane among those of all groups
		std::vector<RowGroup> groups;
		std::vector<std::size_t> start; // as in RowGroups
		std::vector<BlockSlice> slices;
		std::vector<SliceColumns> columns;
		std::vector<ImpulsePairs> impulses, before; // of each group, now and a sweep ago
		RowMomentum momentum;
		std::vector<GroupStep> steps; // of each group, the last it made
		std::vector<int32_t> focus; // groups that the next sweep with momentum is spent on; none: all
	};
	static std::unique_ptr<Packed>& spare();

	double* pairAt(std::size_t place) { return packed.impulses[place / RowGroup::lanes].p + 2 * (place % RowGroup::lanes); }
	void fillGroup(std::size_t group);
	void countSlices();
	void fillSlices(std::size_t group);
	RowGroups rows();
	void remember();
	void aheadInFocus();
	void chooseFocus();

	DelassusSystem& system;
	std::unique_ptr<Packed> kept;
	Packed& packed;
	bool remembered = false; // whether `before` and `momentum` are filled
	RandomOrder order;
};

} // namespace cd
