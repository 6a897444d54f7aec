// Where a disk touches a boundary: a box turned in the plane, an axis-parallel wall.
#include "world.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	// `turned`: rotation of the box beyond the orientation stored in its shape [rad].
	Foot footOnBox(const Shape& box, double turned, double dx, double dy)
	{
		const double c = std::cos(turned), s = std::sin(turned);
		const double cosine = box.cosine * c - box.sine * s, sine = box.sine * c + box.cosine * s;
		// Into the box's own axes.
		const double lx = cosine * dx + sine * dy, ly = -sine * dx + cosine * dy;
		const double ox = lx - std::clamp(lx, -box.ex, box.ex), oy = ly - std::clamp(ly, -box.ey, box.ey);
		double nx, ny, distance;
		if (ox != 0 && oy != 0) { // beyond a corner
			distance = std::hypot(ox, oy);
			nx = ox / distance;
			ny = oy / distance;
		} else {
			// Over a face, or inside (then the face that is left by the shortest way).
			const double outX = std::abs(lx) - box.ex, outY = std::abs(ly) - box.ey;
			const bool alongX = outX > outY;
			distance = alongX ? outX : outY;
			nx = alongX ? std::copysign(1., lx) : 0.;
			ny = alongX ? 0. : std::copysign(1., ly);
		}
		return { cosine * nx - sine * ny, sine * nx + cosine * ny, distance };
	}

	Foot footOnWall(const Shape& wall, double dx, double dy)
	{
		const double d = wall.axis == 0 ? dx : dy;
		const double side = wall.sense != 0 ? wall.sense : std::copysign(1., d);
		return { wall.axis == 0 ? side : 0., wall.axis == 0 ? 0. : side, side * d };
	}

} // namespace

Foot footOnBoundary(const Shape& shape, double turned, double dx, double dy)
{
	return shape.kind == ShapeKind::box ? footOnBox(shape, turned, dx, dy) : footOnWall(shape, dx, dy);
}

} // namespace cd
