#include "group_kernel.hpp"

namespace cd {

// Inlining is forced: the vectors of a target must stay in registers, also where the optimizer would make a call.
#define INLINE static inline __attribute__((always_inline))

#define LANES 2
namespace any_processor {
#include "group_kernel.inl"
#include "row_kernel.inl"
#include "pair_kernel.inl"
}
#undef LANES

#ifdef __x86_64__
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v3")
#define LANES 4
namespace avx2 {
#include "group_kernel.inl"
#include "row_kernel.inl"
#include "pair_kernel.inl"
}
#undef LANES
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("arch=x86-64-v4")
#define LANES 8
namespace avx512 {
#include "group_kernel.inl"
#include "row_kernel.inl"
#include "pair_kernel.inl"
}
#undef LANES
#pragma GCC pop_options
#endif

namespace {

	const GroupKernel all[] = {
#ifdef __x86_64__
		{ "avx512", 8, avx512::sweep, avx512::sweepAhead, avx512::extrapolate, avx512::press, avx512::miss, avx512::sweepRows,
		    avx512::sweepRowsAhead, avx512::extrapolateRows, avx512::overlaps, avx512::assemble, avx512::effects, avx512::assembleGroup },
		{ "avx2", 4, avx2::sweep, avx2::sweepAhead, avx2::extrapolate, avx2::press, avx2::miss, avx2::sweepRows, avx2::sweepRowsAhead,
		    avx2::extrapolateRows, avx2::overlaps, avx2::assemble, avx2::effects, avx2::assembleGroup },
#endif
		{ "any", 2, any_processor::sweep, any_processor::sweepAhead, any_processor::extrapolate, any_processor::press, any_processor::miss,
		    any_processor::sweepRows, any_processor::sweepRowsAhead, any_processor::extrapolateRows, any_processor::overlaps,
		    any_processor::assemble, any_processor::effects, any_processor::assembleGroup },
	};
	constexpr std::size_t known = sizeof all / sizeof *all;

	std::size_t firstSupported()
	{
#ifdef __x86_64__
		__builtin_cpu_init();
		return __builtin_cpu_supports("x86-64-v4") ? 0 : __builtin_cpu_supports("x86-64-v3") ? 1 : 2;
#else
		return 0;
#endif
	}

	const GroupKernel* chosen = all + firstSupported();

} // namespace

GroupKernels groupKernels() { return { all + firstSupported(), known - firstSupported() }; }
const GroupKernel& groupKernel() { return *chosen; }
void useGroupKernel(const GroupKernel& kernel) { chosen = &kernel; }

} // namespace cd
