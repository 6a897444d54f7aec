// Shapes of boundaries, their extents, and how far they move.
#pragma once

#include "scene/body.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>

namespace cd {

constexpr double endless = std::numeric_limits<double>::infinity();

enum class ShapeKind : uint8_t { disk, box, wall, facet }; // facet: in space only

// The shape of a boundary. The radius in Body describes a disk completely.
struct Shape {
	ShapeKind kind = ShapeKind::disk;
	double ex = 0, ey = 0; // box: half lengths along its own axes [m]
	double cosine = 1, sine = 0; // box: its orientation in the plane
	int axis = 0; // wall: the axis it is perpendicular to, 0 = x, 1 = y
	int sense = 0; // wall: the side it acts on, -1, +1, or 0 for both
};

inline bool operator==(const Shape& s, const Shape& o)
{
	const auto all = [](const Shape& of) { return std::tie(of.kind, of.ex, of.ey, of.cosine, of.sine, of.axis, of.sense); };
	return all(s) == all(o);
}

// Half the sides of the axis-parallel bounding box of a body [m]. A Wall is endless along itself.
struct Half {
	double x, y;
};
Half halfSides(const Body&, const Shape&);

// The largest speed at which a point of a body moves its outline [m/s]. The spin of a disk does not move its outline. v: velocity of the body.
inline double outlineSpeed(const double* v, const Body& b, const Shape& shape)
{
	const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1]);
	return isBoundary(b) && shape.kind == ShapeKind::box ? speed + std::abs(v[2]) * std::hypot(shape.ex, shape.ey) : speed;
}

// The distance that a body may move in a step of dt [m]; if it turns, that of its farthest point. Uses the velocity before the step or the one that
// the external forces alone would leave, whichever gives more.
inline double wayOf(const Body& b, const Shape& shape, const double* free, double dt)
{
	if (!isBoundary(b)) // the larger of two roots is that of the larger square, to the last bit
		return dt * std::sqrt(std::max(free[0] * free[0] + free[1] * free[1], b.v[0] * b.v[0] + b.v[1] * b.v[1]));
	return dt * std::max(outlineSpeed(free, b, shape), outlineSpeed(b.v, b, shape));
}
inline double wayOf(const Body& b, const Shape& shape, double dt)
{
	double free[Plane::freedoms];
	for (int k = 0; k < Plane::freedoms; k++)
		free[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
	return wayOf(b, shape, free, dt);
}

} // namespace cd
