#include "time_step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace cd {
namespace {

	// A contact whose tangential impulse is within this fraction of the cone slides; the solvers put sliding impulses on the cone
	// to round-off, and a sticking one lies this close by chance with negligible probability.
	constexpr double onCone = 1e-9;

} // namespace

double fastestWay(const World& world, double dt)
{
	double fastest = 0;
	for (const Body& b : world.bodies) {
		const double vx = b.v[0] + dt * b.inverseMass[0] * b.force[0], vy = b.v[1] + dt * b.inverseMass[1] * b.force[1];
		fastest = std::max({ fastest, vx * vx + vy * vy, b.v[0] * b.v[0] + b.v[1] * b.v[1] });
	}
	return dt * std::sqrt(fastest);
}

double smallestRadius(const World& world)
{
	double smallest = std::numeric_limits<double>::infinity();
	for (const Body& b : world.bodies)
		if (b.shape.kind == ShapeKind::disk && b.shape.radius > 0)
			smallest = std::min(smallest, b.shape.radius);
	return smallest;
}

double reach(const World& world, double dt)
{
	const double smallest = smallestRadius(world);
	return 4 * fastestWay(world, dt) + (std::isfinite(smallest) ? 1e-3 * smallest : 0);
}

void TimeStep::freeVelocities(const World& world, double dt)
{
	system.bodies.resize(world.bodies.size());
	for (size_t i = 0; i < world.bodies.size(); i++) {
		const Body& b = world.bodies[i];
		BodyVelocity& s = system.bodies[i];
		for (int k = 0; k < 3; k++) {
			s.w[k] = b.inverseMass[k];
			s.v[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
		}
	}
}

inline void TimeStep::fillRow(ContactRow& c, const World& world, size_t index, const StepSettings& settings)
{
	const Pair& pair = world.pairs[index];
	const Place& place = places[pair.a];
	c.a = pair.a;
	c.b = pair.b;
	c.nx = pair.nx;
	c.ny = pair.ny;
	c.an = 0;
	c.at = place.radius - 0.5 * pair.overlap;
	c.bn = 0;
	c.bt = -(places[pair.b].radius - 0.5 * pair.overlap); // the disk b: from its centre against the normal
	c.mu = pair.mu;
	c.pn = pair.pn;
	c.pt = pair.pt;
	if (place.radius == 0) {
		const double ax = pair.cx - place.x, ay = pair.cy - place.y;
		c.an = ax * pair.ny - ay * pair.nx;
		c.at = ax * pair.nx + ay * pair.ny;
	}
	const double share = pair.gap > 0 ? 1 : settings.gapCorrection;
	c.bias = share > 0 ? share * pair.gap / settings.dt : 0;
	if (settings.restitution > 0) {
		const Body &a = world.bodies[pair.a], &b = world.bodies[pair.b];
		const double un = pair.nx * (b.v[0] - a.v[0]) + pair.ny * (b.v[1] - a.v[1]) - c.an * a.v[2];
		if (un < 0 && pair.gap + settings.dt * un <= 0)
			c.bias = std::min(c.bias, settings.restitution * un);
	}
	c.assembleBlock(system.bodies[c.a], system.bodies[c.b]);
	if (!(c.wnn > 0))
		c.pn = c.pt = 0; // two immobile bodies: whatever springs left between them means nothing here
	solved[index] = 1;
}

// Whether a pair is closed, or is closed within the step by the velocities before it or by the external forces.
bool TimeStep::closes(const World& world, const Pair& pair, double dt) const
{
	if (pair.gap <= 0)
		return true;
	const double ax = pair.cx - places[pair.a].x, ay = pair.cy - places[pair.a].y;
	const auto approach
	    = [&](const double* a, const double* b) { return pair.nx * (b[0] - a[0] + a[2] * ay) + pair.ny * (b[1] - a[1] - a[2] * ax); };
	const double before = approach(world.bodies[pair.a].v, world.bodies[pair.b].v);
	const double after = approach(system.bodies[pair.a].v, system.bodies[pair.b].v);
	return pair.gap + dt * std::min(before, after) <= 0;
}

const ContactSystem& TimeStep::assemble(World& world, const StepSettings& settings)
{
	freeVelocities(world, settings.dt);
	// Rows are filled in place; those of the last step need no new construction.
	system.contacts.resize(world.pairs.size());
	rowPair.clear();
	solved.assign(world.pairs.size(), 0);

	forgotten = 0;
	places.resize(world.bodies.size());
	for (size_t i = 0; i < places.size(); i++)
		places[i] = placeAhead(world.bodies[i], 0.5 * settings.dt);
	const double limit = reach(world, settings.dt);
	for (size_t i = 0; i < world.pairs.size(); i++) {
		Pair& pair = world.pairs[i];
		locateContact(pair, places[pair.a], places[pair.b], world.bodies[pair.a].shape);
		if (pair.reference > 0 && pair.overlap <= 0) { // truly apart
			pair.gap -= pair.reference;
			pair.reference = 0;
			forgotten++;
		}
		if (pair.gap <= limit && (settings.restitution == 0 || closes(world, pair, settings.dt))) {
			fillRow(system.contacts[rowPair.size()], world, i, settings);
			rowPair.push_back(static_cast<int32_t>(i));
		} else
			pair.pn = pair.pt = 0;
	}
	system.contacts.resize(rowPair.size());
	return system;
}

// Adds the pairs left out whose gap the solution would cross within the step; says whether there were any.
bool TimeStep::addViolated(const World& world, const StepSettings& settings)
{
	const size_t before = system.contacts.size();
	for (size_t i = 0; i < world.pairs.size(); i++) {
		if (solved[i])
			continue;
		const Pair& pair = world.pairs[i];
		const double *va = system.bodies[pair.a].v, *vb = system.bodies[pair.b].v;
		const double ax = pair.cx - places[pair.a].x, ay = pair.cy - places[pair.a].y;
		const double un = pair.nx * (vb[0] - va[0] + va[2] * ay) + pair.ny * (vb[1] - va[1] - va[2] * ax);
		if (pair.gap + settings.dt * un < 0) {
			fillRow(system.contacts.emplace_back(), world, i, settings);
			rowPair.push_back(static_cast<int32_t>(i));
		}
	}
	return system.contacts.size() > before;
}

StepReport TimeStep::operator()(World& world, const StepSettings& settings)
{
	StepReport report;
	assemble(world, settings);
	for (;;) {
		const auto start = std::chrono::steady_clock::now();
		const int previous = report.solver.iterations;
		report.solver = settings.solve(system, settings.solver);
		report.solver.iterations += previous;
		report.solveSeconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
		// With restitution a contact closed by other contacts' impulses waits for the next step, when its own velocity tells its rebound.
		if (settings.restitution > 0 || !addViolated(world, settings))
			break;
		freeVelocities(world, settings.dt);
	}
	finish(world, settings, report);
	return report;
}

void TimeStep::finish(World& world, const StepSettings& settings, StepReport& report)
{
	const double h = settings.dt;
	report.contacts = static_cast<int>(system.contacts.size());
	report.overlapsForgotten = forgotten;
	for (size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow& c = system.contacts[i];
		Pair& pair = world.pairs[rowPair[i]];
		pair.pn = c.pn;
		pair.pt = c.pt;
		report.maxPenetration = std::max(report.maxPenetration, -pair.gap);
		if (c.pn <= 0)
			continue;
		report.loadedContacts++;
		if (c.mu > 0 && std::abs(c.pt) >= c.mu * c.pn * (1 - onCone))
			report.slidingContacts++;
		// Work of the impulse on the mean of the relative velocities before and after: exact for kinetic energy, M being constant.
		const Body &a = world.bodies[pair.a], &b = world.bodies[pair.b];
		const BodyVelocity &A = system.bodies[pair.a], &B = system.bodies[pair.b];
		double mean[2][3];
		for (int k = 0; k < 3; k++) {
			mean[0][k] = 0.5 * (a.v[k] + A.v[k]);
			mean[1][k] = 0.5 * (b.v[k] + B.v[k]);
		}
		const double dx = mean[1][0] - mean[0][0], dy = mean[1][1] - mean[0][1];
		const double un = c.nx * dx + c.ny * dy + c.bn * mean[1][2] - c.an * mean[0][2];
		const double ut = c.nx * dy - c.ny * dx + c.bt * mean[1][2] - c.at * mean[0][2];
		report.dissipated -= c.pn * un + c.pt * ut;
	}
	for (size_t i = 0; i < world.bodies.size(); i++) {
		Body& b = world.bodies[i];
		const double* v = system.bodies[i].v;
		b.x += 0.5 * h * (b.v[0] + v[0]);
		b.y += 0.5 * h * (b.v[1] + v[1]);
		b.turn = 0.5 * h * (b.v[2] + v[2]);
		std::copy_n(v, 3, b.v);
	}
}

} // namespace cd
