// Accelerated sweeps, and where they stagnate or run out, Newton's method from their best iterate. Where that stagnates, too, Newton's method from
// the first guess.
//
// Sweeps come first and go to their end: one factorization costs as much as 300 of them or more, and most problems that they solve take a few
// hundred. Newton's method can stagnate from one start and solve from another: of twelve frozen packings with mu = 0.5 it solves ten from where
// sweeps stagnate (1e-5) and eleven from e = 1e-3. On no problem tried did sweeps gain anything from where Newton's method stagnates.
#include "solvers/solver.hpp"
#include "solvers/start.hpp"

#include <algorithm>

namespace cd {
namespace {

	// Above this number of bodies, or of contacts of a matrix problem, Newton's method is not tried: a few of its steps would take seconds.
	constexpr std::size_t large = 10000;
	// Operations that Newton's method may take from each of its starts: about 0.7 s whatever the size, 760 steps for 400 disks.
	constexpr double mostWork = 2e9;
	constexpr int mostSteps = 3000; // limit on all steps; problems that can be solved take 10 to 1000

	std::size_t size(const ContactSystem<Plane>& s) { return s.bodies.size(); }
	std::size_t size(const DelassusSystem& s) { return s.contacts(); }

	// Newton's method from the impulses in the system and, if it stagnates, from the first guess. Keeps the better result.
	template <class System> SolverReport newtonTwice(System& system, const Start& start, SolverSettings settings)
	{
		start.free(system);
		const SolverReport first = newton(system, settings);
		settings.maxIterations -= first.iterations;
		if (first.status != Status::stagnated || settings.maxIterations <= 0)
			return first;
		System anew = system;
		start.free(anew);
		start.guess(anew);
		const SolverReport second = newton(anew, settings);
		const bool better = second.error < first.error;
		if (better)
			std::swap(system, anew);
		SolverReport report = better ? second : first;
		report.iterations = first.iterations + second.iterations;
		report.factorizations = first.factorizations + second.factorizations;
		return report;
	}

	template <class System> SolverReport solve(System& system, const SolverSettings& settings)
	{
		const int most = std::min(mostSteps, settings.maxIterations / 6); // iterations left for Newton's method
		if (settings.fixedIterations > 0 || size(system) > large || most == 0)
			return accelerated(system, settings);
		std::optional<Start> own;
		const Start& start = settings.start ? *settings.start : own.emplace(system, settings.threads);
		SolverSettings part = settings;
		part.maxIterations -= most;
		const SolverReport sweeps = accelerated(system, part);
		if (sweeps.status == Status::converged || sweeps.status == Status::diverged)
			return sweeps;
		part.maxIterations = most;
		part.mostWork = mostWork;
		SolverReport report = newtonTwice(system, start, part);
		report.iterations += sweeps.iterations;
		// Newton's method ends by limits of its own. The iterations that it leaves are for plain sweeps (solver.cpp).
		if (report.status == Status::max_iterations && report.iterations < settings.maxIterations)
			report.status = Status::stagnated;
		return report;
	}

} // namespace

SolverReport automatic(ContactSystem<Plane>& system, const SolverSettings& settings) { return solve(system, settings); }
SolverReport automatic(DelassusSystem& system, const SolverSettings& settings) { return solve(system, settings); }

} // namespace cd
