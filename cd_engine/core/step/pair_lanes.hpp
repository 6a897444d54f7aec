// How pairs are given to the kernels (group_kernel.hpp).
#pragma once

#include "kernels/kernels.hpp"
#include "step/step_view.hpp"

namespace cd {

// Pairs that the kernels are given at once. A vector that has been written lane by lane can be read only a while later.
constexpr std::size_t batch = 64, groupsInBatch = batch / PairLanes::lanes;

// Copies the pairs which(0) .. which(count - 1) into the lanes. Repeats the last one in lanes that are left. rows: also what rows need;
// inverseRadius: and what groups need.
template <bool rows, class Which>
inline std::size_t load(const StepView<Plane>& step, std::size_t count, PairLanes* lanes, const Which& which, const double* inverseRadius = nullptr)
{
	const std::size_t groups = (count + PairLanes::lanes - 1) / PairLanes::lanes;
	const Pair* const pairs = step.world.pairs.data();
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
