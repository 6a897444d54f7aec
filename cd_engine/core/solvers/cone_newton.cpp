// Proximal-point Newton in space: direct solutions of small problems at which sweeps are slow, such as blocks, capsules and rocks.
#include "matrix/matrix.hpp"
#include "newton/newton.hpp"
#include "solvers/iterate.hpp"
#include "solvers/solver.hpp"
#include <cstdlib>
#include <cstdio>

namespace cd {
namespace {
	double knob(const char* n, double d)
	{
		const char* e = getenv(n);
		return e ? atof(e) : d;
	}
	const double sigmaAtStart = knob("SIG0", 0.1), fall = knob("FALL", 0.1), rise = knob("RISE", 4), least = 1e-9;
	const int patience = (int)knob("PAT", 6);
	const bool say = getenv("SAY");
} // namespace

static SolverReport proximalNewton(ConeSystem& system, const SolverSettings& settings)
{
	ConeProximal problem(system, settings.maxIterations, settings.mostWork);
	std::vector<Triple> best = system.p, centre = system.p;
	Residual e = residual(system);
	double bestError = e.error(), sigma = sigmaAtStart, mark = bestError;
	for (int idle = 0; bestError > settings.tolerance && !problem.exhausted() && idle < patience;) {
		const int before = problem.steps();
		const bool solved = problem.solve(centre, centre, sigma);
		system.p = problem.impulses();
		e = residual(system);
		if (say)
			fprintf(stderr, "  sigma %.1e %s %d steps e %.3e best %.3e\n", sigma, solved ? "ok" : "--", problem.steps() - before,
			    e.error(), bestError);
		if (settings.trace) {
			settings.trace->add(problem.steps() - before);
			settings.trace->look(e.error());
		}
		if (e.error() < bestError) {
			bestError = e.error();
			best = system.p;
		}
		centre = solved ? system.p : best;
		sigma = solved ? std::max(least, sigma * fall) : sigma * rise;
		idle++;
		if (bestError < 0.5 * mark) {
			mark = bestError;
			idle = 0;
		}
	}
	system.p = best;
	SolverReport report;
	report.iterations = report.factorizations = problem.steps();
	report.measure(residual(system));
	report.status = report.error <= settings.tolerance ? Status::converged : problem.exhausted() ? Status::max_iterations : Status::stagnated;
	return report;
}

// Sweeps first.
static SolverReport alternate(ConeSystem& system, const SolverSettings& settings, bool repeats)
{
	if (settings.fixedIterations > 0)
		return accelerated(system, settings);
	ConeSweep sweep(system, settings.seed);
	struct Momentum : PlainSweeps<ConeSweep> {
		void operator()() { sweep.ahead(); }
	} improve { { sweep } };
	SolverSettings part = settings;
	SolverReport report;
	int made = 0, factorizations = 0;
	static const int first = (int)knob("SW", 200);
	for (int sweeps = first;; sweeps *= 2) {
		Iteration<ConeSweep> iteration(sweep, part);
		part.maxIterations = std::min(sweeps, settings.maxIterations - made);
		report = iteration.run(improve);
		if (say) fprintf(stderr, "%d sweeps: %.3e\n", report.iterations, report.error);
		made += report.iterations;
		if (report.error > settings.tolerance && made < settings.maxIterations) {
			part.maxIterations = settings.maxIterations - made;
			report = proximalNewton(system, part);
			made += report.iterations;
			factorizations += report.factorizations;
		}
		report.iterations = made;
		report.factorizations = factorizations;
		if (report.error <= settings.tolerance || report.status == Status::diverged || made >= settings.maxIterations || !repeats || sweeps > 100000)
			return report;
	}
}

SolverReport newton(ConeSystem& system, const SolverSettings& settings) { return alternate(system, settings, false); }
SolverReport automatic(ConeSystem& system, const SolverSettings& settings) { return alternate(system, settings, true); }

} // namespace cd
