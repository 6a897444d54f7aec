// Where a sphere touches a boundary in space: a box turned at will, an axis-parallel wall, a facet with two sides.
#include "scene/geometry_in_space.hpp"

#include <cassert>

namespace cd {
namespace {

	Vector3 unit(int axis, double side)
	{
		Vector3 n { 0, 0, 0 };
		n[axis] = side;
		return n;
	}

	SpaceFoot footOnBox(const SpaceShape& box, const Vector3& centre)
	{
		const Vector3 d = box.toOwn(centre);
		Vector3 out { 0, 0, 0 };
		int beyond = 0, face = 0;
		double depth = -endless;
		for (int k = 0; k < 3; k++) {
			out[k] = d[k] - std::clamp(d[k], -box.half[k], box.half[k]);
			beyond += out[k] != 0;
			if (const double from = std::abs(d[k]) - box.half[k]; from > depth) {
				depth = from;
				face = k;
			}
		}
		if (beyond > 1) {
			const double distance = length(out);
			return { box.fromOwn(1 / distance * out), distance, true };
		}
		return { std::copysign(1., d[face]) * box.part[face], depth, false }; // over a face, or inside: then the nearest face
	}

	SpaceFoot footOnWall(const SpaceShape& wall, double side, const Vector3& centre)
	{
		return { unit(wall.axis, side), side * centre[wall.axis], false };
	}

	// The point of a triangle nearest to p (Ericson 2005, Real-Time Collision Detection, section 5.1.5). feature: it is on an edge or a corner.
	Vector3 nearestOnTriangle(const Vector3* corner, const Vector3& p, bool& feature)
	{
		const Vector3 &a = corner[0], &b = corner[1], &c = corner[2], ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
		const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
		feature = true;
		if (d1 <= 0 && d2 <= 0)
			return a;
		if (d3 >= 0 && d4 <= d3)
			return b;
		if (d6 >= 0 && d5 <= d6)
			return c;
		const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
		if (vc <= 0 && d1 >= 0 && d3 <= 0)
			return a + d1 / (d1 - d3) * ab;
		if (vb <= 0 && d2 >= 0 && d6 <= 0)
			return a + d2 / (d2 - d6) * ac;
		if (va <= 0 && d4 >= d3 && d5 >= d6)
			return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
		feature = false;
		const double scale = 1 / (va + vb + vc);
		return a + vb * scale * ab + vc * scale * ac;
	}

	Vector3 normalOf(const SpaceShape& facet)
	{
		const Vector3 n = cross(facet.part[1] - facet.part[0], facet.part[2] - facet.part[0]);
		return 1 / length(n) * n;
	}

	SpaceFoot footOnPlane(const SpaceShape& facet, const Vector3& centre)
	{
		const Vector3 n = normalOf(facet);
		const double above = dot(n, centre - facet.part[0]);
		return { above < 0 ? -n : n, std::abs(above), false };
	}

	SpaceFoot footOnFacet(const SpaceShape& facet, const Vector3& centre)
	{
		bool feature;
		const Vector3 way = centre - nearestOnTriangle(facet.part, centre, feature);
		if (!feature) // its distance is known better from the plane
			return footOnPlane(facet, centre);
		const double distance = length(way);
		return distance > 0 ? SpaceFoot { 1 / distance * way, distance, true } : SpaceFoot { normalOf(facet), 0, false };
	}

	// Of the way of a point relative to a box, in its axes: the face through which it enters.
	bool entersBox(const SpaceShape& box, const Vector3& from, const Vector3& to, SpaceFoot& face)
	{
		double latest = -1;
		int entered = -1;
		for (int k = 0; k < 3; k++) {
			if (std::abs(from[k]) <= box.half[k])
				continue;
			const double share = (std::copysign(box.half[k], from[k]) - from[k]) / (to[k] - from[k]);
			if (!(share >= 0 && share <= 1))
				return false;
			if (share > latest) {
				latest = share;
				entered = k;
			}
		}
		if (entered < 0)
			return false;
		const Vector3 there = from + latest * (to - from);
		for (int k = 0; k < 3; k++)
			if (k != entered && std::abs(there[k]) > box.half[k])
				return false;
		const double side = std::copysign(1., from[entered]);
		face = { side * box.part[entered], side * to[entered] - box.half[entered], false };
		return true;
	}

	bool crossesFacet(const SpaceShape& was, const Vector3& before, const SpaceShape& facet, const Vector3& now, SpaceFoot& face)
	{
		const double from = dot(normalOf(was), before - was.part[0]), side = std::copysign(1., from);
		const Vector3 n = side * normalOf(facet);
		const double to = dot(n, now - facet.part[0]);
		if (!(to < 0))
			return false;
		const double share = std::abs(from) / (std::abs(from) - to);
		bool feature;
		const Vector3 there = before + share * (now - before);
		const Vector3 nearest = nearestOnTriangle(facet.part, there, feature);
		face = { n, to, false };
		return !feature || length(nearest - there) <= 1e-9 * farthest(facet);
	}

} // namespace

Vector3 halfSides(const SpaceBody& body, const SpaceShape& shape)
{
	if (!isBoundary(body))
		return { body.radius, body.radius, body.radius };
	Vector3 half { 0, 0, 0 };
	for (int k = 0; k < 3; k++)
		if (shape.kind == ShapeKind::wall)
			half[k] = shape.axis == k ? 0 : endless;
		else if (shape.kind == ShapeKind::box)
			half[k] = std::abs(shape.part[0][k]) * shape.half.x + std::abs(shape.part[1][k]) * shape.half.y
			    + std::abs(shape.part[2][k]) * shape.half.z;
		else
			half[k] = std::max({ std::abs(shape.part[0][k]), std::abs(shape.part[1][k]), std::abs(shape.part[2][k]) });
	return half;
}

double turnedWay(const SpaceShape& now, const SpaceShape& then)
{
	if (now.kind != then.kind || !(now.half == then.half) || now.axis != then.axis || now.sense != then.sense)
		return endless;
	double way = 0;
	for (int k = 0; k < 3; k++)
		if (now.kind == ShapeKind::box)
			way += now.half[k] * length(now.part[k] - then.part[k]);
		else if (now.kind == ShapeKind::facet)
			way = std::max(way, length(now.part[k] - then.part[k]));
	return way;
}

SpaceFoot footOnBoundary(const SpaceShape& shape, const Vector3& centre)
{
	assert(shape.kind != ShapeKind::disk);
	if (shape.kind == ShapeKind::box)
		return footOnBox(shape, centre);
	if (shape.kind == ShapeKind::facet)
		return footOnFacet(shape, centre);
	return footOnWall(shape, shape.sense != 0 ? shape.sense : std::copysign(1., centre[shape.axis]), centre);
}

bool footBeyondEdge(const SpaceShape& facet, const Vector3& centre, Vector3& nearest, SpaceFoot& foot)
{
	bool feature;
	nearest = nearestOnTriangle(facet.part, centre, feature);
	foot = footOnPlane(facet, centre);
	return feature && !(nearest == facet.part[0] || nearest == facet.part[1] || nearest == facet.part[2]);
}

bool comesThrough(const SpaceShape& was, const Vector3& before, const SpaceShape& shape, const Vector3& now, SpaceFoot& face)
{
	if (shape.kind == ShapeKind::box)
		return entersBox(shape, was.toOwn(before), shape.toOwn(now), face);
	if (shape.kind == ShapeKind::facet)
		return crossesFacet(was, before, shape, now, face);
	const double side = std::copysign(1., before[shape.axis]);
	face = footOnWall(shape, side, now);
	return face.distance < 0 && shape.sense * side >= 0;
}

} // namespace cd
