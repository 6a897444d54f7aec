// A step from its beginning to its end: contacts, impulses, motion.
#include "step/time_step.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>

namespace cd {

void TimeStep::noteLoads(const World& world, const StepSettings& settings)
{
	fingerprints.clear();
	if (!settings.notesLoads && settings.trial == 0)
		return;
	for (const Body& b : world.bodies) {
		double gained[3];
		for (int k = 0; k < 3; k++)
			gained[k] = settings.dt * b.inverseMass[k] * b.force[k];
		fingerprints.push_back(fingerprint(gained));
	}
}

// How far from its place before the step pairs of a body must be listed, so that it reaches no other within the step [m].
inline double TimeStep::needed(const World& world, size_t i, double dt) const
{
	return contact_limits::quick * dt * (means[i].speed + 0.5 * outlineSpeed(world.bodies[i].v, world.bodies[i], world.shapes[i]));
}

// Velocities that are no solution may have any size. Their speeds are limited to four times the longest way plus two smallest radii, a step. Returns
// whether a body has become so fast that it may reach, within the step, another body that is not listed with it.
bool TimeStep::meanVelocities(const World& world, double dt, bool solved)
{
	means.resize(world.bodies.size());
	double most = std::numeric_limits<double>::infinity();
	if (!solved && !ways.empty())
		most = (4 * *std::max_element(ways.begin(), ways.end()) + 2 * smallestRadius(world)) / dt;
	struct Found {
		double fastest = 0;
		bool outran = false;
	};
	const auto mean = [&](size_t from, size_t to) {
		Found found;
		for (size_t i = from; i < to; i++) {
			const Body& b = world.bodies[i];
			const double* v = system.bodies[i].v;
			for (int k = 0; k < 3; k++)
				means[i].v[k] = 0.5 * (b.v[k] + v[k]);
			means[i].speed = std::min(outlineSpeed(v, b, world.shapes[i]), most);
			found.fastest = std::max(found.fastest, means[i].speed);
			found.outran = found.outran || (i < world.listed.size() && needed(world, i, dt) > world.listed[i]);
		}
		return found;
	};
	const Found all = reduceRanges<Found>(&threads, means.size(), mean, [](const Found& a, const Found& b) {
		return Found { std::max(a.fastest, b.fastest), a.outran || b.outran };
	});
	fastest = all.fastest;
	return all.outran;
}

// Ends a step that needs another solution when no iterations are left for it.
bool TimeStep::end(StepReport& report)
{
	if (report.solver.status == Status::converged)
		report.solver.status = Status::max_iterations;
	return true;
}

// Restores the first guess. Contacts that were added later have none.
void TimeStep::guessAgain(const World& world, const StepSettings& settings)
{
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const auto [pn, pt] = i < assembled ? firstGuess(world, rowPair[i], settings) : std::array<double, 2> { 0, 0 };
		system.contacts[i].pn = pn;
		system.contacts[i].pt = pt;
	}
}

// Whether the step must be solved again because its rebounds demand more than the energy allows, or make it unsolvable. last: it can be solved only
// once more.
bool TimeStep::lowerRebounds(const World& world, const StepSettings& settings, const StepReport& report, bool last)
{
	const Status status = report.solver.status;
	if (!rebounds.any())
		return false;
	if (report.solver.contact >= 0 && status != Status::converged && status != Status::diverged)
		return rebounds.giveUp(system, report.solver.contact);
	// A gap correction adds energy by itself, so this test does not apply to it.
	const bool unsolved = status == Status::max_iterations || status == Status::stagnated;
	return settings.gapCorrection == 0 && (status == Status::converged || unsolved)
	    && rebounds.lower(system, world.bodies, freeVelocity, settings.solver.tolerance, unsolved || last);
}

// Returns false if the step would touch a sleeping island. That island has then been woken, and the step must be made anew.
bool TimeStep::attempt(World& world, const StepSettings& settings, StepReport& report)
{
	prepare(world, settings);
	if (sleepers.wake(system.contacts, world))
		return false;
	const Stillness stillness { sleepers, world.bodies, settings.trial, fingerprints, settings.loadsBefore,
		std::min(settings.restTolerance, settings.solver.tolerance) };
	double tolerance = settings.solver.tolerance;
	int first = 0; // iterations of the first solution
	int most = settings.solver.maxIterations;
	for (;;) {
		const auto start = std::chrono::steady_clock::now();
		const int previous = report.solver.iterations;
		SolverSettings left = settings.solver;
		left.maxIterations = most - previous;
		left.tolerance = tolerance;
		left.threads = &threads;
		// A smaller tolerance than requested gets only as many sweeps as it may need, so that some are left to lower rebounds further.
		if (tolerance < settings.solver.tolerance)
			left.maxIterations = std::min(left.maxIterations, 200 + 10 * first);
		report.solver = settings.reduce ? solveIslands(system, settings.solve, left, report.effort, &stillness)
						: solveWhole(system, settings.solve, left, report.effort);
		if (previous == 0)
			first = report.solver.iterations;
		report.solver.iterations += previous;
		report.solveSeconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
		// A smaller tolerance serves only to add no energy. If it is missed, the requested one suffices.
		const Status exactly = report.solver.status;
		const bool less = tolerance < settings.solver.tolerance && (exactly == Status::stagnated || exactly == Status::max_iterations)
		    && report.solver.contact < 0 && report.solver.error <= settings.solver.tolerance;
		if (less)
			report.solver.status = Status::converged;
		const Status found = report.solver.status;
		const bool outran = meanVelocities(world, settings.dt, found == Status::converged || found == Status::fixed_iterations);
		const bool spent = settings.solver.fixedIterations == 0 && report.solver.iterations >= most;
		const bool late = settings.solver.fixedIterations == 0 && report.solver.iterations > settings.solver.maxIterations;
		if (settings.restitution > 0) {
			// A contact that impulses of other contacts close waits for the next step. Its own velocity then determines its rebound.
			if (!lowerRebounds(world, settings, report, spent)) {
				if (less && rebounds.energyRemains())
					report.solver.status = exactly;
				return !late || end(report);
			}
			if (spent && most > settings.solver.maxIterations)
				return end(report);
			if (spent) // the rebounds that add energy must not stay
				most += 1 + settings.solver.maxIterations / 10;
			StepSettings anew = settings; // these impulses may be so large that any error is small beside them
			anew.warmStart = settings.warmStart && report.solver.contact < 0;
			guessAgain(world, anew);
			tolerance = std::min(tolerance, Rebounds::mostGain);
			freeAgain(world, settings.dt);
			continue;
		}
		report.outran.clear();
		if (found != Status::diverged && outran) {
			for (size_t i = 0; i < world.bodies.size(); i++)
				report.outran.push_back(needed(world, i, settings.dt));
			return true;
		}
		if (spent && most > settings.solver.maxIterations)
			return end(report);
		if (!addViolated(world, settings))
			return !late || end(report);
		if (spent) // without an impulse the bodies would pass through each other
			most += 1 + settings.solver.maxIterations / 10;
		if (sleepers.wake(system.contacts, world))
			return false;
		freeAgain(world, settings.dt);
		if (settings.solver.fixedIterations > 0) { // so many sweeps from the first guess, and no more
			report.solver.iterations = 0;
			guessAgain(world, settings);
		}
	}
}

StepReport TimeStep::operator()(World& world, const StepSettings& settings)
{
	StepReport report;
	solveIslands.rested = settings.rested;
	threads.use(settings.threads);
	forgotten.clear();
	noteLoads(world, settings);
	while (!attempt(world, settings, report)) { }
	report.rested = solveIslands.rested;
	if (report.solver.status == Status::diverged || !report.outran.empty()) {
		system.contacts.forgetSource(); // `world` and `settings` may be gone when somebody reads them
		return report; // the world has not been changed
	}
	report.dissipated += report.effort.stopped;
	if (const int32_t i = report.solver.contact; i >= 0)
		report.unsolvable = { system.contacts[i].a, system.contacts[i].b };
	report.contacts = static_cast<int>(rowPair.size());
	report.maxPenetration = deepest;
	finishContacts(world, settings, report);
	finishSleepers(report);
	system.contacts.forgetSource();
	report.idle = !finishBodies(world, settings.dt) && rowPair.empty();
	return report;
}

// Moves the bodies. Returns whether any body moves.
bool TimeStep::finishBodies(World& world, double h)
{
	const auto move = [&](size_t from, size_t to) {
		bool moves = false;
		for (size_t i = from; i < to; i++) {
			Body& b = world.bodies[i];
			const double* v = system.bodies[i].v;
			b.x += 0.5 * h * (b.v[0] + v[0]);
			b.y += 0.5 * h * (b.v[1] + v[1]);
			b.turn = 0.5 * h * (b.v[2] + v[2]);
			std::memcpy(b.v, v, sizeof b.v);
			moves = moves || v[0] != 0 || v[1] != 0 || v[2] != 0;
		}
		return moves;
	};
	const bool moves = reduceRanges<bool>(&threads, world.bodies.size(), move, [](bool a, bool b) { return a || b; });
	for (const Shift& shift : shifts) {
		world.bodies[shift.body].x += shift.x;
		world.bodies[shift.body].y += shift.y;
	}
	return moves;
}

} // namespace cd
