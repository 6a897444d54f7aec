// The loop around sweeps that every sweeping method shares: when to ask for the error, when to stop, what to report.
#pragma once

#include "solver.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace cd {

// S: Sweep or DelassusSweep, the two forms a problem can have.
template <class S> class Iteration {
    public:
	Iteration(S& s, const SolverSettings& t)
	    : sweep(s)
	    , settings(t)
	{
	}

	// improve() makes one sweep of the method.
	SolverReport run(const std::function<void()>& improve)
	{
		if (settings.fixedIterations > 0) {
			for (; report.iterations < settings.fixedIterations; report.iterations++)
				sweep();
			report.status = Status::fixed_iterations;
		} else
			report.status = untilSolved(improve);
		sweep.restoreVelocities();
		evaluate();
		if (std::isnan(report.residual))
			report.status = Status::diverged;
		return report;
	}

    private:
	Status untilSolved(const std::function<void()>& improve)
	{
		evaluate();
		double best = error, smallest = error;
		int bestAt = 0;
		keep();
		while (error > settings.tolerance) {
			if (report.iterations >= settings.maxIterations)
				return giveBest(Status::max_iterations);
			// No gain of a hundredth while the number of sweeps doubled, and at least a thousand: waiting on is in vain.
			const int inVain = 1000 + 2 * bestAt;
			if (report.iterations >= inVain)
				return giveBest(Status::stagnated);
			const int more = std::min({ settings.maxIterations - report.iterations, inVain - report.iterations, untilNext() });
			for (int i = 0; i < more; i++)
				improve();
			report.iterations += more;
			sweep.storeImpulses();
			evaluate();
			if (error < smallest) {
				smallest = error;
				keep();
			}
			if (error < 0.99 * best) {
				best = error;
				bestAt = report.iterations;
			}
		}
		return std::isnan(error) ? giveBest(Status::diverged) : Status::converged;
	}

	// Sweeps before the error is asked for again, which costs five: as many as the fall since it was last asked for would need to reach the
	// tolerance, at least four and at most a quarter of those already made.
	int untilNext()
	{
		const double fall = std::log(lastError / error) / std::max(1, report.iterations - lastIterations);
		const double needed = fall > 0 ? std::log(error / settings.tolerance) / fall : std::numeric_limits<double>::infinity();
		lastError = error;
		lastIterations = report.iterations;
		return 4 + static_cast<int>(std::min(needed, 0.25 * report.iterations));
	}

	void keep()
	{
		bestImpulses.resize(2 * sweep.size());
		sweep.forEachImpulse([&](double pn, double pt, std::size_t i) {
			bestImpulses[2 * i] = pn;
			bestImpulses[2 * i + 1] = pt;
		});
	}

	// With momentum the last iterate may be far from the best.
	Status giveBest(Status status)
	{
		sweep.forEachImpulse([&](double& pn, double& pt, std::size_t i) {
			pn = bestImpulses[2 * i];
			pt = bestImpulses[2 * i + 1];
		});
		return status;
	}

	void evaluate()
	{
		const Residual e = sweep.error();
		report.residual = e.norm;
		report.residualMax = e.maximum;
		report.error = error = std::max(e.norm, e.energy);
	}

	S& sweep;
	const SolverSettings& settings;
	SolverReport report;
	double error = 0; // what is held against the tolerance
	double lastError = 0; // when it was asked for before, after so many sweeps
	int lastIterations = 0;
	std::vector<double> bestImpulses; // of the iterate with the smallest error
};

// `method(sweep)` gives a function that makes one sweep; after each call the sweep's impulses are the iterate.
// Stops when the error e, and the same weighted by W_nn, are at most settings.tolerance, at settings.maxIterations sweeps, or when nothing is gained
// any more; what has not been solved returns the best iterate met. With settings.fixedIterations it makes exactly so many plain sweeps, whatever
// the method, and asks for the error at the end: what is known of under-converged contact dynamics (Unger & Kertesz 2003) holds for plain
// Gauss-Seidel.
template <class S, class Method> SolverReport iterate(typename S::System& system, const SolverSettings& settings, const Method& method)
{
	S sweep(system, settings.seed);
	return Iteration<S>(sweep, settings).run(method(sweep));
}

} // namespace cd
