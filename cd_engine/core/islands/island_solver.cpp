#include "islands/island_solver.hpp"
#include "problem/problem.hpp"
#include "solvability/solvability.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <iterator>

namespace cd {
namespace {

	// Islands that reach their tolerance to the last digit may exceed it together by the round-off of their sums.
	constexpr double onTheEdge = 1e-9;

	template <class Space> void copyVelocities(const ContactSystem<Space>& system, std::vector<double>& to, Threads* threads)
	{
		to.resize(Space::freedoms * system.bodies.size());
		system.forBodies(
		    threads, [&](std::size_t i) { std::memcpy(&to[Space::freedoms * i], system.bodies[i].v, sizeof system.bodies[i].v); });
	}

	template <class Space> void addImpulse(ContactSystem<Space>& system, const ContactRow<Space>& c)
	{
		if (!isZero(impulseOf(c)))
			applyImpulse(c, system.bodies[c.a], system.bodies[c.b], impulseOf(c));
	}

	// Whether the block of a contact is known without its direction, so that the closed form is exact. Else W_tt is an estimate
	// (contact_row_in_space.hpp), and sweeps are needed.
	bool movesAlike(const BodyVelocity<Plane>&) { return true; }
	bool movesAlike(const BodyVelocity<Space3>& b) { return b.w[0] == b.w[1] && b.w[1] == b.w[2] && b.w[3] == b.w[4] && b.w[4] == b.w[5]; }

	// The impulses of a contact that no other contact influences.
	template <class Space> ImpulseOf<Space> solveAlone(const ContactRow<Space>& c, const BodyVelocityIn<Space>& A, const BodyVelocityIn<Space>& B)
	{
		return solveContact(c, inLaw(c, relativeVelocity(c, A, B), ImpulseOf<Space> {}));
	}

} // namespace

template <class Space> SolverReport solveWhole(ContactSystem<Space>& system, Solver<Space> method, const SolverSettings& settings, Effort& effort)
{
	const SolverReport report = method(system, settings);
	effort = {};
	for (const BodyVelocityIn<Space>& b : system.bodies)
		effort.unknowns += freedoms(b);
	effort.islands = !system.contacts.empty();
	effort.resting = effort.islands && report.iterations == 0;
	return report;
}

template <class Space> void IslandSolver<Space>::findIslands(ContactSystem& system, Threads* threads, Effort& effort)
{
	if (!partition.knows(system))
		system.contacts.make();
	partition.update(system, threads);
	islands.assign(partition.islands.size(), {});
	effort = {};
	effort.islands = static_cast<int>(islands.size());
	touching = 0;
	for (std::size_t i = 0; i < partition.freedom.size(); i++)
		if (partition.ofBody[i] >= 0) {
			touching++;
			effort.unknowns += partition.freedom[i];
		}
}

// Computes only impulses: the bodies keep their free velocities. A contact rests if its first guess is within the tolerance of the solution.
template <class Space> void IslandSolver<Space>::solveLoneContacts(ContactSystem& system, double tolerance)
{
	lone = {};
	for (std::size_t k = 0; k < islands.size(); k++) {
		Island& island = islands[k];
		if (partition.islands[k].contacts > 1 || island.state == State::asleep)
			continue;
		system.contacts.make();
		ContactRow<Space>& c = system.contacts[partition.islands[k].first];
		if (!movesAlike(system.bodies[c.a]) || !movesAlike(system.bodies[c.b]))
			continue;
		const ImpulseOf<Space> p = solveAlone(c, system.bodies[c.a], system.bodies[c.b]);
		island.sweeps = length(p - impulseOf(c)) > tolerance * length(p);
		island.state = State::solved;
		setImpulse(c, p);
		lone.contacts++;
		lone.square += dot(p, p);
		lone.squareEnergy += c.nn() * dot(p, p);
	}
}

// Whether the error of the whole proves that the one larger island meets its own tolerance. Lone contacts add to |p|, not to the difference.
template <class Space> bool IslandSolver<Space>::withinItsOwn(const ContactSystem& system, double error, double tolerance) const
{
	if (lone.square == 0)
		return true;
	ResidualSum all;
	for (const ContactRow<Space>& c : system.contacts) {
		const double square = dot(impulseOf(c), impulseOf(c));
		all.square += square;
		all.squareEnergy += c.nn() * square;
	}
	const double share = std::max(lone.square / all.square, lone.squareEnergy / all.squareEnergy);
	return error <= tolerance * std::sqrt(1 - share);
}

// Whether the only island beside lone contacts has nine tenths of the contacts, and most bodies touch something: taking it out would cost too much.
template <class Space> bool IslandSolver<Space>::isNearlyOneIsland(const ContactSystem& system) const
{
	int open = 0;
	std::size_t contacts = 0;
	for (std::size_t k = 0; k < islands.size(); k++)
		if (islands[k].state == State::open) {
			open++;
			contacts = static_cast<std::size_t>(partition.islands[k].contacts);
		}
	return open == 1 && 10 * contacts >= 9 * system.contacts.size() && 2 * touching > system.bodies.size();
}

// Solves the system as it is. Sweeps do not change the lone contacts, since these are solved. After a step without sweeps, first tests whether the
// guess is the solution again, before anything is packed.
template <class Space>
SolverReport IslandSolver<Space>::solveInPlace(ContactSystem& system, Solver method, const SolverSettings& settings, Rest* rest)
{
	SolverReport report;
	if (rest && rest->withoutSweep && surelySolvable(system, settings.threads)) {
		system.contacts.make();
		const Residual guess = residual(system, freeVelocity);
		report.measure(guess);
		if (report.error <= settings.tolerance && !guess.stale) {
			for (const ContactRow<Space>& c : system.contacts)
				addImpulse(system, c);
			return report;
		}
	}
	report = method(system, settings);
	if (rest)
		rest->withoutSweep = report.iterations == 0;
	for (Island& island : islands)
		if (island.state == State::open)
			island.sweeps = report.iterations;
	return report;
}

// Marks the islands whose sums show that they are solved now. Returns how many. guess: by the first guess (Iteration::begin).
template <class Space> int IslandSolver<Space>::markSolved(double tolerance, bool guess)
{
	int solved = 0;
	for (std::size_t k = 0; k < islands.size(); k++)
		if (islands[k].state == State::open && sums[k].of().error() <= tolerance && !(guess && sums[k].stale > 0)) {
			islands[k].state = State::solved;
			solved++;
		}
	return solved;
}

// Solves the islands together, then goes on with those not solved by themselves. The bodies of the system keep their free velocities. Reports the
// status, the factorizations, and the contact of the first island found without a solution, else of one whose first guess must not be used again.
template <class Space> SolverReport IslandSolver<Space>::solveInParts(ContactSystem& system, Solver method, const SolverSettings& settings)
{
	SolverReport of;
	Status unsolved = Status::converged; // of the first island found without a solution
	const auto end = [&](Status status) {
		of.status = unsolved == Status::converged ? status : unsolved;
		return of;
	};
	sums.assign(islands.size(), {});
	if (found.size() == islands.size())
		return of;
	if (found.empty())
		addResiduals(system, freeVelocity, partition.ofContact, sums);
	else {
		part.take(system, freeVelocity, partition, [&](int32_t k) { return islands[k].state != State::asleep; });
		part.measure(sums);
	}
	const bool solvable
	    = surelySolvable(system, settings.threads); // else a small error is not enough: the method must find that there is a solution
	if (solvable)
		markSolved(settings.tolerance, true);
	Status status = Status::converged;
	SolverSettings left = settings; // iterations that all parts together may still take
	for (;;) {
		const auto open = [&](int32_t k) { return islands[k].state == State::open; };
		part.take(system, freeVelocity, partition, open);
		if (part.contacts.empty())
			return end(solvable ? Status::converged : status);
		if (left.maxIterations <= 0)
			return end(Status::max_iterations);
		const SolverReport report = method(part.system, left);
		left.maxIterations -= report.iterations;
		part.giveBack(system, open);
		of.factorizations += report.factorizations;
		for (Island& island : islands)
			island.sweeps += island.state == State::open ? report.iterations : 0;
		part.measure(sums);
		// An island without a solution, or without a clear one, must not stop the others. A small error does not make it solved.
		if (report.contact >= 0 && unsolved == Status::converged) {
			unsolved = report.status;
			of.contact = part.contacts[report.contact];
		}
		if (report.status != Status::converged && report.contact >= 0) {
			islands[part.islandOf[report.contact]].state = State::unsolvable;
			continue;
		}
		status = report.status;
		if (markSolved(settings.tolerance, false) == 0)
			return end(status == Status::converged ? Status::stagnated : status);
	}
}

// Computes the velocities and the error of the whole system.
template <class Space>
SolverReport IslandSolver<Space>::conclude(ContactSystem& system, SolverReport report, double tolerance, const Stillness* stillness)
{
	all.clear();
	double work = 0; // of the islands that are awake
	for (std::size_t k = 0; k < islands.size(); k++) {
		report.iterations = std::max(report.iterations, islands[k].sweeps);
		if (islands[k].state == State::asleep)
			continue;
		all.push_back(sums[k]);
		work += sums[k].squareEnergy;
	}
	const double awake = residual(all.data(), all.size()).error(); // what sleeps was proven to a tolerance of its own
	static const std::vector<SleepingIsland> none;
	const std::vector<SleepingIsland>& on = stillness ? stillness->sleepers.islands() : none;
	std::merge(on.begin(), on.end(), found.begin(), found.end(), std::back_inserter(all));
	for (std::size_t i = 0; i < system.contacts.size(); i++)
		if (const int32_t k = partition.ofContact[i]; k >= 0 && islands[k].state != State::asleep)
			addImpulse(system, system.contacts[i]);
	report.measure(residual(all.data(), all.size()));
	report.work = work;
	if (std::isnan(report.error) && (report.contact < 0 || report.status == Status::converged))
		report.status = Status::diverged;
	else if (report.status == Status::converged && awake > (1 + onTheEdge) * tolerance)
		report.status = Status::stagnated;
	return report;
}

template <class Space>
SolverReport IslandSolver<Space>::operator()(
    ContactSystem& system, Solver method, const SolverSettings& settings, Effort& effort, const Stillness* stillness)
{
	assert(system.places.empty() || system.places.size() == system.bodies.size());
	found.clear();
	if (settings.fixedIterations > 0 || settings.seed > 0)
		return solveWhole(system, method, settings, effort);
	findIslands(system, settings.threads, effort);
	copyVelocities(system, freeVelocity, settings.threads);
	if (stillness)
		findAsleep(system, stillness->before, stillness->tolerance);
	solveLoneContacts(system, settings.tolerance);
	const bool inPlace = found.empty() && (!stillness || stillness->sleepers.none()) && isNearlyOneIsland(system);
	SolverReport report;
	if (inPlace)
		report = solveInPlace(system, method, settings, stillness ? &stillness->rest : nullptr);
	else
		system.contacts.make();
	if (!inPlace || (report.status == Status::converged && !withinItsOwn(system, report.error, settings.tolerance))) {
		system.forBodies(settings.threads,
		    [&](std::size_t i) { std::memcpy(system.bodies[i].v, &freeVelocity[Space::freedoms * i], sizeof system.bodies[i].v); });
		SolverSettings left = settings;
		left.maxIterations -= report.iterations;
		report = conclude(system, solveInParts(system, method, left), settings.tolerance, stillness);
	}
	for (const Island& island : islands)
		effort.resting += island.sweeps == 0;
	if (stillness) {
		SolverSettings left = settings; // maxIterations bounds the whole step
		left.maxIterations -= report.iterations;
		if (stillness->rest.sweeps() > 0 && report.status == Status::converged && left.maxIterations > 0) {
			system.contacts.make();
			tryRest(system, *stillness, left, effort);
		}
		stop(system, stillness->sleepers, effort);
	}
	return report;
}

template SolverReport solveWhole(ContactSystem<Plane>&, Solver<Plane>, const SolverSettings&, Effort&);
template SolverReport solveWhole(ContactSystem<Space3>&, Solver<Space3>, const SolverSettings&, Effort&);
template class IslandSolver<Space3>;
template SolverReport solveWhole(ContactSystem<RollingPlane>&, Solver<RollingPlane>, const SolverSettings&, Effort&);
template class IslandSolver<Plane>;
template class IslandSolver<RollingPlane>;

} // namespace cd
