// The inner loops of a sweep, once for every kind of processor; all give the same bits.
#pragma once

#include "group.hpp"
#include "row_group.hpp"

#include <cstddef>

namespace cd {

// What a sweep from an extrapolated point did, summed lane by lane [N^2 s^2]: y the point, p before, p+ after the sweep.
struct alignas(64) LaneSums {
	double change[Group::lanes]; // |y - p+|^2
	double against[Group::lanes]; // (y - p+) . (p+ - p)
};

// What the contacts miss of their law, summed lane by lane: the members of ResidualSum of the same names, `velocity` its `missed`.
struct alignas(64) LaneMisses {
	double difference[Group::lanes], square[Group::lanes], differenceEnergy[Group::lanes], squareEnergy[Group::lanes];
	double velocity[Group::lanes];
	double worst[Group::lanes], mostVelocity[Group::lanes];
};

struct GroupKernel {
	const char* name;
	int lanes; // contacts solved at once
	// Solves the contacts of groups[0 .. count) in turn, the others held.
	void (*sweep)(Group* groups, std::size_t count, PackedBody* bodies);
	// The same from y = p + beta (p - before); `before` becomes p. The bodies have been moved to y already. Adds to the sums.
	void (*sweepAhead)(Group* groups, GroupBefore* before, std::size_t count, PackedBody* bodies, double beta, LaneSums& sums);
	// v + beta (v - before) for every velocity; `before` becomes v.
	void (*extrapolate)(PackedBody* bodies, PackedBody* before, std::size_t count, double beta);
	// Adds to every body what its contacts bring: the impulse, its moment over k, and in place of w the sizes |p_n| + (1 + arm^2)|p_t|.
	void (*press)(const Group* groups, std::size_t count, PackedBody* loads);
	// What the contacts miss of their law at these velocities, in place of w standing what acts on the body [m/s]: adds to the sums, and writes
	// that of each, if not null.
	void (*miss)(const Group* groups, std::size_t count, const PackedBody* moved, LaneMisses& sums, GroupMiss* each);
	// Sweeps over rows of W. Solves the contacts of the groups from .. to - 1 in turn, the others held.
	void (*sweepRows)(const RowGroups& rows, std::size_t from, std::size_t to);
	// The same from y, to which the impulses have been moved already.
	void (*sweepRowsAhead)(const RowGroups& rows, const ImpulsePairs* before, GroupStep* steps, std::size_t from, std::size_t to);
	// y = p + beta (p - before) for every group, which has a beta of its own; `before` becomes p.
	void (*extrapolateRows)(ImpulsePairs* impulses, ImpulsePairs* before, const double* beta, std::size_t count);
};

// Those this processor can run, the fastest first; the list ends with the one for any processor.
struct GroupKernels {
	const GroupKernel* first;
	std::size_t count;
	const GroupKernel* begin() const { return first; }
	const GroupKernel* end() const { return first + count; }
};
GroupKernels groupKernels();

// The one in use: the fastest unless a test or a benchmark chose another.
const GroupKernel& groupKernel();
void useGroupKernel(const GroupKernel&);

} // namespace cd
