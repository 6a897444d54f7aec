// What the parts of a step in space read of it: step_view.hpp says what the members do.
#pragma once

#include "step/step_view.hpp"

namespace cd {

template <> struct StepView<Space3> {
	const WorldOf<Space3>& world;
	const StepSettings<Space3>& settings;
	const std::vector<BodyVelocity<Space3>>& bodies; // after those of the world: points of boundaries that turn (problem_in_space.hpp)
	const BodyMotion<Space3>& motion;
	Threads& threads;

	const SpacePlace& place(int32_t body) const { return motion.places()[body]; }
	const SpaceShape& shape(int32_t body) const { return motion.shapes()[body]; }
	double dt() const { return settings.dt; }
	double smallerRadius(const Pair& pair) const
	{
		const SpacePlace &a = place(pair.a), &b = place(pair.b);
		return isBoundary(a) ? b.radius : std::min(a.radius, b.radius);
	}
	bool turningBoundary(int32_t body) const { return isBoundary(place(body)) && turns(world.bodies[body]); }

	// The change of a pair's gap within the step by the rotation of its boundary, beyond gap + h u_n, to the second order and more. The sphere
	// moves along the face with the velocities in `bodies`. An edge or a corner bends away from the sphere.
	double turning(const Pair& pair, const Vector3& n, double gap) const
	{
		if (!turningBoundary(pair.a))
			return 0;
		const SpacePlace &a = place(pair.a), &b = place(pair.b);
		const Vector3 d = b.at - a.at, way = dt() * spinOf(world.bodies[pair.a]);
		if (!(dot(way, way) < 1) || footOnBoundary(shape(pair.a), d).feature)
			return 0;
		// After the step the face has the normal n'. The sphere moves by beta n + h v_t, so that n' . (d + beta n + h v_t) = n . d - gap.
		const Vector3 v = vectorOf(bodies[pair.b].v) - vectorOf(bodies[pair.a].v), along = v - dot(n, v) * n, later = rotated(n, way);
		const double kept = std::max(gap, 0.), beta = (dot(n, d) - kept - dot(later, d + dt() * along)) / dot(n, later);
		return dot(n, cross(way, d)) - kept - beta;
	}
	// The velocity of sphere b against the point of a that it touches, along the normal, for the velocities of both [m/s].
	double approach(const Pair& pair, const SpaceTouch& touch, const double* a, const double* b) const
	{
		return dot(touch.n, vectorOf(b) - vectorOf(a) - cross(vectorOf(a + 3), touch.c - place(pair.a).at));
	}
	double relativeSpeed(const Pair& pair, const double* a, const double* b) const
	{
		const double turning = isBoundary(place(pair.a)) ? length(vectorOf(a + 3)) * farthest(shape(pair.a)) : 0;
		return length(vectorOf(b) - vectorOf(a)) + turning;
	}
};

} // namespace cd
