#include "step/time_step.hpp"

#include <cassert>
#include <chrono>

namespace cd {

template <class Space> void TimeStep<Space>::prepare(World& world, const StepView& step)
{
	assert(std::all_of(world.pairs.begin(), world.pairs.end(), [&](const Pair& p) {
		const auto count = static_cast<int32_t>(world.bodies.size());
		return p.a >= 0 && p.a < count && p.b >= 0 && p.b < count && p.a != p.b && !isBoundary(world.bodies[p.b]) && p.mu >= 0
		    && p.reference >= 0;
	}));
	assert(world.awake.size() <= world.pairs.size() && (world.awake.empty() || world.awake.back() < static_cast<int32_t>(world.pairs.size())));
	const StepSettings& s = step.settings;
	world.carried.resize(world.contacts());
	system.memory = &memory;
	account.begin();
	const auto start = motion.begin(world, s.dt, system, threads);
	const bool same = finder.find(world, step, motion, start);
	// Rows that push need a proof that there is a solution (feasibility.hpp), which reads all of them.
	const bool pushes = s.gapCorrection != 0 || s.restitution != 0;
	system.contacts.compliant = world.compliant();
	system.contacts.pushing = pushes;
	builder.build(step, finder, system, same, !pushes && !start.turns && s.warmStart && sleepers.none() && !world.rolls());
	rolling.guess(step, finder, s.warmStart);
}

template <class Space> auto TimeStep<Space>::assemble(World& world, const StepSettings& settings) -> const ContactSystem&
{
	prepare(world, { world, settings, system.bodies, motion, threads });
	system.contacts.make();
	return system;
}

// Solves the contacts. Returns the status of the solution with the tolerance of the goal; the report has the one that counts.
template <class Space> Status TimeStep<Space>::solve(const StepView& step, const Stillness& stillness, Goal& goal, StepReport& report)
{
	const auto start = std::chrono::steady_clock::now();
	const SolverSettings& wanted = step.settings.solver;
	const int previous = report.solver.iterations;
	const bool finer = goal.tolerance < wanted.tolerance;
	SolverSettings left = wanted;
	left.maxIterations = goal.most - previous;
	left.tolerance = goal.tolerance;
	left.threads = &threads;
	// A smaller tolerance than requested gets only as many sweeps as it may need, so that some are left to lower rebounds further.
	if (finer)
		left.maxIterations = std::min(left.maxIterations, 200 + 10 * goal.first);
	report.solver = rolling.acts() ? rolling.solve(step, finder, system, left, stillness, report.effort)
	    : step.settings.reduce     ? solveIslands(system, step.settings.solve, left, report.effort, &stillness)
				       : solveWhole(system, step.settings.solve, left, report.effort);
	if (previous == 0)
		goal.first = report.solver.iterations;
	report.solver.iterations += previous;
	report.solveSeconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
	// A smaller tolerance serves only to add no energy. If it is missed, the requested one suffices.
	const Status exactly = report.solver.status;
	if (finer && (exactly == Status::stagnated || exactly == Status::max_iterations) && report.solver.contact < 0
	    && report.solver.error <= wanted.tolerance)
		report.solver.status = Status::converged;
	return exactly;
}

// Returns false if the step would touch a sleeping island. That island has then been woken, and the step must be made anew.
template <class Space> bool TimeStep<Space>::attempt(World& world, const StepView& step, StepReport& report)
{
	const SolverSettings& wanted = step.settings.solver;
	const bool rebounds = step.settings.restitution > 0, fixed = wanted.fixedIterations > 0;
	prepare(world, step);
	if (sleepers.wake(system.contacts, world))
		return false;
	const double atRest = world.compliant() ? step.settings.restTolerance : std::min(step.settings.restTolerance, wanted.tolerance);
	const Stillness stillness { sleepers, world.bodies, rest, atRest };
	for (Goal goal { wanted.tolerance, wanted.maxIterations, 0 };;) {
		const Status exactly = solve(step, stillness, goal, report);
		Status& status = report.solver.status;
		const bool solved = status == Status::converged || status == Status::fixed_iterations;
		const bool outran = motion.average(world, step.dt(), system.bodies, solved, threads);
		const bool spent = !fixed && report.solver.iterations >= goal.most;
		const bool last = spent && goal.most > wanted.maxIterations;
		bool again;
		if (rebounds) { // a contact that impulses of others close waits for the next step; its own velocity then determines its rebound
			again = builder.lowerRebounds(step, system, report.solver, goal.tolerance, spent);
			if (!again && exactly != status && builder.energyRemains())
				status = exactly;
		} else {
			if (outran && status != Status::diverged) {
				report.outran = motion.reaches(world, step.dt());
				return true;
			}
			again = !last && finder.addClosing(step);
		}
		if (!again || last) {
			if (status == Status::converged && !fixed && report.solver.iterations > wanted.maxIterations)
				status = Status::max_iterations;
			return true;
		}
		// Rebounds that add energy must not stay, and bodies without an impulse would pass through each other: these need some more
		// iterations.
		if (spent)
			goal.most += 1 + wanted.maxIterations / 10;
		if (rebounds)
			goal.tolerance = std::min(goal.tolerance, Rebounds<Space>::mostGain(step.settings.restitution));
		else {
			builder.append(step, finder, system);
			if (sleepers.wake(system.contacts, world))
				return false;
			if (fixed) // so many sweeps from the first guess, and no more
				report.solver.iterations = 0;
		}
		if (rebounds || fixed) { // impulses with rebounds may be so large that any error is small beside them
			const bool warm = !rebounds || report.solver.contact < 0;
			builder.guessAgain(step, finder, system, warm);
			rolling.guess(step, finder, warm && step.settings.warmStart);
		}
		BodyMotion<Space>::resetFree(world, step.dt(), system, threads);
	}
}

template <class Space> StepReport TimeStep<Space>::operator()(World& world, const StepSettings& settings)
{
	assert(world.stiffnesses.size() == (world.compliant() ? world.pairs.size() : 0));
	assert(!world.compliant() || (settings.restitution == 0 && settings.dampingRatio >= 0));
	assert(settings.solve && settings.dt > 0 && settings.restitution >= 0 && settings.restitution <= 1 && settings.gapCorrection >= 0);
	StepReport report;
	threads.use(settings.threads);
	finder.forgetSeparated();
	rest.begin(world, settings.dt);
	const StepView step { world, settings, system.bodies, motion, threads };
	while (!attempt(world, step, report)) { }
	if (report.solver.status != Status::diverged && report.outran.empty()) { // else nothing is changed
		if (const int32_t i = report.solver.contact; i >= 0)
			report.unsolvable = { world.pairs[finder.pairs()[i]].a, world.pairs[finder.pairs()[i]].b };
		report.contacts = static_cast<int>(finder.pairs().size());
		report.maxPenetration = finder.deepest();
		report.dissipated += report.effort.stopped;
		account.clear(sleepers);
		if (settings.reduce && rolling.acts())
			rolling.putToSleep(sleepers, world);
		else if (settings.reduce)
			solveIslands.putToSleep(sleepers, world);
		const bool corrects = OverlapCorrection<Space>::isDue(world, settings, finder);
		if (corrects || !sleepers.none() || !system.contacts.solvedBeside())
			system.contacts.make();
		if (world.compliant())
			report.damped = BodyMotion<Space>::damped(world, system.bodies, threads);
		account.book(world, step, finder, builder, system.contacts, rolling.rows(), sleepers, report);
		rest.plan(report.effort);
		report.idle = !motion.finish(world, settings.dt, system.bodies, threads) && finder.pairs().empty();
		if (corrects && correction(world, step, finder, system.contacts.all()))
			report.idle = false;
	}
	system.contacts.forgetSource(); // `step` may be gone when somebody reads them, and the world, too
	system.still = nullptr;
	return report;
}

template <class Space> void TimeStep<Space>::locateBack(const World& world, double dt)
{
	motion.placeBack(world, dt);
	finder.locateAll(world, motion);
}

template class TimeStep<Plane>;
template class TimeStep<Space3>;

} // namespace cd
