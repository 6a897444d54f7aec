// Shapes of boundaries in space, their extents, and how far they move: shape.hpp says what is the same in the plane.
#pragma once

#include "scene/body_in_space.hpp"
#include "scene/shape.hpp"

namespace cd {

struct SpaceShape {
	ShapeKind kind = ShapeKind::disk; // disk: a sphere
	Vector3 half { 0, 0, 0 }; // box: half lengths along its own axes [m]
	// Box: its axes, unit vectors of the world. Facet: its corners, from the body's position, in the axes of the world [m].
	Vector3 part[3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	int axis = 0, sense = 0; // wall, as in the plane

	// Box: of the point with these coordinates in its own axes.
	Vector3 fromOwn(const Vector3& d) const { return d.x * part[0] + d.y * part[1] + d.z * part[2]; }
	Vector3 toOwn(const Vector3& d) const { return { dot(part[0], d), dot(part[1], d), dot(part[2], d) }; }
};

inline bool operator==(const SpaceShape& s, const SpaceShape& o)
{
	return s.kind == o.kind && s.half == o.half && s.axis == o.axis && s.sense == o.sense && s.part[0] == o.part[0] && s.part[1] == o.part[1]
	    && s.part[2] == o.part[2];
}

// The vector turned by the rotation with this axis times angle [rad] (Rodrigues).
inline Vector3 rotated(const Vector3& v, const Vector3& by)
{
	const double square = dot(by, by), angle = std::sqrt(square);
	if (angle == 0)
		return v;
	const Vector3 axis = 1 / angle * by;
	return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}
inline SpaceShape rotated(const SpaceShape& shape, const Vector3& by)
{
	SpaceShape turned = shape;
	for (Vector3& part : turned.part)
		part = rotated(part, by);
	return turned;
}

// Half the sides of the axis-parallel bounding box of a body [m], about its position.
Vector3 halfSides(const SpaceBody&, const SpaceShape&);
// From its position to its farthest point [m].
inline double farthest(const SpaceShape& s)
{
	if (s.kind == ShapeKind::box)
		return length(s.half);
	return s.kind == ShapeKind::facet ? std::max({ length(s.part[0]), length(s.part[1]), length(s.part[2]) }) : 0;
}
// How far its outline has moved by turning, at most [m]; infinite if it is another shape.
double turnedWay(const SpaceShape& now, const SpaceShape& then);

inline double outlineSpeed(const double* v, const SpaceBody& b, const SpaceShape& shape)
{
	const double speed = length(vectorOf(v));
	return isBoundary(b) ? speed + length(vectorOf(v + 3)) * farthest(shape) : speed;
}
inline double wayOf(const SpaceBody& b, const SpaceShape& shape, const double* free, double dt)
{
	if (!isBoundary(b))
		return dt * std::sqrt(std::max(dot(vectorOf(free), vectorOf(free)), dot(velocityOf(b), velocityOf(b))));
	return dt * std::max(outlineSpeed(free, b, shape), outlineSpeed(b.v, b, shape));
}
inline double wayOf(const SpaceBody& b, const SpaceShape& shape, double dt)
{
	double free[Space3::freedoms];
	for (int k = 0; k < Space3::freedoms; k++)
		free[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
	return wayOf(b, shape, free, dt);
}

} // namespace cd
