// Bodies: what moves as one.
#pragma once

#include "scene/plane.hpp"
#include "scene/vector.hpp"

#include <algorithm>
#include <iterator>

namespace cd {

struct Body {
	double x = 0, y = 0, turn = 0; // position [m]; rotation made in this step [rad]
	double v[Plane::freedoms] = {}; // v_x, v_y [m/s], angular velocity [rad/s]
	// Along x, y [1/kg] and about z [1/(kg m^2)]. 0: this freedom is blocked and its velocity is prescribed.
	double inverseMass[Plane::freedoms] = {};
	double force[Plane::freedoms] = {}; // external force [N] and torque [N m], gravity included
	double radius = 0; // of a disk [m]; 0: the body is a boundary
	double friction = 0; // coefficient of friction of the surface; a pair uses the smaller of its two
};

// The position of a body as the contact geometry needs it. It is small, so that those of many bodies stay in the first-level cache.
struct alignas(32) Place {
	double x, y; // [m]
	double turned; // rotation beyond the orientation stored in its shape [rad]
	double radius; // of a disk [m]; 0: a boundary
};
static_assert(sizeof(Place) == 32);

// The motion of a body in a step.
struct alignas(32) Mean {
	double v[Plane::freedoms]; // mean of the velocities before and after the step; with stiffnesses: those after it
	double speed; // speed of the fastest point of its outline after the step, which bounds its motion [m/s]
};
static_assert(sizeof(Mean) == 32);

inline Vector centreOf(const Body& b) { return { b.x, b.y }; }
inline bool turns(const Body& b) { return b.v[2] != 0; }

// Whether a body, or what stands at a place, is a box, a wall or a facet. Read from the radius, so that the shapes of disks stay out of the caches.
template <class Of> bool isBoundary(const Of& b) { return b.radius == 0; }

// Whether no force changes the motion of a body, so that it is known before the step is solved.
template <class Body> bool isGuided(const Body& b)
{
	return std::all_of(std::begin(b.inverseMass), std::end(b.inverseMass), [](double w) { return w == 0; });
}

// Whether two bodies are alike but for their motion, masses and forces.
inline bool samePlace(const Body& b, const Body& c) { return b.x == c.x && b.y == c.y && b.radius == c.radius && b.friction == c.friction; }

// The place of a body after `ahead` [s] at its present velocities.
inline Place placeAhead(const Body& b, double ahead) { return { b.x + ahead * b.v[0], b.y + ahead * b.v[1], ahead * b.v[2], b.radius }; }

} // namespace cd
