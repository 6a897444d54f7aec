// Where a disk touches a boundary: a box turned in the plane, an axis-parallel wall.
#include "scene/contact_geometry.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {
namespace {

	double along(int axis, Vector d) { return axis == 0 ? d.x : d.y; }
	Vector unit(int axis, double side) { return axis == 0 ? Vector { side, 0 } : Vector { 0, side }; }
	Vector toDisk(const Place& boundary, const Place& disk) { return { disk.x - boundary.x, disk.y - boundary.y }; }

	// The axes of a box; `turned`: rotation beyond the orientation stored in its shape [rad].
	struct Axes {
		Vector axis;

		Axes(const Shape& box, double turned)
		{
			const double c = turned == 0 ? 1 : std::cos(turned), s = turned == 0 ? 0 : std::sin(turned); // most boundaries do not turn
			axis = { box.cosine * c - box.sine * s, box.sine * c + box.cosine * s };
		}
		Vector local(Vector d) const { return { dot(axis, d), cross(axis, d) }; }
		Foot foot(Vector n, double distance) const { return { axis.x * n.x - axis.y * n.y, axis.y * n.x + axis.x * n.y, distance }; }
	};

	Foot footOnBox(const Shape& box, double turned, Vector centre)
	{
		const Axes axes(box, turned);
		const Vector d = axes.local(centre);
		const Vector out { d.x - std::clamp(d.x, -box.ex, box.ex), d.y - std::clamp(d.y, -box.ey, box.ey) };
		if (out.x != 0 && out.y != 0) { // beyond a corner
			const double distance = length(out);
			return axes.foot({ out.x / distance, out.y / distance }, distance);
		}
		// Over a face, or inside: then the nearest face.
		const Vector from { std::abs(d.x) - box.ex, std::abs(d.y) - box.ey };
		const int face = from.x > from.y ? 0 : 1;
		return axes.foot(unit(face, std::copysign(1., along(face, d))), along(face, from));
	}

	// The foot on one side of a wall.
	Foot footOnWall(const Shape& wall, double side, Vector centre)
	{
		const Vector n = unit(wall.axis, side);
		return { n.x, n.y, side * along(wall.axis, centre) };
	}

	// The axis of the face through which a point enters a box of half lengths e on its way from `from` to `to`, all in the box's axes; -1: none.
	int faceEntered(Vector from, Vector to, Vector e)
	{
		double latest = -1;
		int face = -1;
		for (const int k : { 0, 1 }) {
			const double start = along(k, from), half = along(k, e);
			if (std::abs(start) <= half)
				continue;
			const double share = (std::copysign(half, start) - start) / (along(k, to) - start);
			if (share > latest) {
				latest = share;
				face = k;
			}
			if (!(share >= 0 && share <= 1))
				return -1;
		}
		const Vector there = from + latest * (to - from);
		return face >= 0 && std::abs(along(1 - face, there)) <= along(1 - face, e) ? face : -1;
	}

} // namespace

Half halfSides(const Body& body, const Shape& shape)
{
	if (!isBoundary(body))
		return { body.radius, body.radius };
	if (shape.kind == ShapeKind::wall)
		return { shape.axis == 0 ? 0 : endless, shape.axis == 1 ? 0 : endless };
	const double c = std::abs(shape.cosine), s = std::abs(shape.sine);
	return { c * shape.ex + s * shape.ey, s * shape.ex + c * shape.ey };
}

bool comesThrough(const Shape& shape, const Place& boundaryBefore, const Place& diskBefore, const Place& boundary, const Place& disk, Foot& face)
{
	const Vector before = toDisk(boundaryBefore, diskBefore), now = toDisk(boundary, disk);
	if (shape.kind == ShapeKind::wall) {
		const double side = std::copysign(1., along(shape.axis, before));
		face = footOnWall(shape, side, now);
		return face.distance < 0 && shape.sense * side >= 0;
	}
	const Axes axes(shape, boundary.turned);
	const Vector from = Axes(shape, boundaryBefore.turned).local(before), to = axes.local(now), e { shape.ex, shape.ey };
	const int k = faceEntered(from, to, e);
	if (k < 0)
		return false;
	const double side = std::copysign(1., along(k, from));
	face = axes.foot(unit(k, side), side * along(k, to) - along(k, e));
	return true;
}

// In the axes (n, t) of the face, the disk's centre begins at (b, s) relative to the centre of the box and ends at (b', s'); the box turns by w. The
// disk keeps the required distance if b' cos w + s' sin w = touching. This equation gives b'. With h u_n = b' - b + w s, the condition h u_n + gap +
// change >= 0 then gives the change.
double gapByTurning(
    const Shape& shape, const Place& box, const Place& disk, const Touch& touch, double touching, double spin, Vector velocity, double h)
{
	const Vector d = toDisk(box, disk), n { touch.nx, touch.ny };
	const double w = h * spin;
	if (isBeyondCorner(shape, box, disk))
		return 0; // a corner is a point: its path bends away from the disk
	if (!(std::abs(w) < 1))
		return 0; // more than a radian a step: the disk meets no definite face
	const double s = cross(n, d), after = s + h * cross(n, velocity);
	return touching * (1 - 1 / std::cos(w)) + after * std::tan(w) - w * s;
}

bool isBeyondCorner(const Shape& shape, const Place& boundary, const Place& disk)
{
	if (shape.kind != ShapeKind::box)
		return false;
	const Vector local = Axes(shape, boundary.turned).local(toDisk(boundary, disk));
	return std::abs(local.x) > shape.ex && std::abs(local.y) > shape.ey;
}

Foot footOnBoundary(const Shape& shape, double turned, Vector centre)
{
	assert(shape.kind != ShapeKind::disk);
	if (shape.kind == ShapeKind::box)
		return footOnBox(shape, turned, centre);
	return footOnWall(shape, shape.sense != 0 ? shape.sense : std::copysign(1., along(shape.axis, centre)), centre);
}

} // namespace cd
