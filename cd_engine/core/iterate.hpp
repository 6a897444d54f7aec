// The loop around sweeps that every sweeping method shares: when to ask for the error, when to stop, what to report.
#pragma once

#include "handed_on.hpp"
#include "solver.hpp"

#include <algorithm>
#include <cmath>
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
		kept.values.resize(1);
	}

	// improve() makes one sweep of the method.
	template <class Improve> SolverReport run(Improve& improve)
	{
		if (settings.fixedIterations > 0) {
			for (; report.iterations < settings.fixedIterations; report.iterations++)
				sweep();
			report.status = Status::fixed_iterations;
		} else {
			begin();
			advance(improve, settings.maxIterations, settings.maxIterations);
		}
		return conclude();
	}

	void begin()
	{
		evaluate();
		reached = error;
		keep();
	}

	// Goes on until it has ended, or at the first look at the error after `until` sweeps. Never more than `most`. Whether it has ended.
	template <class Improve> bool advance(Improve& improve, int until, int most)
	{
		while (error > settings.tolerance) {
			if (report.iterations >= most)
				return giveBest(Status::max_iterations);
			// No gain of a hundredth while the number of sweeps doubled and three thousand more were made, which outlasts most drifts
			// (see accelerated.cpp): waiting on is in vain.
			const int inVain = 3000 + 2 * reachedAt;
			if (report.iterations >= inVain)
				return giveBest(Status::stagnated);
			if (report.iterations >= until)
				return false;
			const int more = std::min({ most - report.iterations, inVain - report.iterations, untilNext() });
			for (int i = 0; i < more; i++)
				improve();
			report.iterations += more;
			evaluate();
			// Where impulses fall to next to nothing, so does what their error is relative to.
			if (error < best.error || (distance < best.distance && impulse < best.impulse))
				keep();
			clearRoundOff();
			if (error < 0.99 * reached) {
				reached = error;
				reachedAt = report.iterations;
			}
		}
		if (std::isnan(error))
			return giveBest(Status::diverged);
		report.status = Status::converged;
		return true;
	}

	SolverReport conclude()
	{
		sweep.restoreVelocities();
		sweep.store();
		if (report.status != Status::converged) // else the error is known: no impulse has changed since it was asked for
			evaluate();
		if (std::isnan(report.error)) // or an impulse that is not a number
			report.status = Status::diverged;
		return report;
	}

	int iterations() const { return report.iterations; }
	bool solved() const { return error <= settings.tolerance; }
	double least() const { return reached; } // error, to a hundredth
	int idle() const { return report.iterations - reachedAt; } // sweeps since that fell

    private:
	// Sweeps before the error is asked for again, which costs five: as many as the fall since it was last asked for would need to reach the
	// tolerance, at least four, at most a quarter of those already made, and of many made the number at which asking costs half of what is made
	// in vain on average, sqrt(2 x 5 x made): with momentum the error rises and falls on its way.
	int untilNext()
	{
		const double fall = std::log(lastError / error) / std::max(1, report.iterations - lastIterations);
		const double needed = fall > 0 ? std::log(error / settings.tolerance) / fall : std::numeric_limits<double>::infinity();
		lastError = error;
		lastIterations = report.iterations;
		// needed last: from an infinite error to a tolerance of 0 it is not a number, and is passed over.
		return 4 + static_cast<int>(std::min({ 0.25 * report.iterations, std::sqrt(10. * report.iterations), needed }));
	}

	// Bodies that were stopped and have nothing to carry any more: sweeps take the impulses of the step before back from the velocities, and
	// their round-off may be all that is left to solve.
	void clearRoundOff()
	{
		if (impulse < 1e-3 * largest) {
			sweep.restoreVelocities();
			largest = impulse;
		}
	}

	void keep()
	{
		best = { error, distance, impulse };
		sweep.copyTo(bestIterate());
	}

	// With momentum the last iterate may be far from the best.
	bool giveBest(Status status)
	{
		report.status = status;
		sweep.copyFrom(bestIterate());
		return true;
	}

	void evaluate()
	{
		const Residual e = sweep.error();
		report.measure(e);
		error = report.error;
		impulse = e.impulse;
		largest = std::max(largest, impulse);
		distance = impulse > 0 ? e.law() * impulse : e.difference;
	}

	S& sweep;
	const SolverSettings& settings;
	SolverReport report;
	double error = 0; // what is held against the tolerance
	double distance = 0; // the error of the contacts without being relative [N s]
	double impulse = 0, largest = 0; // |p| now, and the largest since velocities were last made from impulses [N s]
	double reached = 0; // the least error met
	int reachedAt = 0; // sweeps
	double lastError = 0; // when it was asked for before, after so many sweeps
	int lastIterations = 0;
	struct {
		double error, distance, impulse;
	} best {}; // iterate so far
	typename S::Iterate& bestIterate() { return kept.values.front(); }
	HandedOn<typename S::Iterate, Iteration> kept;
};

// `method(sweep)` gives an object whose () makes one sweep; after each call the sweep's impulses are the iterate.
// Stops when the errors of residual.hpp are at most settings.tolerance, at settings.maxIterations sweeps, or when nothing is gained
// any more; what has not been solved returns the best iterate met. With settings.fixedIterations it makes
// exactly so many plain sweeps, whatever the method, and asks for the error at the end: what is known of under-converged contact dynamics (Unger &
// Kertesz 2003) holds for plain Gauss-Seidel.
template <class S, class Method> SolverReport iterate(typename S::System& system, const SolverSettings& settings, const Method& method)
{
	S sweep(system, settings.seed, settings.threads);
	auto improve = method(sweep);
	return Iteration<S>(sweep, settings).run(improve);
}

} // namespace cd
