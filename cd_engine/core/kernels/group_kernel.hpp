// The inner loops of a sweep, compiled once for each kind of processor. All versions give the same bits.
#pragma once

#include "problem/problem.hpp"
#include "kernels/group_in_space.hpp"
#include "kernels/group_rolling.hpp"

#include <cstddef>

namespace cd {

// The members of AheadReport, summed lane by lane.
struct alignas(64) LaneSums {
	double change[lanes], against[lanes];
};

// How far the contacts miss the contact law, summed lane by lane: members of ResidualSum.
struct alignas(64) LaneMisses {
	double difference[lanes], square[lanes], differenceEnergy[lanes], squareEnergy[lanes];
	double missed[lanes], worst[lanes], mostMissed[lanes], stale[lanes];
};

// Eight pairs.
struct alignas(64) PairLanes {
	static constexpr int lanes = 8;
	struct Ends {
		int32_t a, b;
	};
	double mu[lanes], reference[lanes];
	double kn[lanes], kt[lanes]; // only if contacts have a stiffness
	double scaleA[lanes], scaleB[lanes]; // 1/k of the bodies, for groups
	double overlap[lanes], gap[lanes]; // as in Touch, and beyond the reference overlap [m]
	double beyond[lanes]; // how far the gap is beyond `nearby` radii [m]; infinite: `a` is no disk, so nothing is known
	Ends ends[lanes];
	int32_t a[lanes], b[lanes]; // the same
	int32_t index[lanes]; // in World::carried
};
// What impulses on eight contacts between disks do.
struct alignas(64) PairEffects {
	static constexpr int lanes = PairLanes::lanes;
	double nx[lanes], ny[lanes];
	double work[lanes]; // [J]
	double stored[lanes], before[lanes], absorbed[lanes], dashpots[lanes]; // of springs (SpringEnergies), if there are any
};
struct RowSettings {
	double dt, gapCorrection, allowedOverlap;
	double pushedOut; // gap from which an overlap is pushed out, in radii
	double coneFactor; // factor on mu p_n up to which a first guess is in the cone
	// Of contacts with stiffness:
	bool compliant;
	double dampingRatio;
	const Body* before; // the bodies before the step
};

template <class Space> struct GroupKernel {
	using PackedBody = PackedBodyIn<Space>;
	using Group = cd::Group<Space>;
	using GroupSprings = cd::GroupSprings<Space>;
	using GroupBefore = cd::GroupBefore<Space>;

	const char* name;
	// Solves the contacts of groups[0 .. count) in turn, while the others are held. springs: of the groups; null: the contacts are rigid.
	void (*sweep)(Group* groups, const GroupSprings* springs, std::size_t count, PackedBody* bodies);
	// The same from y = p + beta (p - before); `before` becomes p. The bodies must already have the velocities of y. Adds to the sums.
	void (*sweepAhead)(
	    Group* groups, const GroupSprings* springs, GroupBefore* before, std::size_t count, PackedBody* bodies, double beta, LaneSums& sums);
	// Replaces every velocity v by v + beta (v - before); `before` becomes v.
	void (*extrapolate)(PackedBody* bodies, PackedBody* before, std::size_t count, double beta);
	// Adds to every body the impulses of its contacts, their moments over k, and, in the member w, the magnitudes |p_n| + (1 + arm^2)|p_t|.
	void (*addImpulses)(const Group* groups, std::size_t count, PackedBody* loads);
	// Measures how far the contacts miss the contact law at these velocities. The member w of `moved` holds what acts on the body [m/s]. Adds to
	// the sums, and writes the values of each contact to `each` if it is not null.
	void (*miss)(const Group* groups, const GroupSprings* springs, std::size_t count, const PackedBody* moved, LaneMisses& sums, GroupMiss* each);
	// From here on for the plane without rolling resistance only, null elsewhere.
	// For sweeps over rows of W: solves the contacts of the groups from .. to - 1 in turn, while the others are held. Where `before` is not null,
	// the impulses must already have the values of y, and `steps` gets the results.
	void (*sweepRows)(const RowGroups& rows, const ImpulsePairs* before, AheadReport* steps, std::size_t from, std::size_t to);
	// Replaces the impulses p of every group by y = p + beta (p - before), with a beta for each group; `before` becomes p.
	void (*extrapolateRows)(ImpulsePairs* impulses, ImpulsePairs* before, const double* beta, std::size_t count);
	// Where the disks of `count` times eight pairs touch.
	void (*overlaps)(const Place* places, PairLanes* pairs, std::size_t count, double nearby);
	// The rows of `count` pairs, which begin in the first lane; wnn = 0 where `a` is no disk, or a body cannot turn or can hardly move.
	void (*assemble)(const Place* places, const BodyVelocityIn<Space>* bodies, const Carried* carried, const PairLanes* pairs,
	    ContactRow<Space>* rows, std::size_t count, const RowSettings& settings);
	// What `count` impulses p do.
	void (*effects)(const Place* places, const Mean* means, const BodyVelocityIn<Space>* bodies, const Carried* carried,
	    const ImpulseOf<Space>* p, std::size_t count, const PairLanes* pairs, PairEffects* effects, std::size_t groups,
	    const RowSettings& settings);
	// The contacts of eight pairs as a group, and its springs if they have a stiffness. Returns the lanes, a bit each, where wnn would be 0.
	unsigned (*assembleGroup)(const Place* places, const BodyVelocityIn<Space>* bodies, const Carried* carried, const PairLanes& pairs,
	    Group& group, GroupSprings* springs, const RowSettings& settings);
};

// The kernels that this processor can run, the fastest first. The last one runs on any processor.
template <class Space> struct GroupKernels {
	const GroupKernel<Space>* first;
	std::size_t count;
	const GroupKernel<Space>* begin() const { return first; }
	const GroupKernel<Space>* end() const { return first + count; }
};
template <class Space> GroupKernels<Space> groupKernels();

// The kernel in use: the fastest, unless a test or a benchmark has chosen another.
template <class Space> const GroupKernel<Space>& groupKernel();
template <class Space> void useGroupKernel(const GroupKernel<Space>&);

template <> GroupKernels<Plane> groupKernels();
template <> const GroupKernel<Plane>& groupKernel();
template <> const GroupKernel<RollingPlane>& groupKernel();
template <> const GroupKernel<Space3>& groupKernel();
template <> void useGroupKernel(const GroupKernel<Plane>&); // elsewhere, too; one of groupKernels()

} // namespace cd
