// Nonlinear (block) Gauss-Seidel: contact by contact, each solved exactly with the others held (Moreau 1988; Jean 1999, section 6).
#include "residual.hpp"
#include "solver.hpp"
#include "sweep.hpp"

#include <algorithm>
#include <cmath>

namespace cd {

SolverReport nsgs(ContactSystem& system, const SolverSettings& settings)
{
	std::vector<double> freeVelocity(3 * system.bodies.size());
	for (size_t i = 0; i < system.bodies.size(); i++)
		std::copy_n(system.bodies[i].v, 3, &freeVelocity[3 * i]);

	SolverReport report;
	const auto evaluate = [&] {
		const Residual e = residual(system, freeVelocity);
		report.residual = e.norm;
		report.residualMax = e.maximum;
	};
	Sweep sweep(system, freeVelocity, settings.seed);

	if (settings.fixedIterations > 0) {
		for (; report.iterations < settings.fixedIterations; report.iterations++)
			sweep();
		sweep.restoreVelocities(freeVelocity);
		evaluate();
		report.status = std::isfinite(report.residual) ? Status::fixed_iterations : Status::diverged;
		return report;
	}

	// The error costs two sweeps, so it is asked for at a spacing that grows with the sweeps already made.
	evaluate();
	double best = report.residual;
	int bestAt = 0;
	while (report.residual > settings.tolerance && report.iterations < settings.maxIterations) {
		const int more = std::min(settings.maxIterations - report.iterations, 4 + report.iterations / 10);
		for (int i = 0; i < more; i++)
			sweep();
		report.iterations += more;
		sweep.storeImpulses();
		evaluate();
		if (std::isnan(report.residual))
			break;
		if (report.residual < 0.99 * best) {
			best = report.residual;
			bestAt = report.iterations;
		}
		// No gain of a hundredth while the number of sweeps doubled, and at least a thousand: waiting on is in vain.
		else if (report.iterations > 1000 + 2 * bestAt)
			break;
	}
	sweep.restoreVelocities(freeVelocity);
	report.status = std::isnan(report.residual)	  ? Status::diverged
	    : report.residual <= settings.tolerance	  ? Status::converged
	    : report.iterations >= settings.maxIterations ? Status::max_iterations
							  : Status::stagnated;
	return report;
}

} // namespace cd
