// Reads the class, the size and the orientation of a body's shape. Refuses what the engine does not know.
#include "kind.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cmath>

namespace cd_engine {

// Which of cd::ShapeKind a shape is, -1: none of them. The address of a shape identifies nothing, because a new shape may get the address of an old
// one.
int SceneLink::kindOf(const void* shape)
{
	static Kind kinds[] = { { "Sphere", Kind::exactly }, { "Box", Kind::exactly }, { "Wall", Kind::exactly } };
	const auto found = std::find_if(std::begin(kinds), std::end(kinds), [&](Kind& isKind) { return isKind(shape); });
	return found == std::end(kinds) ? -1 : static_cast<int>(found - kinds);
}

// Reads class, size and orientation of the shape, any of which may change at any time.
void SceneLink::readShape(int id, cd::Body& body)
{
	KnownBody& known = bodies[id];
	const int found = kindOf(known.shape);
	if (found < 0) {
		// A clump is a body itself. Its id comes after those of its members, which need no test of their own for this.
		const std::string name = className(known.shape);
		if (name == "Clump")
			refuseBody(id, "is a clump", releaseClump);
		refuseBody(id, "has the shape " + name, "Only Sphere (a disk), Box and Wall are known; replace or erase it");
	}
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
	const double z = state_pos(known.state)[2], radius = sphere_radius(known.shape);
	if (!(radius > 0 && std::isfinite(radius)))
		refuseBody(id, text("has the radius ", radius, " m"), "Set O.bodies[#].shape.radius to a positive number");
	if (!(std::abs(z - layer) <= 1e-9 * radius))
		refuseBody(id, text("has z = ", z, " m but body #", layerId, " has z = ", layer, " m"),
		    "Put all disks in one plane: set the third component of their state.pos");
	known.inPlane = true;
	body.radius = radius;
}

void SceneLink::readBox(int id, cd::Shape& shape)
{
	KnownBody& known = bodies[id];
	const Vector3r& extents = box_extents(known.shape);
	if (!extents.allFinite() || extents[0] < 0 || extents[1] < 0 || extents[2] < 0)
		refuseBody(id, text("is a box with the extents ", extents[0], ", ", extents[1], ", ", extents[2], " m"),
		    "Set O.bodies[#].shape.extents, the halves of its edges, to numbers that are not negative");
	const auto& q = orientations[id];
	const double norm = q[2] * q[2] + q[3] * q[3];
	if (!(std::abs(q[0]) <= 1e-9 && std::abs(q[1]) <= 1e-9))
		refuseBody(id, "is a box turned out of the plane", "Turn it about z only: O.bodies[#].state.ori");
	if (!(norm > 0.5 && norm < 2))
		refuseBody(id, "has an orientation that is not a rotation", "Set O.bodies[#].state.ori to a unit quaternion");
	// A box that the disks' plane does not cut (a front or back wall) is never touched.
	known.inPlane = layerId < 0 || std::abs(state_pos(known.state)[2] - layer) <= extents[2] * (1 + 1e-9);
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
	const double spin = state_angVel(known.state)[2];
	if (spin != 0)
		refuseBody(id, text("is a wall with the angular velocity ", spin, " rad/s about z"),
		    "Set O.bodies[#].state.angVel to 0, or use a Box, which can turn");
	if (!(state_blockedDOFs(known.state) & rotZ))
		refuseBody(id, "is a wall that is free to turn about z", "Block 'Z' in O.bodies[#].state.blockedDOFs, or use a Box, which can turn");
	shape.axis = wall_axis(known.shape);
	shape.sense = wall_sense(known.shape);
	if (shape.axis < 0 || shape.axis > 2)
		refuseBody(id, text("is a wall with the axis ", shape.axis),
		    "Set O.bodies[#].shape.axis to 0 or 1, the axis it is perpendicular to (2: before or behind the plane, never touched)");
	if (shape.sense < -1 || shape.sense > 1)
		refuseBody(id, text("is a wall with the sense ", shape.sense), "Set O.bodies[#].shape.sense to -1, 0 or 1");
	known.inPlane = shape.axis != 2;
}

} // namespace cd_engine
