// The part of IslandSolver that puts islands to sleep and wakes them (sleep.hpp says when and why).
#include "island_solver.hpp"

#include <algorithm>

namespace cd {
namespace {

	// An island that needed more in this step is in motion, or its loads change.
	constexpr int fewSweeps = 16;
	constexpr double slow = 10; // velocities, over what an error of the tolerance makes of them: at rest they are 0.5 to 4
	constexpr double proof = 1e-3; // error to which rest is proven, over the tolerance
	constexpr double sleeps = 1e-2; // the same with which an island may sleep: its bodies move by half a step of what they did when they stop

} // namespace

// The number of the island that a body belongs to, -1: to none.
int32_t IslandSolver::islandWith(int32_t body) { return freedom[body] > 0 ? numberOf[nameOf(body)] : -1; }

IslandSolver::Asleep& IslandSolver::memoryOf(const ContactSystem& system, const Island& island)
{
	const ContactRow& c = system.contacts[island.first];
	return memory[nameOf(freedom[c.a] > 0 ? c.a : c.b)];
}

// Marks the islands in which nothing moved before the step; says whether there are any of more than one contact.
bool IslandSolver::findStill(const ContactSystem& system, const std::vector<double>& before)
{
	const auto moves = [&](std::size_t i) { return before[3 * i] != 0 || before[3 * i + 1] != 0 || before[3 * i + 2] != 0; };
	for (Island& island : islands)
		island.still = island.contacts > 1;
	bool immobileMoves = false;
	for (std::size_t i = 0; i < system.bodies.size(); i++) {
		if (!moves(i))
			continue;
		if (const int32_t k = islandWith(static_cast<int32_t>(i)); k >= 0)
			islands[k].still = false;
		immobileMoves = immobileMoves || freedom[i] == 0;
	}
	if (immobileMoves)
		for (std::size_t i = 0; i < system.contacts.size(); i++)
			if (islandOf[i] >= 0 && (moves(system.contacts[i].a) || moves(system.contacts[i].b)))
				islands[islandOf[i]].still = false;
	return std::any_of(islands.begin(), islands.end(), [](const Island& island) { return island.still; });
}

// Marks as solved the islands that sleep on, and those that fall asleep.
void IslandSolver::recognise(const ContactSystem& system, const Stillness& stillness, double tolerance)
{
	memory.resize(system.bodies.size());
	sleeping = 0;
	if (!findStill(system, stillness.before))
		return;
	prints.assign(islands.size(), 0);
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow& c = system.contacts[i];
		if (islandOf[i] >= 0 && islands[islandOf[i]].still)
			prints[islandOf[i]] += fingerprint(c, &freeVelocity[3 * c.a], &freeVelocity[3 * c.b]);
	}
	bool anew = false;
	for (std::size_t k = 0; k < islands.size(); k++)
		if (islands[k].still) {
			islands[k].asleep = memoryOf(system, islands[k]).print == prints[k];
			anew = anew || !islands[k].asleep;
		}
	if (anew)
		fallAsleep(system, tolerance);
	for (std::size_t k = 0; k < islands.size(); k++)
		if (islands[k].asleep) {
			islands[k].solved = true;
			sums[k] = memoryOf(system, islands[k]).sum;
			sleeping++;
		}
}

// Of the still islands those that their impulses keep so.
void IslandSolver::fallAsleep(const ContactSystem& system, double tolerance)
{
	takePart(system, [](const Island& island) { return island.still && !island.asleep; });
	for (const ContactRow& c : part.contacts)
		applyImpulse(c, part.bodies[c.a], part.bodies[c.b], c.pn, c.pt);
	judgeRest(tolerance, sleeps);
	for (std::size_t k = 0; k < islands.size(); k++)
		if (islands[k].atRest) {
			islands[k].asleep = true;
			memoryOf(system, islands[k]) = { prints[k], trial[k] };
		}
}

// Of the islands of the part, whose bodies have the velocities that belong to its impulses: which are at rest to `share` of the tolerance.
void IslandSolver::judgeRest(double tolerance, double share)
{
	trial.assign(islands.size(), {});
	motions.assign(islands.size(), 0);
	addResiduals(part, partFree, partIsland, trial);
	for (std::size_t i = 0; i < part.bodies.size(); i++)
		if (const int32_t k = islandWith(partBodies[i]); k >= 0)
			motions[k] += motion(part.bodies[i]);
	for (const int32_t k : partIsland) {
		const Residual e = trial[k].of(static_cast<std::size_t>(islands[k].contacts));
		islands[k].atRest
		    = std::max(e.norm, e.energy) <= share * tolerance && motions[k] <= tolerance * tolerance * share * trial[k].squareEnergy;
	}
}

// Marks as not solved the slow islands; says whether there are any.
bool IslandSolver::anySlow(const ContactSystem& system, double tolerance)
{
	motions.assign(islands.size(), 0);
	trial.assign(islands.size(), {});
	for (std::size_t i = 0; i < system.bodies.size(); i++)
		if (const int32_t k = islandWith(static_cast<int32_t>(i)); k >= 0)
			motions[k] += motion(system.bodies[i]);
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow& c = system.contacts[i];
		if (islandOf[i] < 0)
			continue;
		trial[islandOf[i]].squareEnergy += c.wnn * (c.pn * c.pn + c.pt * c.pt);
		for (const int32_t body : { c.a, c.b })
			if (freedom[body] == 0)
				motions[islandOf[i]] += motion(system.bodies[body]);
	}
	bool any = false;
	for (std::size_t k = 0; k < islands.size(); k++) {
		Island& island = islands[k];
		island.solved = island.asleep || island.contacts == 1 || island.sweeps > fewSweeps
		    || !(motions[k] <= slow * slow * tolerance * tolerance * trial[k].squareEnergy);
		any = any || !island.solved;
	}
	return any;
}

// Stops the slow islands that are at rest, as solving them as if nothing had moved before the step shows.
void IslandSolver::prove(ContactSystem& system, const Stillness& stillness, const SolverSettings& settings, Effort& effort)
{
	if (!anySlow(system, settings.tolerance))
		return;
	takePart(system, [](const Island& island) { return !island.solved; });
	for (std::size_t i = 0; i < part.bodies.size(); i++)
		for (int k = 0; k < 3; k++) {
			const std::size_t from = 3 * static_cast<std::size_t>(partBodies[i]) + k;
			part.bodies[i].v[k] = partFree[3 * i + k] = freeVelocity[from] - stillness.before[from];
		}
	SolverSettings finer = settings;
	finer.tolerance *= proof;
	finer.maxIterations = std::min(settings.maxIterations, stillness.trial);
	// Without Newton's method: a step of it costs as much as an island awake does in a hundred steps.
	accelerated(part, finer);
	judgeRest(settings.tolerance, (1 + 1e-9) * proof); // a single island reaches its tolerance to the last digit
	for (std::size_t i = 0; i < partContacts.size(); i++)
		if (islands[partIsland[i]].atRest) {
			system.contacts[partContacts[i]].pn = part.contacts[i].pn;
			system.contacts[partContacts[i]].pt = part.contacts[i].pt;
		}
	for (Island& island : islands) {
		effort.provenAtRest += island.atRest && !island.asleep;
		effort.notAtRest += !island.solved && !island.atRest;
		island.asleep = island.asleep || island.atRest;
	}
}

// Velocities of the islands that sleep, or will from the next step on, are zero.
void IslandSolver::stop(ContactSystem& system)
{
	for (std::size_t i = 0; i < system.bodies.size(); i++)
		if (const int32_t k = islandWith(static_cast<int32_t>(i)); k >= 0 && islands[k].asleep)
			std::fill_n(system.bodies[i].v, 3, 0.);
}

} // namespace cd
