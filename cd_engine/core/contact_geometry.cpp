// Where a disk touches a boundary: a box turned in the plane, an axis-parallel wall.
#include "world.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	// The axes of a box; `turned`: rotation beyond the orientation stored in its shape [rad].
	struct Axes {
		double cosine, sine;

		Axes(const Shape& box, double turned)
		{
			const double c = turned == 0 ? 1 : std::cos(turned), s = turned == 0 ? 0 : std::sin(turned); // most boundaries do not turn
			cosine = box.cosine * c - box.sine * s;
			sine = box.sine * c + box.cosine * s;
		}
		double along(double dx, double dy) const { return cosine * dx + sine * dy; }
		double across(double dx, double dy) const { return -sine * dx + cosine * dy; }
		Foot foot(double nx, double ny, double distance) const { return { cosine * nx - sine * ny, sine * nx + cosine * ny, distance }; }
	};

	Foot footOnBox(const Shape& box, double turned, double dx, double dy)
	{
		const Axes axes(box, turned);
		const double lx = axes.along(dx, dy), ly = axes.across(dx, dy);
		const double ox = lx - std::clamp(lx, -box.ex, box.ex), oy = ly - std::clamp(ly, -box.ey, box.ey);
		double nx, ny, distance;
		if (ox != 0 && oy != 0) { // beyond a corner
			distance = std::hypot(ox, oy);
			nx = ox / distance;
			ny = oy / distance;
		} else {
			// Over a face, or inside: then the nearest face.
			const double outX = std::abs(lx) - box.ex, outY = std::abs(ly) - box.ey;
			const bool alongX = outX > outY;
			distance = alongX ? outX : outY;
			nx = alongX ? std::copysign(1., lx) : 0.;
			ny = alongX ? 0. : std::copysign(1., ly);
		}
		return axes.foot(nx, ny, distance);
	}

	Foot footOnWall(const Shape& wall, double dx, double dy)
	{
		const double d = wall.axis == 0 ? dx : dy;
		const double side = wall.sense != 0 ? wall.sense : std::copysign(1., d);
		return { wall.axis == 0 ? side : 0., wall.axis == 0 ? 0. : side, side * d };
	}

	// The axis of the face through which a point enters a box of half lengths e on its way from `from` to `to`, both in the box's axes; -1: none.
	int faceEntered(const double* from, const double* to, const double* e)
	{
		double latest = -1;
		int face = -1;
		for (const int k : { 0, 1 }) {
			if (std::abs(from[k]) <= e[k])
				continue;
			const double share = (std::copysign(e[k], from[k]) - from[k]) / (to[k] - from[k]);
			if (share > latest) {
				latest = share;
				face = k;
			}
			if (!(share >= 0 && share <= 1))
				return -1;
		}
		const int other = 1 - face;
		return face >= 0 && std::abs(from[other] + latest * (to[other] - from[other])) <= e[other] ? face : -1;
	}

} // namespace

Half halfSides(const Body& body, const Shape& shape)
{
	if (body.radius > 0)
		return { body.radius, body.radius };
	if (shape.kind == ShapeKind::wall)
		return { shape.axis == 0 ? 0 : endless, shape.axis == 1 ? 0 : endless };
	const double c = std::abs(shape.cosine), s = std::abs(shape.sine);
	return { c * shape.ex + s * shape.ey, s * shape.ex + c * shape.ey };
}

bool comesThrough(const Shape& shape, const Place& boundaryBefore, const Place& diskBefore, const Place& boundary, const Place& disk, Foot& face)
{
	const double fx = diskBefore.x - boundaryBefore.x, fy = diskBefore.y - boundaryBefore.y, dx = disk.x - boundary.x, dy = disk.y - boundary.y;
	if (shape.kind == ShapeKind::wall) {
		const double from = shape.axis == 0 ? fx : fy, to = shape.axis == 0 ? dx : dy, side = std::copysign(1., from);
		face = { shape.axis == 0 ? side : 0., shape.axis == 0 ? 0. : side, side * to };
		return side * to < 0 && shape.sense * side >= 0;
	}
	const Axes then(shape, boundaryBefore.turned), now(shape, boundary.turned);
	const double from[2] = { then.along(fx, fy), then.across(fx, fy) }, to[2] = { now.along(dx, dy), now.across(dx, dy) };
	const double e[2] = { shape.ex, shape.ey };
	const int k = faceEntered(from, to, e);
	if (k < 0)
		return false;
	const double side = std::copysign(1., from[k]);
	face = now.foot(k == 0 ? side : 0., k == 1 ? side : 0., side * to[k] - e[k]);
	return true;
}

// In the axes (n, t) of the face, the disk's centre begins at (b, s) relative to the centre of the box and ends at (b', s'); the box turns by w. The
// disk keeps the required distance if b' cos w + s' sin w = touching. This equation gives b'. With h u_n = b' - b + w s, the condition h u_n + gap +
// change >= 0 then gives the change.
double gapByTurning(
    const Shape& shape, const Place& box, const Place& disk, const Touch& touch, double touching, const double* vBox, const double* vDisk, double h)
{
	const double w = h * vBox[2], dx = disk.x - box.x, dy = disk.y - box.y;
	const Axes axes(shape, box.turned);
	if (std::abs(axes.along(dx, dy)) > shape.ex && std::abs(axes.across(dx, dy)) > shape.ey)
		return 0; // beyond a corner, which is a point: its path bends away from the disk
	if (!(std::abs(w) < 1))
		return 0; // more than a radian a step: the disk meets no definite face
	const double s = touch.nx * dy - touch.ny * dx;
	const double after = s + h * (touch.nx * (vDisk[1] - vBox[1]) - touch.ny * (vDisk[0] - vBox[0]));
	return touching * (1 - 1 / std::cos(w)) + after * std::tan(w) - w * s;
}

Foot footOnBoundary(const Shape& shape, double turned, double dx, double dy)
{
	return shape.kind == ShapeKind::box ? footOnBox(shape, turned, dx, dy) : footOnWall(shape, dx, dy);
}

} // namespace cd
