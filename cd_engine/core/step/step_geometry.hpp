// Where the bodies of a pair are in a step, and how they move against each other.
#pragma once

#include "step/time_step.hpp"

#include <algorithm>
#include <cmath>

namespace cd {

// The change of a pair's gap within the step by the rotation of its boundary at `spin` [rad/s]. The disk moves along the face with the velocities in
// `system`.
inline double TimeStep::turning(const Pair& pair, const World& world, const Touch& touch, double gap, double dt, double spin) const
{
	const Shape& shape = world.shapes[pair.a];
	const double *va = system.bodies[pair.a].v, *vb = system.bodies[pair.b].v;
	const Place &a = places[pair.a], &b = places[pair.b];
	if (a.radius > 0 || shape.kind != ShapeKind::box || spin == 0)
		return 0;
	const double distance = touch.nx * (b.x - a.x) + touch.ny * (b.y - a.y);
	return gapByTurning(shape, a, b, touch, distance - std::max(gap, 0.), spin, { vb[0] - va[0], vb[1] - va[1] }, dt);
}

// An upper bound for the relative speed of two bodies, at any point of their outlines [m/s].
inline double TimeStep::relativeSpeed(const Pair& pair, const World& world, const double* a, const double* b) const
{
	const Shape& shape = world.shapes[pair.a];
	const double turns = places[pair.a].radius == 0 && shape.kind == ShapeKind::box ? std::abs(a[2]) * std::hypot(shape.ex, shape.ey) : 0;
	const double x = b[0] - a[0], y = b[1] - a[1];
	return std::sqrt(x * x + y * y) + turns;
}

// Radius of the smaller disk of a pair; a boundary has none [m].
inline double TimeStep::smallerRadius(const Pair& pair) const
{
	const double a = places[pair.a].radius, b = places[pair.b].radius;
	return a > 0 ? std::min(a, b) : b;
}

// The shapes are those before the step, so this is for the step itself.
inline Touch TimeStep::locate(const Pair& pair, const World& world) const
{
	return locateContact(places[pair.a], places[pair.b], world.shapes[pair.a]);
}

} // namespace cd
