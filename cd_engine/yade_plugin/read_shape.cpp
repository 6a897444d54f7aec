// Reads the class, the size and the orientation of a body's shape. Refuses what the engine does not know.
#include "scene_link.hpp"

#include <cmath>

namespace cd_engine {
namespace {

	// A clump is a body itself. Its id comes after those of its members, which need no test of their own for this.
	[[noreturn]] void refuseShape(int id, const std::string& name)
	{
		if (name == "Clump")
			refuseBody(id, "is a clump", releaseClump);
		refuseBody(id, "has the shape " + name, "Only Sphere (a disk), Box and Wall are known; replace or erase it");
	}

} // namespace

// Which of cd::ShapeKind a shape is, -1: none of them. The vtable identifies the class; the name of the class is asked for only once. The address of
// a shape identifies nothing, because a new shape may get the address of an old one.
int SceneLink::kindOf(const void* shape)
{
	static const char* const names[] = { "Sphere", "Box", "Wall" };
	const void* const vtable = *static_cast<const void* const*>(shape);
	for (std::size_t kind = 0; kind < vtables.size(); kind++)
		if (vtables[kind] == vtable)
			return static_cast<int>(kind);
	const std::string name = className(shape);
	for (std::size_t kind = 0; kind < vtables.size(); kind++)
		if (name == names[kind]) {
			vtables[kind] = vtable;
			return static_cast<int>(kind);
		}
	return -1;
}

// Reads class, size and orientation of the shape, any of which may change at any time.
void SceneLink::readShape(int id, cd::Body& body)
{
	KnownBody& known = bodies[id];
	const int found = kindOf(known.shape);
	if (found < 0)
		refuseShape(id, className(known.shape));
	const auto kind = static_cast<cd::ShapeKind>(found);
	cd::Shape& shape = world.shapes[id];
	if (shape.kind != kind) {
		shape = {};
		shape.kind = kind;
	}
	known.boundary = kind != cd::ShapeKind::disk;
	body.radius = 0;
	if (kind == cd::ShapeKind::disk)
		readDisk(id, body);
	else if (kind == cd::ShapeKind::box)
		readBox(id, shape);
	else
		readWall(id, shape);
}

void SceneLink::readDisk(int id, cd::Body& body)
{
	KnownBody& known = bodies[id];
	const double z = at<Vector3r>(known.state, layout.state_se3)[2], radius = at<double>(known.shape, layout.sphere_radius);
	if (!(radius > 0 && std::isfinite(radius)))
		refuseBody(id, "has the radius " + text(radius) + " m", "Set " + ofBody(id) + ".shape.radius to a positive number");
	if (!(std::abs(z - layer) <= 1e-9 * radius))
		refuseBody(id, "has z = " + text(z) + " m but body #" + std::to_string(layerId) + " has z = " + text(layer) + " m",
		    "Put all disks in one plane: set the third component of their state.pos");
	known.inPlane = true;
	body.radius = radius;
}

void SceneLink::readBox(int id, cd::Shape& shape)
{
	KnownBody& known = bodies[id];
	const Vector3r& extents = at<Vector3r>(known.shape, layout.box_extents);
	if (!extents.allFinite() || extents[0] < 0 || extents[1] < 0 || extents[2] < 0)
		refuseBody(id, "is a box with the extents " + text(extents[0]) + ", " + text(extents[1]) + ", " + text(extents[2]) + " m",
		    "Set " + ofBody(id) + ".shape.extents, the halves of its edges, to numbers that are not negative");
	const auto& q = orientations[id];
	const double norm = q[2] * q[2] + q[3] * q[3];
	if (!(std::abs(q[0]) <= 1e-9 && std::abs(q[1]) <= 1e-9))
		refuseBody(id, "is a box turned out of the plane", "Turn it about z only: " + ofBody(id) + ".state.ori");
	if (!(norm > 0.5 && norm < 2))
		refuseBody(id, "has an orientation that is not a rotation", "Set " + ofBody(id) + ".state.ori to a unit quaternion");
	// A box that the disks' plane does not cut (a front or back wall) is never touched.
	known.inPlane = layerId < 0 || std::abs(at<Vector3r>(known.state, layout.state_se3)[2] - layer) <= extents[2] * (1 + 1e-9);
	shape.ex = extents[0];
	shape.ey = extents[1];
	orient(id);
}

// Computes the orientation of a box in the plane.
void SceneLink::orient(int id)
{
	const auto& q = orientations[id];
	const double norm = q[2] * q[2] + q[3] * q[3];
	world.shapes[id].cosine = (q[3] * q[3] - q[2] * q[2]) / norm;
	world.shapes[id].sine = 2 * q[2] * q[3] / norm;
}

// A wall is as wide as the plane, so it has no point to turn about.
void SceneLink::readWall(int id, cd::Shape& shape)
{
	KnownBody& known = bodies[id];
	const double spin = at<Vector3r>(known.state, layout.state_angVel)[2];
	if (spin != 0)
		refuseBody(id, "is a wall with the angular velocity " + text(spin) + " rad/s about z",
		    "Set " + ofBody(id) + ".state.angVel to 0, or use a Box, which can turn");
	if (!(at<unsigned>(known.state, layout.state_blockedDOFs) & rotZ))
		refuseBody(
		    id, "is a wall that is free to turn about z", "Block 'Z' in " + ofBody(id) + ".state.blockedDOFs, or use a Box, which can turn");
	shape.axis = at<int>(known.shape, layout.wall_axis);
	shape.sense = at<int>(known.shape, layout.wall_sense);
	if (shape.axis < 0 || shape.axis > 2)
		refuseBody(id, "is a wall with the axis " + std::to_string(shape.axis),
		    "Set " + ofBody(id) + ".shape.axis to 0 or 1, the axis it is perpendicular to (2: before or behind the plane, never touched)");
	if (shape.sense < -1 || shape.sense > 1)
		refuseBody(id, "is a wall with the sense " + std::to_string(shape.sense), "Set " + ofBody(id) + ".shape.sense to -1, 0 or 1");
	known.inPlane = shape.axis != 2;
}

} // namespace cd_engine
