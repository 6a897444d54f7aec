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

	constexpr double nearby = 1e-3; // of a disk's radius: gaps as wide as this are contacts however slow the bodies are

	constexpr size_t ahead = 12; // pairs whose bodies are asked for before they are wanted

} // namespace

Reach reach(const World& world, double dt)
{
	double fastest = 0, smallest = std::numeric_limits<double>::infinity();
	for (size_t i = 0; i < world.bodies.size(); i++) {
		const Body& b = world.bodies[i];
		double v[3]; // free
		for (int k = 0; k < 3; k++)
			v[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
		fastest = std::max({ fastest, outlineSpeed(v, b, world.shapes[i]), outlineSpeed(b.v, b, world.shapes[i]) });
		smallest = b.radius > 0 ? std::min(smallest, b.radius) : smallest;
	}
	const double way = dt * fastest;
	return { way, 4 * way + (std::isfinite(smallest) ? nearby * smallest : 0), smallest };
}

void TimeStep::freeVelocities(const World& world, double dt)
{
	system.bodies.resize(world.bodies.size());
	before.resize(3 * world.bodies.size());
	for (size_t i = 0; i < world.bodies.size(); i++) {
		const Body& b = world.bodies[i];
		BodyVelocity& s = system.bodies[i];
		for (int k = 0; k < 3; k++) {
			s.w[k] = b.inverseMass[k];
			before[3 * i + k] = b.v[k];
			s.v[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
		}
		const double ax = b.inverseMass[0] * b.force[0], ay = b.inverseMass[1] * b.force[1];
		s.pushed = dt * std::sqrt(ax * ax + ay * ay);
		s.twisted = dt * b.inverseMass[2] * std::abs(b.force[2]);
	}
}

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

void TimeStep::locateBodies(const World& world, double dt)
{
	places.resize(world.bodies.size());
	ways.resize(world.bodies.size());
	for (size_t i = 0; i < places.size(); i++) {
		const Body& b = world.bodies[i];
		const double* v = system.bodies[i].v; // free
		places[i] = placeAhead(b, 0.5 * dt);
		ways[i] = dt * std::max(outlineSpeed(v, b, world.shapes[i]), outlineSpeed(b.v, b, world.shapes[i]));
	}
}

// Takes a disk back to the face by which its centre has come into a boundary in the half step, the way that an impulse would push it; says whether it
// has. The end of a step before is no place at which contact was required, nor is the place half a step before it where the velocities are new: both
// have to tell the same. A disk that cannot move along the normal goes on as prescribed.
bool TimeStep::stopAtFace(const Pair& pair, const World& world, const Touch& touch, double dt)
{
	const Place& a = places[pair.a];
	Place& b = places[pair.b];
	if (a.radius > 0 || b.radius - touch.overlap > 0.5 * (ways[pair.a] + ways[pair.b]))
		return false;
	Foot face, same;
	const auto through = [&](double ahead, Foot& by) {
		return comesThrough(world.shapes[pair.a], placeAhead(world.bodies[pair.a], ahead), placeAhead(world.bodies[pair.b], ahead), a, b, by);
	};
	if (!through(0, face) || !through(-0.5 * dt, same) || face.nx != same.nx || face.ny != same.ny)
		return false;
	const double* const w = system.bodies[pair.b].w;
	const double along = w[0] * face.nx * face.nx + w[1] * face.ny * face.ny;
	if (ContactRow::held(along, w[0] + w[1]))
		return false;
	const double back = (b.radius - face.distance) / along, x = back * w[0] * face.nx, y = back * w[1] * face.ny;
	shifts.push_back({ pair.b, x, y });
	b.x += x;
	b.y += y;
	return true;
}

// What the turning of a pair's boundary adds to its gap within the step.
inline double TimeStep::turning(const Pair& pair, const World& world, const Touch& touch, double gap, double dt) const
{
	const Shape& shape = world.shapes[pair.a];
	const double *va = system.bodies[pair.a].v, *vb = system.bodies[pair.b].v;
	const Place &a = places[pair.a], &b = places[pair.b];
	if (a.radius > 0 || shape.kind != ShapeKind::box || va[2] == 0)
		return 0;
	const double distance = touch.nx * (b.x - a.x) + touch.ny * (b.y - a.y);
	return gapByTurning(shape, a, b, touch, distance - std::max(gap, 0.), va, vb, dt);
}

// Up to which a pair is a contact. Of its two bodies alone, so that a fast one makes no contacts elsewhere.
inline double TimeStep::contactGap(const Pair& pair) const
{
	const double a = places[pair.a].radius, b = places[pair.b].radius;
	return 2 * (ways[pair.a] + ways[pair.b]) + nearby * (a > 0 ? std::min(a, b) : b);
}

inline void TimeStep::fillRow(ContactRow& c, const World& world, const Pair& pair, const Touch& touch, double gap, const StepSettings& settings)
{
	const Place& place = places[pair.a];
	c.a = pair.a;
	c.b = pair.b;
	c.nx = touch.nx;
	c.ny = touch.ny;
	c.an = 0;
	c.at = place.radius - 0.5 * touch.overlap;
	c.bn = 0;
	c.bt = -(places[pair.b].radius - 0.5 * touch.overlap); // the disk b: from its centre against the normal
	c.mu = pair.mu;
	c.pn = pair.pn;
	c.pt = pair.pt;
	if (place.radius == 0) {
		const double ax = touch.cx - place.x, ay = touch.cy - place.y;
		c.an = ax * touch.ny - ay * touch.nx;
		c.at = ax * touch.nx + ay * touch.ny;
	}
	const double turned = turning(pair, world, touch, gap, settings.dt);
	const double share = gap > 0 ? 1 : settings.gapCorrection;
	c.bias = ((share > 0 ? share * gap : 0) + turned) / settings.dt;
	if (settings.restitution > 0) {
		const Body &a = world.bodies[pair.a], &b = world.bodies[pair.b];
		const double un = touch.nx * (b.v[0] - a.v[0]) + touch.ny * (b.v[1] - a.v[1]) - c.an * a.v[2];
		const bool hit = un < 0 && gap + turned + settings.dt * un <= 0, parts = gap <= 0 && un > 0;
		const double rebound = hit || parts ? settings.restitution * un : std::numeric_limits<double>::quiet_NaN();
		rebounds.add(c.bias, rebound);
		if (hit || parts)
			c.bias = Rebounds::bias(c.bias, rebound);
	}
	c.assembleBlock(system.bodies[c.a], system.bodies[c.b]);
	if (!(c.wnn > 0))
		c.pn = c.pt = 0; // two immobile bodies: whatever springs left between them means nothing here
}

// Rows are filled in place; those of the last step need no new construction.
inline void TimeStep::addRow(World& world, size_t index, const Touch& touch, double gap, const StepSettings& settings)
{
	if (rows == system.contacts.size())
		system.contacts.emplace_back();
	fillRow(system.contacts[rows++], world, world.pairs[index], touch, gap, settings);
	rowPair.push_back(static_cast<int32_t>(index));
	rowTouch.push_back(touch);
	solved[index] = 1;
	deepest = std::max(deepest, -gap);
}

// Whether a pair is closed, or is closed within the step by the velocities before it or by the external forces.
bool TimeStep::closes(const World& world, const Pair& pair, const Touch& touch, double gap, double dt) const
{
	if (gap <= 0)
		return true;
	const double ax = touch.cx - places[pair.a].x, ay = touch.cy - places[pair.a].y;
	const auto approach
	    = [&](const double* a, const double* b) { return touch.nx * (b[0] - a[0] + a[2] * ay) + touch.ny * (b[1] - a[1] - a[2] * ax); };
	const double before = approach(world.bodies[pair.a].v, world.bodies[pair.b].v);
	const double after = approach(system.bodies[pair.a].v, system.bodies[pair.b].v);
	return gap + turning(pair, world, touch, gap, dt) + dt * std::min(before, after) <= 0;
}

// In a large scene the bodies of a pair are seldom in the nearest cache.
inline void TimeStep::prefetchBodies(const Pair& pair) const
{
	__builtin_prefetch(&places[pair.a]);
	__builtin_prefetch(&places[pair.b]);
	__builtin_prefetch(&ways[pair.a]);
	__builtin_prefetch(&ways[pair.b]);
	__builtin_prefetch(&system.bodies[pair.a].w);
	__builtin_prefetch(&system.bodies[pair.b].w);
}

const ContactSystem& TimeStep::assemble(World& world, const StepSettings& settings)
{
	freeVelocities(world, settings.dt);
	free.clear();
	if (settings.restitution > 0)
		for (const BodyVelocity& b : system.bodies)
			free.insert(free.end(), b.v, b.v + 3);
	locateBodies(world, settings.dt);
	shifts.clear();
	std::size_t stopped;
	do { // again for the other pairs of a disk that was stopped
		stopped = shifts.size();
		// Two faces that pass each other would send a disk to and fro for ever. The last look moves none, so that all its contacts see one
		// place.
		findContacts(world, settings, stopped <= world.bodies.size());
	} while (shifts.size() > stopped);
	return system;
}

void TimeStep::findContacts(World& world, const StepSettings& settings, bool stops)
{
	rows = 0;
	rebounds.clear();
	rowPair.clear();
	rowTouch.clear();
	solved.assign(world.pairs.size(), 0);
	gaps.resize(world.pairs.size());
	deepest = 0;
	narrowest = std::numeric_limits<double>::infinity();
	for (size_t k = 0; k < world.awake.size(); k++) {
		if (k + ahead < world.awake.size())
			prefetchBodies(world.pairs[world.awake[k + ahead]]);
		const int32_t i = world.awake[k];
		Pair& pair = world.pairs[i];
		Touch touch = locateContact(places[pair.a], places[pair.b], world.shapes[pair.a]);
		if (stops && stopAtFace(pair, world, touch, settings.dt))
			touch = locateContact(places[pair.a], places[pair.b], world.shapes[pair.a]);
		double gap = pair.reference - touch.overlap;
		if (pair.reference > 0 && touch.overlap <= 0) { // truly apart
			pair.reference = 0;
			gap = -touch.overlap;
			forgotten.push_back(i);
		}
		gaps[i] = gap;
		if (gap <= contactGap(pair) && (settings.restitution == 0 || closes(world, pair, touch, gap, settings.dt)))
			addRow(world, i, touch, gap, settings);
		else {
			pair.pn = pair.pt = 0;
			narrowest = std::min(narrowest, gap);
		}
	}
	assembled = rows;
	system.contacts.resize(rows);
}

void TimeStep::meanVelocities(const World& world)
{
	means.resize(world.bodies.size());
	fastest = 0;
	for (size_t i = 0; i < means.size(); i++) {
		const Body& b = world.bodies[i];
		const double* v = system.bodies[i].v;
		for (int k = 0; k < 3; k++)
			means[i].v[k] = 0.5 * (b.v[k] + v[k]);
		means[i].speed = outlineSpeed(v, b, world.shapes[i]);
		fastest = std::max(fastest, means[i].speed);
	}
}

// Whether the solution lets a pair that was left out cross its gap within the step.
bool TimeStep::crosses(size_t index, const World& world, double dt) const
{
	const Pair& pair = world.pairs[index];
	// Most are too slow for that.
	if (gaps[index] > 1.001 * dt * (means[pair.a].speed + means[pair.b].speed))
		return false;
	const Place& a = places[pair.a];
	const Touch touch = locateContact(places[pair.a], places[pair.b], world.shapes[pair.a]);
	const double *va = system.bodies[pair.a].v, *vb = system.bodies[pair.b].v;
	const double un = touch.nx * (vb[0] - va[0] + va[2] * (touch.cy - a.y)) + touch.ny * (vb[1] - va[1] - va[2] * (touch.cx - a.x));
	return gaps[index] + turning(pair, world, touch, gaps[index], dt) + dt * un < 0;
}

bool TimeStep::anyViolated(const World& world, const StepSettings& settings) const
{
	return narrowest <= 2.001 * settings.dt * fastest
	    && std::any_of(world.awake.begin(), world.awake.end(), [&](int32_t i) { return !solved[i] && crosses(i, world, settings.dt); });
}

// If there are such pairs, adds them, and all that the fastest body could reach, since an impact may go on from body to body; says whether there
// were.
bool TimeStep::addViolated(World& world, const StepSettings& settings)
{
	if (!anyViolated(world, settings))
		return false;
	const double wide = reach(world, settings.dt).gap;
	for (const int32_t i : world.awake)
		if (!solved[i] && (gaps[i] <= wide || crosses(i, world, settings.dt))) {
			const Pair& pair = world.pairs[i];
			addRow(world, i, locateContact(places[pair.a], places[pair.b], world.shapes[pair.a]), gaps[i], settings);
		}
	return true;
}

// False if it would touch what sleeps on, which has been woken: then it has to be made anew.
bool TimeStep::attempt(World& world, const StepSettings& settings, StepReport& report)
{
	assemble(world, settings);
	if (sleepers.wake(system.contacts, world))
		return false;
	static const std::vector<int> unknown;
	const Stillness stillness { sleepers, before, settings.trial, fingerprints, settings.loadsBefore ? *settings.loadsBefore : unknown };
	for (;;) {
		const auto start = std::chrono::steady_clock::now();
		const int previous = report.solver.iterations;
		SolverSettings left = settings.solver;
		left.maxIterations -= previous;
		report.solver = settings.reduce ? solveIslands(system, settings.solve, left, report.effort, &stillness)
						: solveWhole(system, settings.solve, left, report.effort);
		report.solver.iterations += previous;
		report.solveSeconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
		meanVelocities(world);
		const bool spent = settings.solver.fixedIterations == 0 && report.solver.iterations >= settings.solver.maxIterations;
		if (settings.restitution > 0) {
			// A contact closed by other contacts' impulses waits for the next step, when its own velocity tells its rebound.
			const bool judged = report.solver.status == Status::converged && settings.gapCorrection == 0; // which adds energy by itself
			if (!judged || !rebounds.any() || !rebounds.lower(system, before, free, settings.solver.tolerance))
				return true;
			if (spent)
				return end(report);
			freeVelocities(world, settings.dt);
			continue;
		}
		if (spent)
			return !anyViolated(world, settings) || end(report);
		if (!addViolated(world, settings))
			return true;
		if (sleepers.wake(system.contacts, world))
			return false;
		freeVelocities(world, settings.dt);
		if (settings.solver.fixedIterations > 0)
			beginAgain(world, report);
	}
}

// Another solution is needed and nothing is left for it.
bool TimeStep::end(StepReport& report)
{
	if (report.solver.status == Status::converged)
		report.solver.status = Status::max_iterations;
	return true;
}

// So many sweeps from the first guess, and no more, is what fixedIterations mean.
void TimeStep::beginAgain(const World& world, StepReport& report)
{
	report.solver.iterations = 0;
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		system.contacts[i].pn = world.pairs[rowPair[i]].pn;
		system.contacts[i].pt = world.pairs[rowPair[i]].pt;
	}
}

StepReport TimeStep::operator()(World& world, const StepSettings& settings)
{
	StepReport report;
	forgotten.clear();
	noteLoads(world, settings);
	wokeSome = false;
	while (!attempt(world, settings, report))
		wokeSome = true;
	if (report.solver.status == Status::diverged)
		return report; // the world is as it was
	report.dissipated += report.effort.stopped;
	if (const int32_t i = report.solver.contact; i >= 0)
		report.unsolvable = { system.contacts[i].a, system.contacts[i].b };
	report.contacts = static_cast<int>(rows);
	report.maxPenetration = deepest;
	finishContacts(world, report);
	finishSleepers(report);
	report.idle = !finishBodies(world, settings.dt) && rows == 0;
	return report;
}

// Adds a contact's impulse to both of its bodies, or, for a sleeping island, to what it remembers of those that cannot move.
inline void TimeStep::push(size_t row, const Pair& pair, SleepingIsland* asleep)
{
	const Touch& touch = rowTouch[row];
	const Place &a = places[pair.a], &b = places[pair.b];
	const double x = touch.nx * pair.pn - touch.ny * pair.pt, y = touch.ny * pair.pn + touch.nx * pair.pt;
	// A disk takes it on its rim, so only the tangential part turns it; a boundary's arm starts at its centre.
	const double turnA = a.radius > 0 ? (a.radius - 0.5 * touch.overlap) * pair.pt : (touch.cx - a.x) * y - (touch.cy - a.y) * x;
	const double turnB = (b.radius - 0.5 * touch.overlap) * pair.pt;
	const auto add = [&](int32_t body, double px, double py, double turn) {
		if (asleep && !sleepers.sleeps(body)) {
			asleep->onImmobile.push_back({ body, { px, py, turn } });
			return;
		}
		std::array<double, 3>& on = impulses[body];
		on[0] += px;
		on[1] += py;
		on[2] += turn;
	};
	add(pair.a, -x, -y, -turnA);
	add(pair.b, x, y, -turnB);
}

// The sleeping island that a contact belongs to, if any.
SleepingIsland* TimeStep::asleepAt(const ContactRow& c)
{
	for (const int32_t body : { c.a, c.b })
		if (sleepers.sleeps(body))
			return &sleepers.islandOf(body);
	return nullptr;
}

void TimeStep::finishContacts(World& world, StepReport& report)
{
	impulses.resize(world.bodies.size());
	for (size_t i = 0; i < impulses.size(); i++)
		if (!sleepers.sleepsOn(static_cast<int32_t>(i)))
			impulses[i] = { 0, 0, 0 };
	for (size_t i = 0; i < system.contacts.size(); i++) {
		if (i + ahead < system.contacts.size()) {
			__builtin_prefetch(&means[system.contacts[i + ahead].a]);
			__builtin_prefetch(&means[system.contacts[i + ahead].b]);
		}
		const ContactRow& c = system.contacts[i];
		Pair& pair = world.pairs[rowPair[i]];
		pair.pn = c.pn;
		pair.pt = c.pt;
		SleepingIsland* const asleep = asleepAt(c);
		if (asleep) {
			asleep->contacts++;
			asleep->deepest = std::max(asleep->deepest, -gaps[rowPair[i]]);
			asleep->disturbed = asleep->disturbed || i >= assembled; // one that was taken back is none in the next step
		}
		if (c.pn > 0 || asleep)
			push(i, pair, asleep);
		if (c.pn <= 0)
			continue;
		(asleep ? asleep->loaded : report.loadedContacts)++;
		if (c.mu > 0 && std::abs(c.pt) >= c.mu * c.pn * (1 - onCone))
			(asleep ? asleep->sliding : report.slidingContacts)++;
		// Work of the impulse on the mean of the relative velocities before and after: exact for kinetic energy, M being constant.
		const double *a = means[c.a].v, *b = means[c.b].v;
		const double dx = b[0] - a[0], dy = b[1] - a[1];
		const double un = c.nx * dx + c.ny * dy + c.bn * b[2] - c.an * a[2];
		const double ut = c.nx * dy - c.ny * dx + c.bt * b[2] - c.at * a[2];
		report.dissipated -= c.pn * un + c.pt * ut;
	}
}

// What sleeping islands add, those that this step has looked at and the others.
void TimeStep::finishSleepers(StepReport& report)
{
	for (const SleepingIsland& island : sleepers.islands()) {
		report.contacts += island.found ? 0 : island.contacts;
		report.loadedContacts += island.loaded;
		report.slidingContacts += island.sliding;
		report.maxPenetration = std::max(report.maxPenetration, island.deepest);
		for (const Push& push : island.onImmobile)
			for (int k = 0; k < 3; k++)
				impulses[push.body][k] += push.impulse[k];
	}
}

// Whether any body moves.
bool TimeStep::finishBodies(World& world, double h)
{
	bool moves = false;
	for (size_t i = 0; i < world.bodies.size(); i++) {
		Body& b = world.bodies[i];
		const double* v = system.bodies[i].v;
		b.x += 0.5 * h * (b.v[0] + v[0]);
		b.y += 0.5 * h * (b.v[1] + v[1]);
		b.turn = 0.5 * h * (b.v[2] + v[2]);
		std::copy_n(v, 3, b.v);
		moves = moves || v[0] != 0 || v[1] != 0 || v[2] != 0;
	}
	for (const Shift& shift : shifts) {
		world.bodies[shift.body].x += shift.x;
		world.bodies[shift.body].y += shift.y;
	}
	sleepers.remember(world);
	return moves;
}

} // namespace cd
