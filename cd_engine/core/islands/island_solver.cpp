#include "islands/island_solver.hpp"
#include "problem/problem.hpp"
#include "solvability/solvability.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

namespace cd {
namespace {

	// Islands that reach their tolerance to the last digit may exceed it together by the round-off of their sums.
	constexpr double onTheEdge = 1e-9;

	void copyVelocities(const ContactSystem& system, std::vector<double>& to, Threads* threads)
	{
		to.resize(3 * system.bodies.size());
		forRanges(threads, system.bodies.size(), [&](std::size_t from, std::size_t end) {
			for (std::size_t i = from; i < end; i++)
				std::memcpy(&to[3 * i], system.bodies[i].v, sizeof system.bodies[i].v);
		});
	}

	void addImpulse(ContactSystem& system, const ContactRow& c)
	{
		if (c.pn != 0 || c.pt != 0)
			applyImpulse(c, system.bodies[c.a], system.bodies[c.b], c.pn, c.pt);
	}

	// The impulses of a contact that no other contact influences.
	void solveAlone(const ContactRow& c, const BodyVelocity& A, const BodyVelocity& B, double& pn, double& pt)
	{
		double un, ut;
		relativeVelocity(c, A, B, un, ut);
		un += c.bias;
		if (c.wnt == 0 && c.wtt > 0) {
			pn = std::max(0., -un / c.wnn);
			pt = std::max(-c.mu * pn, std::min(c.mu * pn, -ut / c.wtt));
		} else
			solveLocal(c.wnn, c.wnt, c.wnt, c.wtt, c.mu, un, ut, pn, pt);
	}

} // namespace

SolverReport solveWhole(ContactSystem& system, Solver method, const SolverSettings& settings, Effort& effort)
{
	const SolverReport report = method(system, settings);
	effort = {};
	for (const BodyVelocity& b : system.bodies)
		effort.unknowns += freedoms(b);
	effort.islands = !system.contacts.empty();
	effort.resting = effort.islands && report.iterations == 0;
	return report;
}

void IslandSolver::findIslands(const ContactSystem& system, Threads* threads)
{
	partition.update(system, threads);
	islands.assign(partition.islands.size(), {});
	larger = largest = 0;
	for (const Partition::Island& island : partition.islands) {
		larger += island.contacts > 1;
		largest = std::max(largest, island.contacts);
	}
}

void IslandSolver::countUnknowns(Effort& effort)
{
	touching = 0;
	effort = {};
	for (std::size_t i = 0; i < partition.freedom.size(); i++)
		if (partition.ofBody[i] >= 0) {
			touching++;
			effort.unknowns += partition.freedom[i];
		}
	effort.islands = static_cast<int>(islands.size());
}

// Computes only impulses: the bodies keep their free velocities. A contact rests if its first guess is within the tolerance of the solution.
void IslandSolver::solveLoneContacts(ContactSystem& system, double tolerance)
{
	lone = {};
	for (std::size_t k = 0; k < islands.size(); k++) {
		Island& island = islands[k];
		if (partition.islands[k].contacts > 1 || island.asleep)
			continue;
		ContactRow& c = system.contacts[partition.islands[k].first];
		double pn, pt;
		solveAlone(c, system.bodies[c.a], system.bodies[c.b], pn, pt);
		island.sweeps = std::hypot(pn - c.pn, pt - c.pt) > tolerance * std::hypot(pn, pt);
		island.solved = true;
		c.pn = pn;
		c.pt = pt;
		lone.contacts++;
		lone.square += pn * pn + pt * pt;
		lone.squareEnergy += c.wnn * (pn * pn + pt * pt);
	}
}

// Whether the error of the whole proves that the one larger island meets its own tolerance. Lone contacts add to |p|, not to the difference.
bool IslandSolver::withinItsOwn(const ContactSystem& system, double error, double tolerance) const
{
	if (lone.square == 0)
		return true;
	ResidualSum all;
	for (const ContactRow& c : system.contacts) {
		const double square = c.pn * c.pn + c.pt * c.pt;
		all.square += square;
		all.squareEnergy += c.wnn * square;
	}
	const double share = std::max(lone.square / all.square, lone.squareEnergy / all.squareEnergy);
	return error <= tolerance * std::sqrt(1 - share);
}

// Whether the only island beside lone contacts has nine tenths of the contacts, and most bodies touch something: taking it out would cost too much.
bool IslandSolver::isNearlyOneIsland(const ContactSystem& system) const
{
	return larger == 1 && 10 * static_cast<std::size_t>(largest) >= 9 * system.contacts.size()
	    && 2 * static_cast<std::size_t>(touching) > system.bodies.size();
}

// Solves the system as it is. Sweeps do not change the lone contacts, since these are solved. After a step without sweeps, first tests whether the
// guess is the solution again, before anything is packed.
SolverReport IslandSolver::solveInPlace(ContactSystem& system, Solver method, const SolverSettings& settings)
{
	SolverReport report;
	if (rested && surelySolvable(system, settings.threads)) {
		report.measure(residual(system, freeVelocity));
		if (report.error <= settings.tolerance) {
			for (const ContactRow& c : system.contacts)
				addImpulse(system, c);
			return report;
		}
	}
	report = method(system, settings);
	rested = report.iterations == 0;
	for (Island& island : islands)
		if (!island.solved)
			island.sweeps = report.iterations;
	return report;
}

// Marks the islands whose sums show that they are solved now. Returns how many.
int IslandSolver::judge(double tolerance)
{
	int solved = 0;
	for (std::size_t k = 0; k < islands.size(); k++) {
		if (islands[k].solved || islands[k].unsolvable)
			continue;
		islands[k].solved = sums[k].of().error() <= tolerance;
		solved += islands[k].solved;
	}
	return solved;
}

int32_t IslandSolver::placeOf(const ContactSystem& system, int32_t body)
{
	if (place[body] < 0) {
		place[body] = static_cast<int32_t>(partBodies.size());
		partBodies.push_back(body);
		part.bodies.push_back(system.bodies[body]);
		const double* const free = &freeVelocity[3 * static_cast<std::size_t>(body)];
		partFree.insert(partFree.end(), free, free + 3);
		std::copy_n(free, 3, part.bodies.back().v);
		if (!system.places.empty())
			part.places.push_back(system.places[body]);
	}
	return place[body];
}

// Takes the wanted islands: contacts in the order of the system, bodies with their free velocities.
void IslandSolver::takePart(const ContactSystem& system, bool (*wanted)(const Island&))
{
	part.bodies.clear();
	part.places.clear();
	part.contacts.clear();
	partFree.clear();
	partBodies.clear();
	partContacts.clear();
	partIsland.clear();
	part.memory = system.memory;
	place.assign(system.bodies.size(), -1);
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		if (partition.ofContact[i] < 0 || !wanted(islands[partition.ofContact[i]]))
			continue;
		part.contacts.push_back(system.contacts[i]);
		ContactRow& c = part.contacts.back();
		c.a = placeOf(system, c.a);
		c.b = placeOf(system, c.b);
		partContacts.push_back(static_cast<int32_t>(i));
		partIsland.push_back(partition.ofContact[i]);
	}
}

// Replaces the errors of the islands of the part by new ones.
void IslandSolver::measurePart(std::vector<ResidualSum>& errors)
{
	for (const int32_t k : partIsland)
		errors[k] = {};
	addResiduals(part, partFree, partIsland, errors, partBodies.data());
}

// Solves the islands together, then goes on with those not solved by themselves. The bodies of the system keep their free velocities.
Status IslandSolver::solveInParts(ContactSystem& system, Solver method, const SolverSettings& settings)
{
	factorizations = 0;
	unsolvable = {};
	if (found.size() == islands.size())
		return Status::converged;
	if (found.empty())
		addResiduals(system, freeVelocity, partition.ofContact, sums);
	else {
		takePart(system, [](const Island& island) { return !island.asleep; });
		measurePart(sums);
	}
	const bool solvable
	    = surelySolvable(system, settings.threads); // else a small error is not enough: the method must find that there is a solution
	if (solvable)
		judge(settings.tolerance);
	Status status = Status::converged;
	SolverSettings left = settings; // iterations that all parts together may still take
	for (;;) {
		takePart(system, [](const Island& island) { return !island.solved && !island.unsolvable; });
		if (part.contacts.empty())
			return solvable ? Status::converged : status;
		if (left.maxIterations <= 0)
			return Status::max_iterations;
		const SolverReport report = method(part, left);
		left.maxIterations -= report.iterations;
		for (std::size_t i = 0; i < partContacts.size(); i++) {
			system.contacts[partContacts[i]].pn = part.contacts[i].pn;
			system.contacts[partContacts[i]].pt = part.contacts[i].pt;
		}
		factorizations += report.factorizations;
		for (std::size_t k = 0; k < islands.size(); k++)
			if (!islands[k].solved && !islands[k].unsolvable)
				islands[k].sweeps += report.iterations;
		measurePart(sums);
		// An island without a solution, or with doubts that remain, must not stop the others. A small error does not make it solved.
		if (report.contact >= 0 && unsolvable.status == Status::converged)
			unsolvable = { report.status, partContacts[report.contact] };
		if (report.status != Status::converged && report.contact >= 0) {
			islands[partIsland[report.contact]].unsolvable = true;
			continue;
		}
		status = report.status;
		if (judge(settings.tolerance) == 0)
			return status == Status::converged ? Status::stagnated : status;
	}
}

// Computes the velocities and the error of the whole system.
SolverReport IslandSolver::conclude(ContactSystem& system, Status status, double tolerance, const Sleepers* sleepers)
{
	all.clear();
	int sweeps = 0;
	double work = 0; // of the islands that are awake
	for (std::size_t k = 0; k < islands.size(); k++) {
		if (!islands[k].asleep) {
			all.push_back(sums[k]);
			work += sums[k].squareEnergy;
		}
		sweeps = std::max(sweeps, islands[k].sweeps);
	}
	static const Sleepers nobody;
	const std::vector<SleepingIsland>& on = (sleepers ? sleepers : &nobody)->islands();
	std::merge(on.begin(), on.end(), found.begin(), found.end(), std::back_inserter(all));
	for (std::size_t i = 0; i < system.contacts.size(); i++)
		if (partition.ofContact[i] >= 0 && !islands[partition.ofContact[i]].asleep)
			addImpulse(system, system.contacts[i]);
	SolverReport report;
	report.measure(residual(all.data(), all.size()));
	report.work = work;
	report.iterations = sweeps;
	report.factorizations = factorizations;
	report.contact = unsolvable.contact;
	if (unsolvable.status != Status::converged)
		report.status = unsolvable.status;
	else if (std::isnan(report.error))
		report.status = Status::diverged;
	else if (report.error > (1 + onTheEdge) * tolerance || status != Status::converged)
		report.status = status == Status::converged ? Status::stagnated : status;
	return report;
}

SolverReport IslandSolver::operator()(
    ContactSystem& system, Solver method, const SolverSettings& settings, Effort& effort, const Stillness* stillness)
{
	found.clear();
	if (settings.fixedIterations > 0 || settings.seed > 0)
		return solveWhole(system, method, settings, effort);
	findIslands(system, settings.threads);
	countUnknowns(effort);
	copyVelocities(system, freeVelocity, settings.threads);
	sums.assign(islands.size(), {});
	if (stillness)
		recognise(system, stillness->before, stillness->tolerance);
	solveLoneContacts(system, settings.tolerance);
	const bool inPlace = found.empty() && (!stillness || stillness->sleepers.none()) && isNearlyOneIsland(system);
	SolverReport report;
	if (inPlace)
		report = solveInPlace(system, method, settings);
	if (!inPlace || (report.status == Status::converged && !withinItsOwn(system, report.error, settings.tolerance))) {
		for (std::size_t i = 0; i < system.bodies.size(); i++)
			std::memcpy(system.bodies[i].v, &freeVelocity[3 * i], sizeof system.bodies[i].v);
		SolverSettings left = settings;
		left.maxIterations -= report.iterations;
		report = conclude(system, solveInParts(system, method, left), settings.tolerance, stillness ? &stillness->sleepers : nullptr);
	}
	for (const Island& island : islands)
		effort.resting += island.sweeps == 0;
	if (stillness) {
		SolverSettings left = settings; // maxIterations bounds the whole step
		left.maxIterations -= report.iterations;
		if (stillness->trial > 0 && report.status == Status::converged && left.maxIterations > 0)
			prove(system, *stillness, left, effort);
		stop(system, stillness->sleepers, effort);
	}
	return report;
}

} // namespace cd
