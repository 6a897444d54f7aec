// The part of IslandSolver that puts islands to sleep and wakes them (sleep.hpp says when and why).
#include "island_solver.hpp"

#include <algorithm>

namespace cd {
namespace {

	// An island that needed more in this step is in motion.
	constexpr int fewSweeps = 16;
	constexpr double proof = 1e-3; // error to which rest is proven, over the tolerance
	constexpr double finest = 1e-14; // error asked for where `proof` does not do; below is round-off
	constexpr double sleeps = 1e-2; // error with which an island may sleep: bodies move for half a step while they stop
	// Speeds of bodies, over what errors of the tolerance in the impulses of their own contacts make of them.
	constexpr double slow = 1000; // at rest they are 0.5 to 100, the most where others carry far more; what is faster is not worth a trial
	constexpr double stopped = 1e-2;

} // namespace

// Marks the islands in which nothing moved before the step; says whether there are any.
bool IslandSolver::findStill(const ContactSystem& system, const std::vector<double>& before)
{
	const auto moves = [&](std::size_t i) { return before[3 * i] != 0 || before[3 * i + 1] != 0 || before[3 * i + 2] != 0; };
	for (Island& island : islands)
		island.still = true;
	bool immobileMoves = false;
	for (std::size_t i = 0; i < system.bodies.size(); i++) {
		if (!moves(i))
			continue;
		if (const int32_t k = partition.ofBody[i]; k >= 0)
			islands[k].still = false;
		immobileMoves = immobileMoves || partition.freedom[i] == 0;
	}
	if (immobileMoves)
		for (std::size_t i = 0; i < system.contacts.size(); i++)
			if (partition.ofContact[i] >= 0 && (moves(system.contacts[i].a) || moves(system.contacts[i].b)))
				islands[partition.ofContact[i]].still = false;
	return std::any_of(islands.begin(), islands.end(), [](const Island& island) { return island.still; });
}

// Finds the islands that are asleep: those in which nothing moved before the step and which their impulses keep so. They are solved.
void IslandSolver::recognise(const ContactSystem& system, const Stillness& stillness, double tolerance)
{
	if (!findStill(system, stillness.before))
		return;
	takePart(system, [](const Island& island) { return island.still; });
	for (const ContactRow& c : part.contacts)
		applyImpulse(c, part.bodies[c.a], part.bodies[c.b], c.pn, c.pt);
	judgeRest(tolerance, sleeps);
	for (std::size_t k = 0; k < islands.size(); k++)
		if (islands[k].atRest) {
			islands[k].asleep = islands[k].solved = true;
			sums[k] = trial[k];
			sleeping++;
		}
	if (sleeping > 0)
		reportSleep(system, stillness.sleepers);
}

void IslandSolver::reportSleep(const ContactSystem& system, Sleepers& sleepers)
{
	for (std::size_t k = 0; k < islands.size(); k++)
		if (islands[k].asleep)
			sleepers.add(partition.nameOf(partition.islands[k]), sums[k]);
	sleepers.finishSearch();
	for (std::size_t i = 0; i < system.bodies.size(); i++)
		if (const int32_t k = partition.ofBody[i]; k >= 0 && islands[k].asleep)
			sleepers.join(static_cast<int32_t>(i), partition.name[i], partition.freedom[i]);
}

void IslandSolver::countSleepersOn(Effort& effort, const Sleepers& sleepers)
{
	for (const SleepingIsland& island : sleepers.islands()) {
		if (island.found)
			continue;
		effort.unknowns += island.unknowns;
		effort.islands++;
		effort.resting++;
		effort.sleeping++;
	}
}

// Whether no body of a system is faster than `share` allows, island by island: into `calm`.
void IslandSolver::findCalm(const ContactSystem& system, const std::vector<int32_t>* names, double tolerance, double share)
{
	own.assign(system.bodies.size(), 0);
	for (const ContactRow& c : system.contacts) {
		const double square = c.wnn * (c.pn * c.pn + c.pt * c.pt);
		own[c.a] += square;
		own[c.b] += square;
	}
	for (std::size_t i = 0; i < system.bodies.size(); i++) {
		const int32_t k = partition.ofBody[names ? (*names)[i] : i];
		if (k >= 0 && !(motion(system.bodies[i]) <= share * share * tolerance * tolerance * own[i]))
			islands[k].calm = false;
	}
}

// Of the islands of the part, whose bodies have the velocities that belong to its impulses: which are at rest to `share` of the tolerance.
void IslandSolver::judgeRest(double tolerance, double share)
{
	trial.assign(islands.size(), {});
	measurePart(trial);
	for (const int32_t k : partIsland)
		islands[k].calm = true;
	findCalm(part, &partBodies, tolerance, stopped);
	for (const int32_t k : partIsland) {
		islands[k].atRest = islands[k].calm && trial[k].of().law() <= share * tolerance;
	}
}

// Marks as not solved the slow islands under constant loads; how many they are.
int IslandSolver::markSlow(const ContactSystem& system, const Stillness& stillness, double tolerance)
{
	if (stillness.loadsBefore.size() != system.bodies.size())
		return 0;
	for (Island& island : islands)
		island.calm = !island.asleep && island.sweeps <= fewSweeps;
	for (std::size_t i = 0; i < system.bodies.size(); i++)
		if (partition.ofBody[i] >= 0 && stillness.loads[i] != stillness.loadsBefore[i])
			islands[partition.ofBody[i]].calm = false;
	findCalm(system, nullptr, tolerance, slow);
	for (std::size_t i = 0; i < system.contacts.size(); i++)
		for (const int32_t body : { system.contacts[i].a, system.contacts[i].b })
			if (partition.ofContact[i] >= 0 && partition.freedom[body] == 0 && motion(system.bodies[body]) > 0)
				islands[partition.ofContact[i]].calm = false;
	int marked = 0;
	for (Island& island : islands) {
		island.solved = !island.calm;
		marked += island.calm;
	}
	return marked;
}

// Solves the islands marked as not solved by sweeps, from free velocities, and unmarks those that it does not leave at rest.
void IslandSolver::dismissMoving(const ContactSystem& system, const SolverSettings& settings)
{
	takePart(system, [](const Island& island) { return !island.solved; });
	for (std::size_t i = 0; i < part.bodies.size(); i++)
		for (int k = 0; k < 3; k++)
			part.bodies[i].v[k] = partFree[3 * i + k] = freeVelocity[3 * static_cast<std::size_t>(partBodies[i]) + k];
	SolverSettings finer = settings;
	for (;;) {
		// Without Newton's method: a step of it costs as much as an island awake does in a hundred steps.
		const SolverReport report = accelerated(part, finer);
		judgeRest(settings.tolerance / proof, (1 + 1e-9) * proof); // a single island reaches its tolerance to the last digit
		finer.maxIterations -= report.iterations;
		finer.tolerance *= 0.1;
		const bool done = std::all_of(partIsland.begin(), partIsland.end(), [&](int32_t k) { return islands[k].atRest; });
		if (done || report.status != Status::converged || finer.maxIterations <= 0 || finer.tolerance < finest)
			break;
		// The error is a norm of the whole: a body that carries little, among others that carry much, may be solved far worse.
		for (std::size_t i = 0; i < part.bodies.size(); i++)
			std::copy_n(&partFree[3 * i], 3, part.bodies[i].v);
	}
	for (Island& island : islands)
		island.solved = island.solved || !island.atRest;
}

// Stops the slow islands that come to rest of themselves where this step is solved more exactly. They keep the impulses that stop them, so that the
// forces of the step are those that moved its bodies; only of an island that was at rest before the step these are the impulses of rest, under which
// it is found asleep in the next. One that moved is tried again in the next step.
void IslandSolver::prove(ContactSystem& system, const Stillness& stillness, const SolverSettings& settings, Effort& effort)
{
	const int slowOnes = markSlow(system, stillness, settings.tolerance);
	if (slowOnes == 0)
		return;
	SolverSettings finer = settings;
	finer.tolerance *= proof;
	finer.maxIterations = std::min(settings.maxIterations, stillness.trial);
	dismissMoving(system, finer);
	for (std::size_t i = 0; i < partContacts.size(); i++)
		if (!islands[partIsland[i]].solved) {
			system.contacts[partContacts[i]].pn = part.contacts[i].pn;
			system.contacts[partContacts[i]].pt = part.contacts[i].pt;
		}
	// From v to 0, while the impulses leave the next to nothing u: their work is taken as if they had stopped all, -p (v + 0)/2.
	for (std::size_t i = 0; i < part.bodies.size(); i++) {
		const int32_t k = partition.ofBody[partBodies[i]];
		if (k < 0 || islands[k].solved)
			continue;
		for (int j = 0; j < 3; j++)
			if (part.bodies[i].w[j] > 0) {
				const double v = stillness.before[3 * static_cast<std::size_t>(partBodies[i]) + j];
				effort.stopped += 0.5 * v * part.bodies[i].v[j] / part.bodies[i].w[j];
				effort.stoppedMoving = effort.stoppedMoving || v != 0;
			}
	}
	for (Island& island : islands) {
		effort.provenAtRest += !island.solved;
		island.asleep = island.asleep || !island.solved;
	}
	effort.notAtRest = slowOnes - effort.provenAtRest;
}

// Velocities of what sleeps, or will from the next step on, are zero.
void IslandSolver::stop(ContactSystem& system, const Sleepers& sleepers)
{
	const bool any = std::any_of(islands.begin(), islands.end(), [](const Island& island) { return island.asleep; });
	if (!any && sleepers.none())
		return;
	for (std::size_t i = 0; i < system.bodies.size(); i++) {
		const int32_t k = partition.ofBody[i];
		if (sleepers.sleeps(static_cast<int32_t>(i)) || (k >= 0 && islands[k].asleep))
			std::fill_n(system.bodies[i].v, 3, 0.);
	}
}

} // namespace cd
