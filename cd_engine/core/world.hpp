// The bodies of a plane scene and the pairs that may touch: what a time step reads and moves. Knows neither YADE nor Python.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace cd {

enum class ShapeKind : uint8_t { disk, box, wall };

// Of a boundary; a disk has its radius and no more.
struct Shape {
	ShapeKind kind = ShapeKind::disk;
	double ex = 0, ey = 0; // box: half lengths along its own axes [m]
	double cosine = 1, sine = 0; // box: its orientation in the plane
	int axis = 0; // wall: the axis it is perpendicular to, 0 = x, 1 = y
	int sense = 0; // wall: the side it acts on, -1, +1, or 0 for both
};

struct Body {
	double x = 0, y = 0, turn = 0; // position [m]; rotation made in this step [rad]
	double v[3] = { 0, 0, 0 }; // v_x, v_y [m/s], angular velocity [rad/s]
	double inverseMass[3] = { 0, 0, 0 }; // along x, y [1/kg] and about z [1/(kg m^2)]; 0: that freedom is blocked, its velocity prescribed
	double force[3] = { 0, 0, 0 }; // external force [N] and torque [N m], gravity included
	double radius = 0; // of a disk [m]; 0: a boundary
	double friction = 0; // coefficient of its surface; a pair takes the smaller of two
};

// Two bodies near each other. `a` is the boundary where one is a boundary; two boundaries never touch.
struct Pair {
	int32_t a, b;
	double mu = 0; // friction coefficient
	double reference = 0; // overlap [m] that counts as touching (left behind by springs); forgotten once the bodies are apart
	double pn = 0, pt = 0; // impulse on b [N s]: first guess before the step, solution after it
};

// Where a pair is, or would be, in contact.
struct Touch {
	double nx, ny; // unit normal a -> b
	double cx, cy; // contact point, midway between the surfaces [m]
	double overlap; // geometric overlap [m], negative: apart
};

struct World {
	std::vector<Body> bodies;
	std::vector<Shape> shapes; // of the bodies; apart from them, since those of disks are never read
	// Of each body: two make a pair only if their masks have a bit in common; 0: in no contact. Bodies of one mask that has a bit of `apart` make
	// none.
	std::vector<int32_t> masks;
	int32_t apart = 0;
	std::vector<Pair> pairs;
	// Of each body [m]: two bodies are in the list of pairs if the gap between them is at most the sum of their two values. Empty: all pairs are
	// listed.
	std::vector<double> listed;
	std::vector<int32_t> awake; // the pairs that a step looks at, in order, no others: Sleepers::look lists them before every step
};

// Where a body is for the purpose of contacts: small, so that the places of many bodies stay in the nearest cache.
struct Place {
	double x, y; // [m]
	double turned; // rotation beyond the orientation stored in its shape [rad]
	double radius; // of a disk [m]; 0: a boundary
};

// The place of a body after `ahead` [s] at its present velocities.
inline Place placeAhead(const Body& b, double ahead) { return { b.x + ahead * b.v[0], b.y + ahead * b.v[1], ahead * b.v[2], b.radius }; }

// The largest speed of any point of a body's outline that moves the outline there [m/s]: a disk's does not when it spins. v: of the body.
inline double outlineSpeed(const double* v, const Body& b, const Shape& shape)
{
	const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1]);
	return b.radius > 0 || shape.kind != ShapeKind::box ? speed : speed + std::abs(v[2]) * std::hypot(shape.ex, shape.ey);
}

// The way a body goes in a step of dt, at its velocity before it or at the one that its external forces alone would leave, the longer one; of a
// boundary that turns, its farthest point [m].
inline double wayOf(const Body& b, const Shape& shape, double dt)
{
	double free[3];
	for (int k = 0; k < 3; k++)
		free[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
	return dt * std::max(outlineSpeed(free, b, shape), outlineSpeed(b.v, b, shape));
}

constexpr double endless = std::numeric_limits<double>::infinity();

// Half the sides of the box, parallel to the axes, around a body [m]; a Wall is endless along itself.
struct Half {
	double x, y;
};
Half halfSides(const Body&, const Shape&);

// Surface point of a boundary nearest to a disk: its outward normal, and the signed distance of the disk's centre from it [m].
struct Foot {
	double nx, ny, distance;
};

// (dx, dy): the disk's centre from the boundary's [m].
Foot footOnBoundary(const Shape&, double turned, double dx, double dy);
// Whether the centre of a disk came into a boundary, or right through it, on its way from a place before to one now; if so, by which face.
bool comesThrough(const Shape&, const Place& boundaryBefore, const Place& diskBefore, const Place& boundary, const Place& disk, Foot& face);

// What the turning of a box changes in the gap to a disk within a step h [s], beyond gap + h u_n [m]: exact for a given way along its face.
// touching: the distance of the disk's centre from that of the box, along the normal, that is to be kept [m].
double gapByTurning(
    const Shape&, const Place& box, const Place& disk, const Touch&, double touching, const double* vBox, const double* vDisk, double h);

inline Touch touchAt(const Foot& foot, const Place& disk)
{
	const double gap = foot.distance - disk.radius;
	// Both bodies take the impulse at one point, or angular momentum would be lost with the gap.
	const double arm = disk.radius + 0.5 * gap;
	return { foot.nx, foot.ny, disk.x - arm * foot.nx, disk.y - arm * foot.ny, -gap };
}

// `shape` is that of `a`, read if it is a boundary.
inline Touch locateContact(const Place& a, const Place& b, const Shape& shape)
{
	const double dx = b.x - a.x, dy = b.y - a.y;
	Foot foot;
	if (a.radius > 0) {
		const double centres = std::sqrt(dx * dx + dy * dy), inverse = 1 / centres;
		foot = { dx * inverse, dy * inverse, centres - a.radius };
	} else
		foot = footOnBoundary(shape, a.turned, dx, dy);
	return touchAt(foot, b);
}

} // namespace cd
