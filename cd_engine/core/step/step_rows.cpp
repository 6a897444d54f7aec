// Sets up the equations of the contacts of a step: a row each (ContactRow), with its first guess.
#include "kernels/kernels.hpp"
#include "step/load_pairs.hpp"
#include "step/step_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd {
namespace {

	constexpr double pushedOut = 1e-9; // of a disk's radius: smaller overlaps are round-off and stay

	// Factor on mu p_n up to which the tangential part of a first guess is in the cone: what is beyond only by the round-off of dt times force
	// and back must not be cut, or it would be written anew step by step.
	constexpr double onCone = 1 + 1e-9;

} // namespace

// The impulse that a contact has carried (the kernel repeats this, see RowSettings), within the present friction cone, since a guess within the
// tolerance becomes the step's solution.
std::array<double, 2> TimeStep::firstGuess(const World& world, std::size_t index, const StepSettings& settings) const
{
	if (!settings.warmStart)
		return { 0, 0 };
	const auto [pn, pt] = world.carried[index].impulse(settings.dt);
	return { pn, cutGuess<double>({ pn, pt }, world.pairs[index].mu, onCone) };
}

// The row of any pair. turned: the change of its gap by the rotation of its boundary.
ContactRow TimeStep::rowOf(const World& world, std::size_t index, const StepSettings& settings, double& turned) const
{
	const Pair& pair = world.pairs[index];
	const Touch touch = locate(pair, world);
	const double gap = gapOf(world, index);
	const Place& place = places[pair.a];
	ContactRow c;
	c.a = pair.a;
	c.b = pair.b;
	c.nx = touch.nx;
	c.ny = touch.ny;
	c.at = place.radius - 0.5 * touch.overlap;
	c.bt = -(places[pair.b].radius - 0.5 * touch.overlap); // disk b: from its centre, against the normal
	c.mu = pair.mu;
	const auto [pn, pt] = firstGuess(world, index, settings);
	c.pn = pn;
	c.pt = pt;
	if (place.radius == 0) {
		const double ax = touch.cx - place.x, ay = touch.cy - place.y;
		c.an = ax * touch.ny - ay * touch.nx;
		c.at = ax * touch.nx + ay * touch.ny;
	}
	// The spin before the step: a torque that the contacts balance does not turn the box.
	turned = turning(pair, world, touch, gap, settings.dt, world.bodies[pair.a].v[2]);
	const double radius = smallerRadius(pair), allowed = settings.allowedOverlap * radius;
	const bool pushes = gap < -std::max(pushedOut, settings.allowedOverlap) * radius;
	c.bias = ((gap > 0 ? gap : pushes ? settings.gapCorrection * (gap + allowed) : 0) + turned) / settings.dt;
	c.assembleBlock(system.bodies[c.a], system.bodies[c.b]);
	if (!(c.wnn > 0))
		c.pn = c.pt = 0; // two immobile bodies: forces that springs left between them have no meaning here
	return c;
}

void TimeStep::askRebound(const World& world, std::size_t row, ContactRow& c, double turned, const StepSettings& settings)
{
	const Body &a = world.bodies[c.a], &b = world.bodies[c.b];
	const double gap = gapOf(world, rowPair[row]), un = relativeVelocity<false>(c, motionOf(a.v), motionOf(b.v)).n;
	const bool hit = un < 0 && gap + turned + settings.dt * un <= 0, parts = gap <= 0 && un > 0;
	const double rebound = hit || parts ? settings.restitution * un : std::numeric_limits<double>::quiet_NaN();
	rebounds.set(row, c.bias, rebound);
	if (hit || parts)
		c.bias = Rebounds::bias(c.bias, rebound);
}

// Fills rows from their pairs. The kernel makes those of two disks that can move and turn. In the others it leaves wnn = 0, and they are made here.
void TimeStep::fillRows(const World& world, const StepSettings& settings, ContactRow* rows, std::size_t from, std::size_t to)
{
	for (; from < to; from += batch) {
		const std::size_t count = std::min(batch, to - from);
		PairLanes pairs[batch / PairLanes::lanes];
		load<true>(world, count, pairs, [&](std::size_t k) { return rowPair[from + k]; });
		groupKernel().assemble(places.data(), system.bodies.data(), world.carried.data(), pairs, rows + from, count, asked(settings));
		for (std::size_t row = from; row < from + count; row++) {
			ContactRow& c = rows[row];
			double turned = 0;
			special[row] = !(c.wnn > 0);
			if (special[row])
				c = rowOf(world, rowPair[row], settings, turned);
			if (!settings.warmStart)
				c.pn = c.pt = 0;
			if (settings.restitution > 0)
				askRebound(world, row, c, turned, settings);
		}
	}
}

RowSettings TimeStep::asked(const StepSettings& settings)
{
	return { settings.dt, settings.gapCorrection, settings.allowedOverlap, -std::max(pushedOut, settings.allowedOverlap), onCone };
}

} // namespace cd
