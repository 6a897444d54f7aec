#include "kernels/group_kernel.hpp"

namespace cd {

// Inlining is forced: the vectors of a target must stay in registers, also where the optimizer would make a call.
#define INLINE static inline __attribute__((always_inline))

// The functions of a target.
#define KERNEL(name)                                                                                                                                 \
	constexpr GroupKernel<Plane> kernel = { name, sweep<Plane>, sweepAhead<Plane>, extrapolate<Plane>, addImpulses<Plane>, miss<Plane>,          \
		sweepRows, extrapolateRows, overlaps, assemble, effects, assembleGroup };                                                            \
	constexpr GroupKernel<RollingPlane> rollingKernel = { name, sweep<RollingPlane>, sweepAhead<RollingPlane>, extrapolate<RollingPlane>,        \
		addImpulses<RollingPlane>, miss<RollingPlane>, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr };                               \
	constexpr GroupKernel<Space3> spaceKernel = { name, sweep<Space3>, sweepAhead<Space3>, extrapolate<Space3>, addImpulses<Space3>,             \
		miss<Space3>, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr }

#define LANES 2
namespace any_processor {
#include "kernels/group_kernel.inl"
	KERNEL("any");
}
#undef LANES

#pragma GCC push_options
#pragma GCC target("arch=x86-64-v3")
#define LANES 4
namespace avx2 {
#include "kernels/group_kernel.inl"
	KERNEL("avx2");
}
#undef LANES
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("arch=x86-64-v4")
#define LANES 8
namespace avx512 {
#include "kernels/group_kernel.inl"
	KERNEL("avx512");
}
#undef LANES
#pragma GCC pop_options

namespace {

	const GroupKernel<Plane> all[] = {
		avx512::kernel,
		avx2::kernel,
		any_processor::kernel,
	};
	constexpr std::size_t known = sizeof all / sizeof *all;

	std::size_t firstSupported()
	{
		__builtin_cpu_init();
		return __builtin_cpu_supports("x86-64-v4") ? 0 : __builtin_cpu_supports("x86-64-v3") ? 1 : 2;
	}

	const GroupKernel<RollingPlane> withRolling[] = {
		avx512::rollingKernel,
		avx2::rollingKernel,
		any_processor::rollingKernel,
	};

	const GroupKernel<Space3> inSpace[] = {
		avx512::spaceKernel,
		avx2::spaceKernel,
		any_processor::spaceKernel,
	};

	std::size_t chosen = firstSupported();

} // namespace

template <> GroupKernels<Plane> groupKernels() { return { all + firstSupported(), known - firstSupported() }; }
template <> const GroupKernel<Plane>& groupKernel() { return all[chosen]; }
template <> const GroupKernel<RollingPlane>& groupKernel() { return withRolling[chosen]; }
template <> const GroupKernel<Space3>& groupKernel() { return inSpace[chosen]; }
template <> void useGroupKernel(const GroupKernel<Plane>& kernel) { chosen = static_cast<std::size_t>(&kernel - all); }

} // namespace cd
