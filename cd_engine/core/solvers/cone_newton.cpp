// Problems in space: sweeps with momentum and proximal-point Newton in turn.
//
// Sweeps bring forces through chains of spheres, but blocks, capsules and rocks have several contacts a pair: then sweeps need 1e5 iterations, and a
// factorization, of the contacts that carry something, finds the shares at once (of W with sigma, the rigid one is singular). A hundred sweeps first
// tell which contacts these are. Where Newton's method stagnates, twice as many sweeps follow as before, then it begins anew.
// The two ways of Newton's method, to move the centre and to hold it, are those of newton.cpp; cone_proximal.hpp is one of its problems.
// "newton" makes one round of this, "auto" seven, and where these fail, seven again from the first guess, with sweeps in a random order. What has
// several solutions, or nearly so, as blocks with much friction, is often solved from one start and not from another.
#include "matrix/matrix.hpp"
#include "newton/newton.hpp"
#include "solvers/iterate.hpp"
#include "solvers/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd {
namespace {

	// As in cone_proximal.cpp: none is critical.
	constexpr int sweepsAtStart = 100;
	constexpr int rounds = 7; // from one start: some 10 000 sweeps
	constexpr int factorizationsAtStart = 200; // limits of the first round; both double from round to round
	constexpr double sigmaAtStart = 0.1, least = 1e-9, largest = 10;
	constexpr double fall = 0.1, rise = 4; // factors on sigma, from one proximal problem to the next
	constexpr double steepest = 0.05, flattest = 0.85; // while the centre stays
	constexpr int fewSteps = 6; // Newton steps up to which a proximal problem counts as easy
	constexpr int patience = 6; // proximal problems in which the error must halve
	// Above so many contacts, those of some 1000 blocks, a factorization takes seconds: only sweeps are made.
	constexpr std::size_t large = 5000;
	constexpr double mostWork = 4e9; // floating-point operations of a round

	class ConeNewton {
	    public:
		ConeNewton(ConeSystem& s, const SolverSettings& t)
		    : system(s)
		    , settings(t)
		    , problem(s, t.maxIterations, std::min(t.mostWork, mostWork))
		    , best(s.p)
		    , bestError(residual(s).error())
		{
		}

		SolverReport run()
		{
			double before;
			do {
				before = bestError;
				moveCentre();
				holdCentre();
			} while (unsolved() && bestError < 0.9 * before);
			system.p = best;
			SolverReport report;
			report.iterations = report.factorizations = problem.steps();
			report.measure(residual(system));
			report.status = report.error <= settings.tolerance ? Status::converged : Status::stagnated;
			return report;
		}

	    private:
		bool unsolved() const { return bestError > settings.tolerance && !problem.exhausted(); }

		bool attempt(const std::vector<Triple>& centre, const std::vector<Triple>& first, double sigma)
		{
			const int before = problem.steps();
			const bool solved = problem.solve(centre, first, sigma);
			system.p = problem.impulses();
			const Residual e = residual(system);
			const double error = std::isfinite(e.impulse) ? e.error() : std::numeric_limits<double>::infinity();
			if (settings.trace) {
				settings.trace->add(problem.steps() - before);
				settings.trace->evaluated(error);
			}
			if (error < bestError) {
				bestError = error;
				best = system.p;
			}
			return solved && std::isfinite(error);
		}

		void moveCentre()
		{
			std::vector<Triple> centre = best;
			double sigma = sigmaAtStart, mark = bestError;
			for (int idle = 0; unsolved() && idle < patience;) {
				const bool solved = attempt(centre, centre, sigma);
				centre = solved ? system.p : best;
				sigma = solved ? std::max(least, fall * sigma) : std::min(largest, rise * sigma);
				idle++;
				if (bestError < 0.5 * mark) {
					mark = bestError;
					idle = 0;
				}
			}
		}

		void holdCentre()
		{
			const std::vector<Triple> centre = best;
			std::vector<Triple> last = best;
			double sigma = sigmaAtStart, solvedSigma = 0, factor = 0.3;
			while (unsolved() && sigma < largest && sigma > least) {
				const int before = problem.steps();
				const bool solved = attempt(centre, last, sigma);
				if (!solved && solvedSigma == 0) {
					sigma *= rise;
					continue;
				}
				if (solved) {
					solvedSigma = sigma;
					last = problem.impulses();
				} else if (factor > flattest)
					return;
				factor = solved && problem.steps() - before <= fewSteps ? std::max(steepest, factor * factor) : std::sqrt(factor);
				sigma = factor * solvedSigma;
			}
		}

		ConeSystem& system;
		const SolverSettings& settings;
		ConeProximal problem;
		std::vector<Triple> best;
		double bestError;
	};

	struct Momentum : PlainSweeps<ConeSweep> {
		void operator()() { sweep.ahead(); }
	};

	// Whether more iterations may help.
	bool unsolved(const SolverReport& report, const SolverSettings& settings)
	{
		return report.status != Status::converged && report.status != Status::diverged && report.iterations < settings.maxIterations;
	}

	SolverReport inTurn(ConeSystem& system, const SolverSettings& settings, int most)
	{
		ConeSweep sweep(system, settings.seed);
		Momentum improve { { sweep } };
		SolverReport all;
		int sweeps = 1, factorizations = factorizationsAtStart; // one sweep solves what does not collide
		for (int round = 0;; round++) {
			SolverSettings part = settings;
			const auto limit = [&](int most) { part.maxIterations = std::min(most, settings.maxIterations - all.iterations); };
			const auto add = [&](SolverReport report) {
				report.iterations += all.iterations;
				report.factorizations += all.factorizations;
				all = report;
				return !unsolved(all, settings);
			};
			limit(sweeps);
			if (add(Iteration<ConeSweep>(sweep, part).run(improve)))
				break;
			if (round > 0) {
				limit(factorizations);
				if (add(ConeNewton(system, part).run()))
					break;
				factorizations *= 2;
			}
			if (round == most)
				break;
			sweeps = std::max(sweepsAtStart, 2 * sweeps);
		}
		if (all.status == Status::max_iterations && all.iterations < settings.maxIterations)
			all.status = Status::stagnated;
		return all;
	}

} // namespace

SolverReport newton(ConeSystem& system, const SolverSettings& settings)
{
	return settings.fixedIterations > 0 || system.contacts() > large ? accelerated(system, settings) : inTurn(system, settings, 1);
}

SolverReport automatic(ConeSystem& system, const SolverSettings& settings)
{
	if (settings.fixedIterations > 0 || system.contacts() > large)
		return accelerated(system, settings);
	const std::vector<Triple> guess = system.p;
	SolverSettings part = settings;
	SolverReport report = inTurn(system, part, rounds);
	while (unsolved(report, settings)) {
		const SolverReport before = report;
		std::vector<Triple> best = guess;
		std::swap(best, system.p);
		part.seed++;
		part.maxIterations = settings.maxIterations - before.iterations;
		report = inTurn(system, part, rounds);
		const SolverReport last = report;
		if (before.error < report.error) {
			system.p = best;
			report = before;
		}
		report.iterations = before.iterations + last.iterations;
		report.factorizations = before.factorizations + last.factorizations;
	}
	return report;
}

} // namespace cd
