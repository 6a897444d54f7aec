// The part of IslandSolver that puts islands to sleep and wakes them (sleep.hpp says when and why).
#include "island_solver.hpp"

#include <algorithm>

namespace cd {
namespace {

	// An island that needed more sweeps in this step is in motion.
	constexpr int fewSweeps = 16;
	constexpr double proof = 1e-3; // error to which rest is proven, in tolerances
	constexpr double finest = 1e-14; // smallest error asked for where `proof` does not suffice; below it is round-off
	constexpr double sleeps = 1e-2; // error with which an island may sleep, in tolerances: bodies move for half a step while they stop
	// Speeds of bodies, relative to those that errors of the tolerance in the impulses of their own contacts cause.
	constexpr double slow = 1000; // at rest they are 0.5 to 100, most where others carry far more; a faster body is not worth a trial
	constexpr double stopped = 1e-2;

} // namespace

// Marks the islands in which nothing moved before the step. Returns whether there are any.
bool IslandSolver::findStill(const ContactSystem& system, const std::vector<Body>& before)
{
	const auto moves = [&](std::size_t i) { return before[i].v[0] != 0 || before[i].v[1] != 0 || before[i].v[2] != 0; };
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

// Finds the islands that sleep: nothing in them moved before the step, and their impulses keep it so. They count as solved.
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

// Clears `calm` of every island that has a body of this system faster than `share` allows.
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

// Finds which islands of the part are at rest to `share` of the tolerance. The bodies must have the velocities of the part's impulses.
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

// Marks the slow islands under constant loads as not solved. Returns how many they are.
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

// Solves the islands marked as not solved, by sweeps from the free velocities. Removes the marks of those that it does not leave at rest.
void IslandSolver::dismissMoving(const ContactSystem& system, const SolverSettings& settings)
{
	takePart(system, [](const Island& island) { return !island.solved; });
	for (std::size_t i = 0; i < part.bodies.size(); i++)
		for (int k = 0; k < 3; k++)
			part.bodies[i].v[k] = partFree[3 * i + k] = freeVelocity[3 * static_cast<std::size_t>(partBodies[i]) + k];
	SolverSettings finer = settings;
	for (;;) {
		// Newton's method is not used: one step of it costs as much as an awake island in a hundred steps.
		const SolverReport report = accelerated(part, finer);
		judgeRest(settings.tolerance / proof, (1 + 1e-9) * proof); // 1e-9: a single island may just reach its tolerance
		finer.maxIterations -= report.iterations;
		finer.tolerance *= 0.1;
		const bool done = std::all_of(partIsland.begin(), partIsland.end(), [&](int32_t k) { return islands[k].atRest; });
		if (done || report.status != Status::converged || finer.maxIterations <= 0 || finer.tolerance < finest)
			break;
		// The error is a norm of the whole: a body that carries little may be solved far less exactly than others that carry much.
		for (std::size_t i = 0; i < part.bodies.size(); i++)
			std::copy_n(&partFree[3 * i], 3, part.bodies[i].v);
	}
	for (Island& island : islands)
		island.solved = island.solved || !island.atRest;
}

// Stops the slow islands that come to rest by themselves if this step is solved more exactly. They keep the impulses that stop them, so that the
// forces of the step are those that moved its bodies. Only in an island at rest before the step these are the impulses of rest, with which the next
// step finds it asleep. An island that moved is tried again in the next step.
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
	// Bodies go from v to 0, though the impulses leave a tiny u. Their work counts as if they had stopped everything, -p (v + 0)/2.
	for (std::size_t i = 0; i < part.bodies.size(); i++) {
		const int32_t k = partition.ofBody[partBodies[i]];
		if (k < 0 || islands[k].solved)
			continue;
		for (int j = 0; j < 3; j++)
			if (part.bodies[i].w[j] > 0) {
				const double v = stillness.before[partBodies[i]].v[j];
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

// Sets the velocities of all that sleeps, or will sleep from the next step on, to zero.
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
