// Spheres: sweeps with momentum over the bodies, and where they take long, proximal-point Newton over the matrix, in turn.
//
// A packing that comes to rest has many contacts about to slide, since its friction is that with which it has formed. There the impulses of sweeps
// wander along self-stresses for 1e5 sweeps and more, at errors of 1e-5 to 3e-4: friction is no gradient. Where some 750 contacts (325 spheres) do
// so, Newton's method mostly ends this in a few steps: of nine problems that up to 20 000 sweeps do not solve to 1e-4, it solves eight from where
// they stand, six of them in 1 to 15 factorizations. 250 spheres that fall into a box (610 contacts) then take 160 sweeps a step instead of 220,
// 0.84 times the time, and no step of 1000 misses its tolerance instead of one. With more contacts Newton's method often fails, too: 430 spheres
// (1060 contacts) took 3 times as long for as many misses, 1000 spheres 2.2 times as long for 12 misses in 1500 steps instead of 33. A
// factorization of 750 contacts takes as long as some 700 sweeps, of 2400 contacts 5000. What is not solved goes on with twice
// as many sweeps, from the best impulses.
#include "solvers/cone_newton.hpp"
#include "solvers/start.hpp"

#include <algorithm>

namespace cd {
namespace {

	constexpr int sweepsAtStart = 3000;
	// Above these it does not pay (see above). A body that many others touch couples each of their contacts with all others.
	constexpr std::size_t mostContacts = 800, mostBlocks = 20 * mostContacts;
	constexpr double mostWork = 5e8; // floating-point operations of a turn of Newton's method: about 0.2 s
	constexpr int mostFactorizations = 15; // of a turn: where they do not help, they cost as much as the sweeps
	constexpr double sharper = 0.1; // factor on the error asked of the contacts where that of the bodies, which only sweeps see, is too large

} // namespace

SolverReport automatic(ContactSystem<Space3>& system, const SolverSettings& settings)
{
	if (settings.fixedIterations > 0 || system.contacts.size() > mostContacts || ConeOfSpheres::blocksOf(system) > mostBlocks)
		return accelerated(system, settings);
	std::optional<Start> own;
	const Start& start = settings.start ? *settings.start : own.emplace(system, settings.threads);
	SolverSettings sweeps = settings, factorizations = settings;
	SolverReport all;
	for (int turn = 1;; turn *= 2) {
		sweeps.maxIterations = std::min(turn * sweepsAtStart, settings.maxIterations - all.iterations);
		SolverReport report = accelerated(system, sweeps);
		report.iterations += all.iterations;
		report.factorizations = all.factorizations;
		all = report;
		const bool solved = all.status == Status::converged || all.status == Status::diverged;
		if (solved || all.iterations >= settings.maxIterations)
			return all;
		start.free(system);
		ConeOfSpheres spheres(system);
		factorizations.maxIterations = std::min(mostFactorizations, settings.maxIterations - all.iterations);
		factorizations.mostWork = mostWork;
		factorizations.tolerance
		    = all.residual > settings.tolerance ? settings.tolerance : sharper * all.residual * settings.tolerance / all.error;
		const SolverReport found = newtonAlone(spheres.matrix, factorizations);
		spheres.giveBack(system);
		all.iterations += found.iterations;
		all.factorizations += found.factorizations;
	}
}

} // namespace cd
