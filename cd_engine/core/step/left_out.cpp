// Pairs that a step has left out of its contacts and whose gap its solution closes: they join, and the step is solved again.
#include "step/step_geometry.hpp"

namespace cd {

using namespace contact_limits;

// Whether the bodies of a pair are fast enough, after the solution, to close its gap within the step, and no face is before it.
bool TimeStep::within(size_t index, const World& world, double dt) const
{
	const Pair& pair = world.pairs[index];
	const double gap = gapOf(world, index);
	if (gap > quick * dt * (means[pair.a].speed + means[pair.b].speed)) // true for most pairs
		return false;
	return gap <= quick * dt * relativeSpeed(pair, world, system.bodies[pair.a].v, system.bodies[pair.b].v)
	    && !corners.hide(world, places, pair, dt);
}

// Whether the solution lets a pair that was left out cross its gap within the step.
bool TimeStep::crosses(size_t index, const World& world, double dt) const
{
	const Pair& pair = world.pairs[index];
	if (!within(index, world, dt)) // most pairs are too slow
		return false;
	const Place& a = places[pair.a];
	const Touch touch = locate(pair, world);
	const double *va = system.bodies[pair.a].v, *vb = system.bodies[pair.b].v;
	const double un = touch.nx * (vb[0] - va[0] + va[2] * (touch.cy - a.y)) + touch.ny * (vb[1] - va[1] - va[2] * (touch.cx - a.x));
	const double gap = gapOf(world, index);
	return gap + turning(pair, world, touch, gap, dt, va[2]) + dt * un < 0;
}

// If there are such pairs, adds them and all other pairs whose gap the bodies are fast enough to close, since an impact may spread from body to body.
// Returns whether there were such pairs.
bool TimeStep::addViolated(World& world, const StepSettings& settings)
{
	const auto violated = [&](size_t k) { return !solved[world.awake[k]] && crosses(world.awake[k], world, settings.dt); };
	if (!(narrowest <= 2 * quick * settings.dt * fastest) || !anyOf(&threads, world.awake.size(), violated))
		return false;
	system.contacts.make();
	system.contactSet++;
	appended = true;
	for (const int32_t i : world.awake)
		if (!solved[i] && within(i, world, settings.dt)) {
			const std::size_t row = system.contacts.size();
			system.contacts.resize(row + 1);
			resizeRows(row + 1, settings);
			rowPair.back() = i;
			fillRows(world, settings, system.contacts.all().data(), row, row + 1);
			solved[i] = 1;
			deepest = std::max(deepest, -gapOf(world, i));
			// The first guess is the impulse that would stop this contact alone. With 0 a large system's error may not show it.
			ContactRow& c = system.contacts[row];
			double un, ut;
			relativeVelocity(c, system.bodies[c.a], system.bodies[c.b], un, ut);
			c.pn = c.wnn > 0 ? std::max(0., -(un + c.bias) / c.wnn) : 0;
			c.pt = 0;
		}
	return true;
}

} // namespace cd
