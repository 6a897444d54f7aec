// The bodies of a plane scene and the pairs of bodies that may touch. A time step reads and moves them. Nothing here depends on YADE or Python.
#pragma once

#include "scene/vector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace cd {

enum class ShapeKind : uint8_t { disk, box, wall };

// The shape of a boundary. The radius in Body describes a disk completely.
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
	double inverseMass[3] = { 0, 0, 0 }; // along x, y [1/kg] and about z [1/(kg m^2)]; 0: this freedom is blocked and its velocity is prescribed
	double force[3] = { 0, 0, 0 }; // external force [N] and torque [N m], gravity included
	double radius = 0; // of a disk [m]; 0: the body is a boundary
	double friction = 0; // coefficient of friction of the surface; a pair uses the smaller of its two
};

// Whether no force changes the motion of a body, so that it is known before the step is solved.
inline bool isGuided(const Body& b) { return b.inverseMass[0] == 0 && b.inverseMass[1] == 0 && b.inverseMass[2] == 0; }

// Two bodies near each other. If one of them is a boundary, it is `a`. Two boundaries never touch.
struct Pair {
	int32_t a, b;
	double mu = 0; // friction coefficient
	double reference = 0; // overlap that counts as zero gap [m], left behind by springs; reset to 0 once the bodies separate
};

// The force of a contact after the last step, as a scene keeps it. Times the length of the next step it is that step's first guess.
struct alignas(64) Carried {
	static constexpr long nothing = std::numeric_limits<long>::min();
	double nx = 0, ny = 0; // unit normal a -> b in that step
	double fn[2] = { 0, 0 }, ft[2] = { 0, 0 }; // normal and tangential force on b [N]
	long since = nothing; // step in which the contact became loaded; `nothing`: it carries nothing, and the other members are 0

	bool any() const { return since != nothing; }
	// Whether it is the same force; `since` may differ.
	bool same(const Carried& o) const
	{
		return any() == o.any() && nx == o.nx && ny == o.ny && fn[0] == o.fn[0] && fn[1] == o.fn[1] && ft[0] == o.ft[0] && ft[1] == o.ft[1];
	}
	// Along the normal, and across it, times dt [N s].
	std::array<double, 2> impulse(double dt) const
	{
		const double normal = nx * fn[0] + ny * fn[1], tangential = nx * ft[1] - ny * ft[0];
		if (!(normal > 0) || !std::isfinite(tangential))
			return { 0, 0 }; // springs may pull; a rigid contact does not
		// n is a unit vector only to its last digit. Without this division, forces that are stored and read again would grow by that step by
		// step.
		const double square = nx * nx + ny * ny;
		return { dt * normal / square, dt * tangential / square };
	}
};
static_assert(sizeof(Carried) == 64 && offsetof(Carried, ft) == 32);

// The contact geometry of a pair; if the bodies are apart, where they would touch.
struct Touch {
	double nx, ny; // unit normal a -> b
	double cx, cy; // contact point, midway between the surfaces [m]
	double overlap; // geometric overlap [m], negative: apart
};

struct World {
	std::vector<Body> bodies;
	std::vector<Shape> shapes; // one a body; stored separately from the bodies, because the shapes of disks are never read
	// Of each body: two bodies make a pair only if their masks share a bit, but not if both have one mask and it has a bit of `apart`. 0: the
	// body has no contacts.
	std::vector<int32_t> masks;
	int32_t apart = 0;
	std::vector<Pair> pairs;
	std::vector<Carried> carried; // by the contacts of the pairs
	// Of each body [m]: the list of pairs holds every two bodies whose gap is at most the sum of their two values. Empty: all pairs are listed.
	std::vector<double> listed;
	long listing = 0; // number of the list of pairs; a new list gets a new number. 0: not numbered, so each step compares the lists
	std::vector<int32_t> awake; // indices of the pairs that a step looks at, ascending; Sleepers::look fills it before every step
};

// Whether no force can keep the two bodies of a pair apart. Such pairs have contacts, but their overlap means nothing: fixed disks that make a fixed
// floor rough may be half sunk in it.
inline bool isGuided(const World& world, const Pair& pair) { return isGuided(world.bodies[pair.a]) && isGuided(world.bodies[pair.b]); }

// The position of a body as the contact geometry needs it. It is small, so that those of many bodies stay in the first-level cache.
struct alignas(32) Place {
	double x, y; // [m]
	double turned; // rotation beyond the orientation stored in its shape [rad]
	double radius; // of a disk [m]; 0: a boundary
};
static_assert(sizeof(Place) == 32);

// The motion of a body in a step.
struct alignas(32) Mean {
	double v[3]; // mean of the velocities before and after the step
	double speed; // speed of the fastest point of its outline after the step, which bounds its motion [m/s]
};
static_assert(sizeof(Mean) == 32);

// The place of a body after `ahead` [s] at its present velocities.
inline Place placeAhead(const Body& b, double ahead) { return { b.x + ahead * b.v[0], b.y + ahead * b.v[1], ahead * b.v[2], b.radius }; }

// The largest speed at which a point of a body moves its outline [m/s]. The spin of a disk does not move its outline. v: velocity of the body.
inline double outlineSpeed(const double* v, const Body& b, const Shape& shape)
{
	const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1]);
	return b.radius > 0 || shape.kind != ShapeKind::box ? speed : speed + std::abs(v[2]) * std::hypot(shape.ex, shape.ey);
}

// The distance that a body may move in a step of dt [m]; if it turns, that of its farthest point. Uses the velocity before the step or the one that
// the external forces alone would leave, whichever gives more.
inline double wayOf(const Body& b, const Shape& shape, const double* free, double dt)
{
	if (b.radius > 0) // the larger of two roots is that of the larger square, to the last bit
		return dt * std::sqrt(std::max(free[0] * free[0] + free[1] * free[1], b.v[0] * b.v[0] + b.v[1] * b.v[1]));
	return dt * std::max(outlineSpeed(free, b, shape), outlineSpeed(b.v, b, shape));
}
inline double wayOf(const Body& b, const Shape& shape, double dt)
{
	double free[3];
	for (int k = 0; k < 3; k++)
		free[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
	return wayOf(b, shape, free, dt);
}

constexpr double endless = std::numeric_limits<double>::infinity();

// Half the sides of the axis-parallel bounding box of a body [m]. A Wall is endless along itself.
struct Half {
	double x, y;
};
Half halfSides(const Body&, const Shape&);

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
	const Vector d { b.x - a.x, b.y - a.y };
	Foot foot;
	if (a.radius > 0) {
		const double centres = std::sqrt(dot(d, d)), inverse = 1 / centres;
		foot = centres > 0 ? Foot { d.x * inverse, d.y * inverse, centres - a.radius } : Foot { 1, 0, -a.radius }; // any direction parts them
	} else
		foot = footOnBoundary(shape, a.turned, d);
	return touchAt(foot.nx, foot.ny, foot.distance - b.radius, b);
}

} // namespace cd
