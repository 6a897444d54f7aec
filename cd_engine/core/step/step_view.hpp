// What the parts of a step read of it, and how the two bodies of a pair move against each other.
#pragma once

#include "step/motion.hpp"
#include "step/settings.hpp"

#include <algorithm>
#include <cmath>

namespace cd {

template <class Space> struct StepView;

template <> struct StepView<Plane> {
	const World& world; // as before the step
	const StepSettings<Plane>& settings;
	const std::vector<BodyVelocity<Plane>>& bodies; // with their free velocities, then with those of the solution
	const BodyMotion<Plane>& motion;
	Threads& threads;

	// The velocity at which a body moves in the step, from `bodies`.
	const double* velocity(int32_t body) const
	{
		static constexpr double still[Plane::freedoms] = {};
		return world.isBelt(body) ? still : bodies[body].v;
	}
	// In the equations of the step, where a belt turns (BodyMotion): before the step.
	const double* velocityBefore(int32_t body) const { return world.isBelt(body) ? bodies[body].v : world.bodies[body].v; }
	const Place& place(int32_t body) const { return motion.places()[body]; }
	double dt() const { return settings.dt; }

	// Radius of the smaller disk of a pair; a boundary has none [m].
	double smallerRadius(const Pair& pair) const
	{
		const Place &a = place(pair.a), &b = place(pair.b);
		return isBoundary(a) ? b.radius : std::min(a.radius, b.radius);
	}

	Touch locate(const Pair& pair) const { return locateContact(place(pair.a), place(pair.b), world.shapes[pair.a]); }

	bool isBox(int32_t body) const { return isBoundary(place(body)) && world.shapes[body].kind == ShapeKind::box; }

	// The change of a pair's gap within the step by the rotation of its boundary at `spin` [rad/s]. The disk moves along the face with the
	// velocities in `bodies`.
	double turning(const Pair& pair, const Touch& touch, double gap, double spin) const
	{
		if (spin == 0 || !isBox(pair.a))
			return 0;
		const double *va = velocity(pair.a), *vb = velocity(pair.b);
		const Place &a = place(pair.a), &b = place(pair.b);
		const double distance = touch.nx * (b.x - a.x) + touch.ny * (b.y - a.y);
		const Vector velocity { vb[0] - va[0], vb[1] - va[1] };
		return gapByTurning(world.shapes[pair.a], a, b, touch, distance - std::max(gap, 0.), spin, velocity, dt());
	}

	// An upper bound for the relative speed of two bodies, at any point of their outlines [m/s].
	double relativeSpeed(const Pair& pair, const double* a, const double* b) const
	{
		const Shape& shape = world.shapes[pair.a];
		const double turns = isBox(pair.a) ? std::abs(a[2]) * std::hypot(shape.ex, shape.ey) : 0;
		const double x = b[0] - a[0], y = b[1] - a[1];
		return std::sqrt(x * x + y * y) + turns;
	}
};

} // namespace cd
