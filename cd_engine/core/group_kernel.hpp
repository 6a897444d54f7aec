// The inner loops of a sweep, compiled once for each kind of processor. All versions give the same bits.
#pragma once

#include "group.hpp"
#include "row_group.hpp"

#include <cstddef>

namespace cd {

// Results of a sweep from an extrapolated point y, summed lane by lane [N^2 s^2]. p are the impulses before the sweep, p+ those after it.
struct alignas(64) LaneSums {
	double change[Group::lanes]; // |y - p+|^2
	double against[Group::lanes]; // (y - p+) . (p+ - p)
};

// How far the contacts miss the contact law, summed lane by lane: members of ResidualSum with the same names; `velocity` is its `missed`.
struct alignas(64) LaneMisses {
	double difference[Group::lanes], square[Group::lanes], differenceEnergy[Group::lanes], squareEnergy[Group::lanes];
	double velocity[Group::lanes];
	double worst[Group::lanes], mostVelocity[Group::lanes];
};

struct GroupKernel {
	const char* name;
	int lanes; // contacts solved at once
	// Solves the contacts of groups[0 .. count) in turn, while the others are held.
	void (*sweep)(Group* groups, std::size_t count, PackedBody* bodies);
	// The same from y = p + beta (p - before); `before` becomes p. The bodies must already have the velocities of y. Adds to the sums.
	void (*sweepAhead)(Group* groups, GroupBefore* before, std::size_t count, PackedBody* bodies, double beta, LaneSums& sums);
	// Replaces every velocity v by v + beta (v - before); `before` becomes v.
	void (*extrapolate)(PackedBody* bodies, PackedBody* before, std::size_t count, double beta);
	// Adds to every body the impulses of its contacts, their moments over k, and, in the member w, the magnitudes |p_n| + (1 + arm^2)|p_t|.
	void (*press)(const Group* groups, std::size_t count, PackedBody* loads);
	// Measures how far the contacts miss the contact law at these velocities. The member w of `moved` holds what acts on the body [m/s]. Adds to
	// the sums, and writes the values of each contact to `each` if it is not null.
	void (*miss)(const Group* groups, std::size_t count, const PackedBody* moved, LaneMisses& sums, GroupMiss* each);
	// For sweeps over rows of W: solves the contacts of the groups from .. to - 1 in turn, while the others are held.
	void (*sweepRows)(const RowGroups& rows, std::size_t from, std::size_t to);
	// The same from y. The impulses must already have the values of y.
	void (*sweepRowsAhead)(const RowGroups& rows, const ImpulsePairs* before, GroupStep* steps, std::size_t from, std::size_t to);
	// Replaces the impulses p of every group by y = p + beta (p - before), with a beta for each group; `before` becomes p.
	void (*extrapolateRows)(ImpulsePairs* impulses, ImpulsePairs* before, const double* beta, std::size_t count);
};

// The kernels that this processor can run, the fastest first. The last one runs on any processor.
struct GroupKernels {
	const GroupKernel* first;
	std::size_t count;
	const GroupKernel* begin() const { return first; }
	const GroupKernel* end() const { return first + count; }
};
GroupKernels groupKernels();

// The kernel in use: the fastest, unless a test or a benchmark has chosen another.
const GroupKernel& groupKernel();
void useGroupKernel(const GroupKernel&);

} // namespace cd
