// Nonlinear (block) Gauss-Seidel: solves contact by contact, each exactly while the others are held (Moreau 1988; Jean 1999, section 6). This is the
// reference method. It converges linearly and needs about sqrt(N) sweeps or more to carry a force through N disks.
#include "delassus_sweep.hpp"
#include "iterate.hpp"
#include "sweep.hpp"

namespace cd {
namespace {

	template <class S> SolverReport solve(typename S::System& system, const SolverSettings& settings)
	{
		return iterate<S>(system, settings, [](S& sweep) { return [&sweep] { sweep(); }; });
	}

} // namespace

SolverReport nsgs(ContactSystem& system, const SolverSettings& settings) { return solve<Sweep>(system, settings); }
SolverReport nsgs(DelassusSystem& system, const SolverSettings& settings) { return solve<DelassusSweep>(system, settings); }

} // namespace cd
