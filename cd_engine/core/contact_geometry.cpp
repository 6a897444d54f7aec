// Where two bodies touch: disk on disk, disk on a box turned in the plane, disk on an axis-parallel wall.
#include "world.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	// Surface point of the boundary nearest to the disk, its outward normal, and the signed distance of the disk's centre from it.
	struct Foot {
		double nx, ny, distance;
	};

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

void locateContact(Pair& pair, const Place& a, const Place& b, const Shape& shape)
{
	const double dx = b.x - a.x, dy = b.y - a.y;
	double distance; // of the disk b's centre from a's surface
	if (a.radius > 0) {
		const double centres = std::sqrt(dx * dx + dy * dy), inverse = 1 / centres;
		pair.nx = dx * inverse;
		pair.ny = dy * inverse;
		distance = centres - a.radius;
	} else {
		const Foot foot = shape.kind == ShapeKind::box ? footOnBox(shape, a.turned, dx, dy) : footOnWall(shape, dx, dy);
		pair.nx = foot.nx;
		pair.ny = foot.ny;
		distance = foot.distance;
	}
	const double gap = distance - b.radius;
	// Both bodies take the impulse at one point, or angular momentum would be lost with the gap.
	const double arm = b.radius + 0.5 * gap;
	pair.cx = b.x - arm * pair.nx;
	pair.cy = b.y - arm * pair.ny;
	pair.overlap = -gap;
	pair.gap = gap + pair.reference;
}

} // namespace cd
