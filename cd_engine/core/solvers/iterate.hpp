// The loop around the sweeps of every sweeping method: when to compute the error, when to stop, what to report.
#pragma once

#include "solvers/solver.hpp"
#include "base/base.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <type_traits>

namespace cd {

// A method: operator() makes a sweep of it. mayPause: whether plain sweeps may follow; restart: some have, and it forgets its momentum. This one
// has none.
template <class S> struct PlainSweeps {
	S& sweep;
	void operator()() { sweep(); }
	void restart() { }
	bool mayPause() const { return false; }
};

// S: Sweep or DelassusSweep, for the two forms that a problem can have.
template <class S> class Iteration {
    public:
	Iteration(S& s, const SolverSettings& t)
	    : sweep(s)
	    , settings(t)
	    , bestIterate(s.memory())
	{
		assert(settings.tolerance >= 0 && settings.fixedIterations >= 0);
	}

	template <class Improve> SolverReport run(Improve& improve)
	{
		if (settings.fixedIterations > 0) {
			for (; report.iterations < settings.fixedIterations; report.iterations++)
				sweep();
			if (settings.trace)
				settings.trace->add(report.iterations);
			report.status = Status::fixed_iterations;
		} else {
			begin();
			advance(improve, settings.maxIterations, settings.maxIterations);
		}
		return conclude();
	}

	// A first guess with a stale impulse is none, however small the impulse: the next steps would begin with it again, and what errors of one
	// sign give to a body grows from step to step.
	void begin()
	{
		if (evaluate().stale && solved() && settings.maxIterations > 0) {
			sweep();
			report.iterations++;
			evaluate(1);
		}
		reached = error;
		cycles = flows = inFlows && error > poor && impulse > 0 && settings.tolerance >= coarse && settings.tolerance < poor;
		if (!solved())
			keep();
	}

	// Sweeps until the method ends or the first evaluation of the error after `until` sweeps, but at most to `most`. Returns whether it ended.
	template <class Improve> bool advance(Improve& improve, int until, int most)
	{
		while (error > settings.tolerance) {
			if (report.iterations >= most)
				return giveBest(Status::max_iterations);
			// The error has not fallen by 1 % while the number of sweeps doubled and 3000 more were made. This outlasts most drifts (see
			// accelerated.cpp), so further sweeps are useless.
			const int inVain = 3000 + 2 * reachedAt;
			if (report.iterations >= inVain)
				return giveBest(Status::stagnated);
			if (report.iterations >= until)
				return false;
			const int more = sweepOn(improve, std::min({ most - report.iterations, inVain - report.iterations, untilNext() }));
			report.iterations += more;
			evaluate(more);
			// If the impulses fall to almost nothing, so does the scale of the relative error: the absolute error decides, too.
			// A solution needs no copy: it is the last iterate.
			if (!solved() && (error < best.error || (distance < best.distance && impulse < best.impulse)))
				keep();
			clearRoundOff();
			if (error < 0.99 * reached) {
				reached = error;
				reachedAt = report.iterations;
			}
			cycles = cycles || idle() > patience * report.iterations;
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
		if (report.status != Status::converged) // else the error is known: no impulse has changed since it was computed
			evaluate();
		if (std::isnan(report.error)) // an impulse may be NaN
			report.status = Status::diverged;
		return report;
	}

	int iterations() const { return report.iterations; }
	bool solved() const { return error <= settings.tolerance; }
	double least() const { return reached; } // smallest error so far, to within 1 %
	int idle() const { return report.iterations - reachedAt; } // sweeps since this error fell

    private:
	// Momentum may keep errors alive that change from contact to contact, as contacts open, close and slide; plain sweeps damp these first. In
	// cycles plain sweeps follow others, and momentum begins anew: `fewestPlain` before each evaluation of the error, once it has not fallen
	// during the last 30 % (patience) of all sweeps. In flows, where the error of the first guess is above `poor`, cycles are made from the
	// beginning: `ahead` sweeps with momentum, then `fewestPlain`, or a quarter of the sweeps since the error fell. At rest guesses are better,
	// and without a guess there is none to judge by: cycles from the beginning take 1.6 times as many sweeps to 1e-4 in dense packings, where
	// momentum never stands still. Nor do they help to tolerances below `coarse` (to 1e-7 in a hopper and a collapse: 1.1 and 0.9 times), nor in
	// space (1000 spheres that fall into a box: 413 and 383 sweeps a step with cycles of 40 and 100, 366 without). Where the tolerance is
	// above `poor`, no guess is.
	// 60 steps of a drum of 2000 disks take (median, mean and most sweeps to 1e-4) 372, 469 and 2585; with always `fewestPlain` 402, 584 and
	// 4377; with as many plain sweeps as the error has not fallen for 397, 533 and 4488; with patience 572, 1015 and 19173. Cycles of 10 or 40
	// sweeps with momentum, or growing ones, are no better.
	static constexpr int ahead = 20, fewestPlain = 3;
	static constexpr double poor = 0.03, coarse = 1e-6, patience = 0.3;
	static constexpr bool inFlows = !std::is_same_v<typename S::System, ContactSystem<Space3>>;

	// Makes `more` sweeps, or those that are left of the cycle. Returns how many.
	template <class Improve> int sweepOn(Improve& improve, int more)
	{
		if (!cycles || !improve.mayPause()) {
			for (int i = 0; i < more; i++)
				improve();
			return more;
		}
		if (left == 0) {
			plain = flows ? std::max(fewestPlain, idle() / 4) : std::min(fewestPlain, more);
			left = flows ? ahead + plain : more;
		}
		more = std::min(more, left);
		for (const int end = left - more; left > end; left--)
			if (left > plain)
				improve();
			else
				sweep();
		if (left == 0)
			improve.restart();
		return more;
	}

	// Returns how many sweeps to make before the error is computed again: 4, plus the smallest of three numbers: the sweeps that the recent
	// convergence needs to reach the tolerance, a quarter of those made, and sqrt(2 x 5 x made). The last one minimises the cost of the errors,
	// taken as 5 sweeps each, plus the mean number of superfluous sweeps. It is needed because with momentum the error rises and falls.
	int untilNext()
	{
		const double fall = std::log(lastError / error) / std::max(1, report.iterations - lastIterations);
		const double needed = fall > 0 ? std::log(error / settings.tolerance) / fall : std::numeric_limits<double>::infinity();
		lastError = error;
		lastIterations = report.iterations;
		// `needed` comes last: for an infinite error and a tolerance of 0 it is NaN, which min then passes over.
		return 4 + static_cast<int>(std::min({ 0.25 * report.iterations, std::sqrt(10. * report.iterations), needed }));
	}

	// For bodies that were stopped and carry nothing any more. Sweeps have subtracted the effect of the old impulses from the velocities, and the
	// round-off of this may be all that is left to solve. Where it hides that an island without impulses, beside others, is not solved, the error
	// is infinite.
	void clearRoundOff()
	{
		if (impulse < 1e-3 * largest || std::isinf(error)) {
			sweep.restoreVelocities();
			largest = impulse;
		}
	}

	void keep()
	{
		best = { error, distance, impulse };
		sweep.copyTo(*bestIterate);
	}

	// With momentum the last iterate may be far from the best.
	bool giveBest(Status status)
	{
		report.status = status;
		sweep.copyFrom(*bestIterate);
		return true;
	}

	Residual evaluate(int more = 0) // sweeps since the last time
	{
		const Residual e = sweep.error();
		report.measure(e);
		error = report.error;
		impulse = e.impulse;
		largest = std::max(largest, impulse);
		distance = impulse > 0 ? e.law() * impulse : e.difference;
		if (settings.trace) {
			settings.trace->add(more);
			settings.trace->evaluated(error);
		}
		return e;
	}

	S& sweep;
	const SolverSettings& settings;
	SolverReport report;
	double error = 0; // compared with the tolerance
	double distance = 0; // absolute error of the contacts [N s]
	double impulse = 0, largest = 0; // |p| now, and the largest since the velocities were last made from the impulses [N s]
	double reached = 0; // smallest error so far, to within 1 %
	int reachedAt = 0; // sweeps made when it was reached
	bool flows = false, cycles = false;
	int left = 0, plain = 0; // sweeps left of the present cycle, and how many of a cycle are plain
	double lastError = 0; // at the last evaluation, after lastIterations sweeps
	int lastIterations = 0;
	struct {
		double error, distance, impulse;
	} best {}; // the best iterate so far
	Borrowed<typename S::Iterate, Iteration> bestIterate;
};

// `Improve { sweep }` makes one sweep by operator(); after each call the sweep's impulses are the iterate. Stops when the errors of
// residual.hpp are at most settings.tolerance, after settings.maxIterations sweeps, or when nothing is gained any more. If the problem is not solved,
// the best iterate is the result. With settings.fixedIterations it makes exactly that many plain sweeps, whatever the method, and computes the error
// at the end: what is known of under-converged contact dynamics (Unger & Kertesz 2003) holds for plain Gauss-Seidel.
template <class S, class Improve = PlainSweeps<S>> SolverReport iterate(typename S::System& system, const SolverSettings& settings)
{
	S sweep(system, settings.seed, settings.threads);
	Improve improve { sweep };
	return Iteration<S>(sweep, settings).run(improve);
}

} // namespace cd
