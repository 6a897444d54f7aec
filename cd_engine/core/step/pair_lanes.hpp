// How pairs are given to the kernels (group_kernel.hpp).
#pragma once

#include "kernels/kernels.hpp"
#include "step/step_view.hpp"

namespace cd {

// Factor on mu p_n up to which the tangential part of a first guess is in the cone: what is beyond only by the round-off of dt times force and back
// must not be cut, or it would be written anew step by step.
constexpr double insideCone = 1 + 1e-9;
constexpr double pushedOut = 1e-9; // of a disk's radius: smaller overlaps are round-off and stay

// Pairs that the kernels are given at once. A vector that has been written lane by lane can be read only a while later.
constexpr std::size_t batch = 64, groupsInBatch = batch / PairLanes::lanes;

inline RowSettings rowSettings(const StepView<Plane>& step)
{
	const StepSettings<Plane>& s = step.settings;
	return { s.dt, s.gapCorrection, s.allowedOverlap, -std::max(pushedOut, s.allowedOverlap), insideCone, step.world.compliant(), s.dampingRatio,
		step.world.bodies.data() };
}

// Copies the pairs which(0) .. which(count - 1) into the lanes. Repeats the last one in lanes that are left. rows: also what rows need;
// inverseRadius: and what groups need.
template <bool rows, class Which>
inline std::size_t load(const StepView<Plane>& step, std::size_t count, PairLanes* lanes, const Which& which, const double* inverseRadius = nullptr)
{
	const std::size_t groups = (count + PairLanes::lanes - 1) / PairLanes::lanes;
	const Pair* const pairs = step.world.pairs.data();
	const Stiffness* const stiffnesses = step.world.compliant() ? step.world.stiffnesses.data() : nullptr;
	const Place* const places = step.motion.places().data();
	const BodyVelocity<Plane>* const bodies = step.bodies.data();
	for (std::size_t g = 0; g < groups; g++) {
		PairLanes& p = lanes[g];
		for (std::size_t lane = 0; lane < PairLanes::lanes; lane++) {
			const int32_t index = which(std::min(g * PairLanes::lanes + lane, count - 1));
			const Pair& pair = pairs[index];
			p.a[lane] = pair.a;
			p.b[lane] = pair.b;
			p.reference[lane] = pair.reference;
			__builtin_prefetch(&places[pair.a]);
			__builtin_prefetch(&places[pair.b]);
			if (!rows)
				continue;
			p.ends[lane] = { pair.a, pair.b };
			p.index[lane] = index;
			p.mu[lane] = pair.mu;
			if (stiffnesses) {
				p.kn[lane] = stiffnesses[index].kn;
				p.kt[lane] = stiffnesses[index].kt;
				__builtin_prefetch(step.world.bodies[pair.a].v);
				__builtin_prefetch(step.world.bodies[pair.b].v);
			}
			if (inverseRadius) {
				__builtin_prefetch(&inverseRadius[pair.a]);
				__builtin_prefetch(&inverseRadius[pair.b]);
			}
			__builtin_prefetch(&bodies[pair.a]);
			__builtin_prefetch(&bodies[pair.b]);
		}
	}
	// A loop of its own, so that the radii are already on their way from memory when they are read.
	for (std::size_t g = 0; rows && inverseRadius && g < groups; g++)
		for (std::size_t lane = 0; lane < PairLanes::lanes; lane++) {
			lanes[g].scaleA[lane] = inverseRadius[lanes[g].a[lane]];
			lanes[g].scaleB[lane] = inverseRadius[lanes[g].b[lane]];
		}
	return groups;
}

} // namespace cd
