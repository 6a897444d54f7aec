// Where two shapes touch.
#pragma once

#include "scene/shape.hpp"
#include "scene/vector.hpp"

#include <cassert>

namespace cd {

// The contact geometry of a pair; if the bodies are apart, where they would touch.
struct Touch {
	double nx, ny; // unit normal a -> b
	double cx, cy; // contact point, midway between the surfaces [m]
	double overlap; // geometric overlap [m], negative: apart
};

// The point of a boundary's surface nearest to a disk: its outward normal, and the signed distance of the disk's centre from the surface [m].
struct Foot {
	double nx, ny, distance;
};

// centre: that of the disk, from the centre of the boundary [m].
Foot footOnBoundary(const Shape&, double turned, Vector centre);
// Whether the point of a boundary that is nearest to a disk's centre is a corner of a box.
bool isBeyondCorner(const Shape&, const Place& boundary, const Place& disk);
// Whether the centre of a disk entered a boundary, or went right through it, between the places before and now; if so, through which face.
bool comesThrough(const Shape&, const Place& boundaryBefore, const Place& diskBefore, const Place& boundary, const Place& disk, Foot& face);

// The change of the gap between a box and a disk by the rotation of the box in a step h [s], beyond gap + h u_n [m]. It is exact if the motion of the
// disk along the face is given and the spin stays. touching: the distance along the normal from the box's centre to the disk's that is to be kept
// [m]; spin: of the box [rad/s]; velocity: of the disk's centre against that of the box [m/s].
double gapByTurning(const Shape&, const Place& box, const Place& disk, const Touch&, double touching, double spin, Vector velocity, double h);

inline Touch touchAt(double nx, double ny, double gap, const Place& disk)
{
	// Both bodies take the impulse at the same point. At two points, a gap apart, it would not conserve angular momentum.
	const double arm = disk.radius + 0.5 * gap;
	return { nx, ny, disk.x - arm * nx, disk.y - arm * ny, -gap };
}

// `shape` is the shape of `a`. It is read only if `a` is a boundary.
inline Touch locateContact(const Place& a, const Place& b, const Shape& shape)
{
	assert(!isBoundary(b));
	const Vector d { b.x - a.x, b.y - a.y };
	Foot foot;
	if (!isBoundary(a)) {
		const double centres = std::sqrt(dot(d, d)), inverse = 1 / centres;
		foot = centres > 0 ? Foot { d.x * inverse, d.y * inverse, centres - a.radius } : Foot { 1, 0, -a.radius }; // any direction parts them
	} else
		foot = footOnBoundary(shape, a.turned, d);
	assert(!(std::abs(foot.nx * foot.nx + foot.ny * foot.ny - 1) > 1e-9)); // NaN passes
	return touchAt(foot.nx, foot.ny, foot.distance - b.radius, b);
}

} // namespace cd
