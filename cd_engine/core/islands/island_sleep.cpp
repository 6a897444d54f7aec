// The part of IslandSolver that finds islands asleep: those that are proven to be at rest and in which nothing has changed since.
//
// A first guess within the tolerance is not rest. It leaves velocities of the size of the tolerance. Impulses that never change are dead
// loads, under which a packing is unstable: in one of 400 disks the error grows by a factor of 1.15 a step, from 1e-11 to 1e-6 in 80 steps,
// and then some sweeps must reduce it. Islands that are slow under constant loads must therefore prove their rest now and then: sweeps
// solve one step to a thousandth of the tolerance, or less if that does not suffice, since the error is a norm of the whole. An island is
// at rest if each body is then slower than a hundredth of what an error of the tolerance in the impulses of its own contacts would cause.
// Its velocities are set to zero. Bodies that roll or drift keep moving in such a step, so they are not stopped. An island that moved
// before this step is tried again in the next one, in which nothing must be stopped, so that its impulses are those of rest. An island
// sleeps if nothing in it moves before a step and its impulses keep it so, to a hundredth of the tolerance. It is not solved again, and
// smaller forces may be lost. Which islands sleep follows from velocities, impulses and what the engine saves, so that a saved scene
// continues identically. If the tolerance changes from step to step, the smallest one counts for rest. Islands in which nothing changes at all are
// not even examined (sleepers.hpp).
#include "islands/island_solver.hpp"

#include <algorithm>
#include <cassert>
#include <functional>
#include <limits>
#include <string_view>

namespace cd {
namespace {

	constexpr int fewSweeps = 16; // an island that needed more in this step is in motion
	constexpr double proof = 1e-3; // error to which rest is proven, in tolerances
	constexpr double finest = 1e-14; // smallest error asked for where `proof` does not suffice; below it is round-off
	constexpr double sleeps = 1e-2; // error with which an island may sleep, in tolerances: bodies move for half a step while they stop
	// Speeds of bodies, relative to those that errors of the tolerance in the impulses of their own contacts cause.
	constexpr double slow = 1000; // at rest they are 0.5 to 100, most where others carry far more; a faster body is not worth a trial
	constexpr double stopped = 1e-2;

	// Twice the kinetic energy [J]; infinite if a blocked freedom moves.
	template <class Space> double motion(const BodyVelocity<Space>& b)
	{
		double sum = 0;
		for (int k = 0; k < Space::freedoms; k++)
			if (b.v[k] != 0)
				sum += b.w[k] > 0 ? b.v[k] * b.v[k] / b.w[k] : std::numeric_limits<double>::infinity();
		return sum;
	}

} // namespace

template <class Space> void Rest::begin(const WorldOf<Space>& world, double dt)
{
	loads.clear();
	if (sweeps() == 0 && !precedesTrial())
		return;
	for (const BodyOf<Space>& b : world.bodies) {
		double gained[Space::freedoms];
		for (int k = 0; k < Space::freedoms; k++)
			gained[k] = dt * b.inverseMass[k] * b.force[k] + 0.; // turns -0 into +0
		loads.push_back(std::hash<std::string_view>()({ reinterpret_cast<const char*>(gained), sizeof gained }) & 0x7fffffff);
	}
}

template void Rest::begin(const WorldOf<Plane>&, double);
template void Rest::begin(const WorldOf<Space3>&, double);

int Rest::sweeps() const { return sleeping < islands && steps >= trialAt ? std::clamp(pause, fewestSweeps, mostSweeps) : 0; }

// After a failed trial, the next one comes later. After islands have been woken, it comes soon, because they may soon be at rest again.
void Rest::plan(const Effort& effort)
{
	assert(effort.sleeping <= effort.islands);
	const bool keeps = precedesTrial() || effort.stoppedMoving, tried = sweeps() > 0, woken = effort.sleeping < sleeping;
	loadsBefore.clear();
	if (keeps)
		loadsBefore = loads;
	if (woken || (tried && effort.notAtRest == 0 && effort.provenAtRest > 0))
		pause = shortestPause;
	else if (tried && effort.notAtRest > 0)
		pause = std::min(2 * pause, longestPause);
	if ((woken || tried) && trialAt != never)
		trialAt = steps + (effort.stoppedMoving ? 1 : pause);
	islands = effort.islands;
	sleeping = effort.sleeping;
	steps++;
}

// Clears `calm` of the islands that have, or touch, a body that meets the condition.
template <class Space> template <class Condition> void IslandSolver<Space>::excite(const Condition& moves)
{
	for (std::size_t i = 0; i < partition.links.size(); i++)
		if (const int32_t k = partition.ofContact[i]; k >= 0 && islands[k].calm)
			islands[k].calm = !moves(partition.links[i].a) && !moves(partition.links[i].b);
}

// Clears `calm` of the islands that have a body of this system faster than `share` allows. places: of each body in it; null: its own
// number.
template <class Space> void IslandSolver<Space>::exciteFast(const ContactSystem& system, const int32_t* places, double tolerance, double share)
{
	own.assign(system.bodies.size(), 0);
	for (const ContactRow<Space>& c : system.contacts) {
		const double square = c.wnn * dot(impulseOf(c), impulseOf(c));
		own[c.a] += square;
		own[c.b] += square;
	}
	excite([&](int32_t body) {
		const int32_t i = places ? places[body] : body;
		return i >= 0 && !(motion(system.bodies[i]) <= share * share * tolerance * tolerance * own[i]);
	});
}

// Leaves only those islands of the part calm that are at rest to `share` of the tolerance. The bodies must have the velocities of its
// impulses.
template <class Space> void IslandSolver<Space>::findCalm(double tolerance, double share)
{
	for (const int32_t k : part.islandOf)
		islands[k].calm = true;
	exciteFast(part.system, part.place.data(), tolerance, stopped);
	sums.resize(islands.size());
	part.measure(sums);
	for (const int32_t k : part.islandOf)
		islands[k].calm = islands[k].calm && sums[k].of().law() <= share * tolerance;
}

// Finds the islands that sleep: nothing in them moved before the step, and their impulses keep it so. They count as solved.
template <class Space> void IslandSolver<Space>::findAsleep(ContactSystem& system, const std::vector<Body>& before, double tolerance)
{
	for (Island& island : islands)
		island.calm = true;
	excite([&](int32_t i) { // a point of a boundary that turns is no body of the world
		return static_cast<std::size_t>(i) >= before.size()
		    || std::any_of(std::begin(before[i].v), std::end(before[i].v), [](double v) { return v != 0; });
	});
	if (std::none_of(islands.begin(), islands.end(), [](const Island& island) { return island.calm; }))
		return;
	system.contacts.make();
	part.take(system, freeVelocity, partition, [&](int32_t k) { return islands[k].calm; });
	for (const ContactRow<Space>& c : part.system.contacts)
		applyImpulse(c, part.system.bodies[c.a], part.system.bodies[c.b], impulseOf(c));
	findCalm(tolerance, sleeps);
	for (std::size_t k = 0; k < islands.size(); k++)
		if (islands[k].calm) {
			islands[k].state = State::asleep;
			found.push_back({ partition.nameAt(partition.islands[k].first), sums[k], 0, 0, 0, 0, {} });
		}
	std::sort(found.begin(), found.end());
}

// Stops the slow islands under constant loads that come to rest by themselves if this step is solved more exactly, by sweeps from the free
// velocities. They keep the impulses that stop them, so that the forces of the step are those that moved its bodies. Only in an island at
// rest before the step these are the impulses of rest, with which the next step finds it asleep. An island that moved is tried again in the
// next step.
template <class Space>
void IslandSolver<Space>::tryRest(ContactSystem& system, const Stillness& stillness, const SolverSettings& settings, Effort& effort)
{
	const std::vector<int>&loads = stillness.rest.loads, &before = stillness.rest.loadsBefore;
	if (before.size() != loads.size())
		return;
	for (Island& island : islands)
		island.calm = island.state != State::asleep && island.sweeps <= fewSweeps;
	excite([&](int32_t body) { return static_cast<std::size_t>(body) >= loads.size() || loads[body] != before[body]; });
	exciteFast(system, nullptr, settings.tolerance, slow);
	const auto isCalm = [&](int32_t k) { return islands[k].calm; };
	const auto countCalm
	    = [&] { return static_cast<int>(std::count_if(islands.begin(), islands.end(), [](const Island& island) { return island.calm; })); };
	const int tried = countCalm();
	if (tried == 0)
		return;
	part.take(system, freeVelocity, partition, isCalm);
	SolverSettings finer = settings;
	finer.tolerance = stillness.tolerance * proof;
	finer.maxIterations = std::min(settings.maxIterations, stillness.rest.sweeps());
	for (bool ends = false; !ends;) {
		// The error is a norm of the whole: a body that carries little may be solved far less exactly than others that carry much.
		// Newton's method is not used: one step of it costs as much as an awake island in a hundred steps.
		for (std::size_t i = 0; i < part.bodies.size(); i++)
			std::copy_n(&part.freeVelocity[Space::freedoms * i], Space::freedoms, part.system.bodies[i].v);
		const SolverReport report = accelerated(part.system, finer);
		findCalm(stillness.tolerance, (1 + 1e-9) * proof); // 1e-9: a single island may just reach its tolerance
		finer.maxIterations -= report.iterations;
		finer.tolerance *= 0.1;
		ends = std::all_of(part.islandOf.begin(), part.islandOf.end(), isCalm) || report.status != Status::converged
		    || finer.maxIterations <= 0 || finer.tolerance < finest;
	}
	part.giveBack(system, isCalm);
	// Bodies go from v to 0, though the impulses leave a tiny u. Their work counts as if they had stopped everything, -p (v + 0)/2.
	for (std::size_t i = 0; i < part.bodies.size(); i++) {
		const int32_t body = part.bodies[i], k = partition.ofBody[body];
		for (int j = 0; k >= 0 && islands[k].calm && j < Space::freedoms; j++) {
			const BodyVelocityIn<Space>& u = part.system.bodies[i];
			system.bodies[body].v[j] = 0;
			if (!(u.w[j] > 0))
				continue;
			const double v = stillness.before[body].v[j];
			effort.stopped += 0.5 * v * u.v[j] / u.w[j];
			effort.stoppedMoving = effort.stoppedMoving || v != 0;
		}
	}
	effort.provenAtRest = countCalm();
	effort.notAtRest = tried - effort.provenAtRest;
}

// Sets the velocities of all that sleeps to zero, and counts the islands that sleep on.
template <class Space> void IslandSolver<Space>::stop(ContactSystem& system, const Sleepers& on, Effort& effort)
{
	const int islandsOn = static_cast<int>(on.islands().size());
	effort.islands += islandsOn;
	effort.resting += islandsOn;
	effort.sleeping = islandsOn + static_cast<int>(found.size());
	for (std::size_t i = 0; effort.sleeping > 0 && i < system.bodies.size(); i++) {
		const bool sleepsOn = on.sleeps(static_cast<int32_t>(i));
		effort.unknowns += sleepsOn ? partition.freedom[i] : 0;
		if (const int32_t k = partition.ofBody[i]; sleepsOn || (k >= 0 && islands[k].state == State::asleep))
			std::fill_n(system.bodies[i].v, Space::freedoms, 0.);
	}
}

template void IslandSolver<Plane>::findAsleep(ContactSystem&, const std::vector<Body>&, double);
template void IslandSolver<Space3>::findAsleep(ContactSystem&, const std::vector<Body>&, double);
template void IslandSolver<Plane>::tryRest(ContactSystem&, const Stillness&, const SolverSettings&, Effort&);
template void IslandSolver<Space3>::tryRest(ContactSystem&, const Stillness&, const SolverSettings&, Effort&);
template void IslandSolver<Plane>::stop(ContactSystem&, const Sleepers&, Effort&);
template void IslandSolver<Space3>::stop(ContactSystem&, const Sleepers&, Effort&);
template void IslandSolver<RollingPlane>::findAsleep(ContactSystem&, const std::vector<Body>&, double);
template void IslandSolver<RollingPlane>::tryRest(ContactSystem&, const Stillness&, const SolverSettings&, Effort&);
template void IslandSolver<RollingPlane>::stop(ContactSystem&, const Sleepers&, Effort&);

} // namespace cd
