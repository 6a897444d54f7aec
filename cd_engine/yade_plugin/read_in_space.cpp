// Reads the bodies of a scene in space.
#include "body_checks.hpp"

#include <algorithm>

namespace cd_engine {
namespace {

	cd::Vector3 read(const Vector3r& v) { return { v[0], v[1], v[2] }; }

	// Of a unit quaternion x, y, z, w: a vector turned by it.
	cd::Vector3 turned(const std::array<double, 4>& q, const cd::Vector3& v)
	{
		const cd::Vector3 axis { q[0], q[1], q[2] }, twice = 2 * cross(axis, v);
		return v + q[3] * twice + cross(axis, twice);
	}

	// Returns whether the facet has an area. If not, as some in a mesh from a file, its edges are those of others.
	bool readCorners(int id, void* shape, std::array<cd::Vector3, 3>& corners)
	{
		const std::vector<Vector3r>& vertices = facet_vertices(shape);
		if (vertices.size() != 3)
			refuseBody(id, "is a facet without three vertices", "Make it by utils.facet");
		for (int k = 0; k < 3; k++) {
			mustBeFinite(id, "a vertex", vertices[k]);
			corners[k] = read(vertices[k]);
		}
		constexpr double flat = 1e-12; // its area, over the square of its longest edge
		const cd::Vector3 sides[] = { corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2] };
		return length(cross(sides[0], sides[1]))
		    > flat * std::max({ dot(sides[0], sides[0]), dot(sides[1], sides[1]), dot(sides[2], sides[2]) });
	}

} // namespace

template <> void SceneLink<cd::Space3>::findFrame(yade::BodyContainer&)
{
	if (mask != 0)
		throw SceneError(text("ContactDynamics: mask=", mask,
		    " is for belts of boxes and disks, which are known in the plane only. Set mask to 0; in space a belt is a Wall whose state.vel "
		    "points "
		    "along itself"));
	pull = gravity;
}

template <> void SceneLink<cd::Space3>::readOrientation(int id)
{
	const double* const q = &state_ori(bodies[id].state);
	const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
	if (!(square > 0.5 && square < 2))
		refuseBody(id, "has an orientation that is not a rotation", "Set O.bodies[#].state.ori to a unit quaternion");
	orientations[id] = { q[0], q[1], q[2], q[3] };
}

template <> std::string SceneLink<cd::Space3>::placeOf(const cd::SpaceBody& body) const
{
	return text('(', body.at.x, ", ", body.at.y, ", ", body.at.z, ") m");
}

template <> void SceneLink<cd::Space3>::checkMotion(int id)
{
	void* const state = bodies[id].state;
	mustBeFinite(id, state_pos(state), state_vel(state), state_angVel(state));
	if (body_clumpId(bodies[id].body) >= 0)
		refuseBody(id, "belongs to a clump", releaseClump);
}

template <> void SceneLink<cd::Space3>::readMotion(int id, cd::SpaceBody& body, yade::ForceContainer& forces)
{
	void* const state = bodies[id].state;
	body.at = read(state_pos(state));
	readVelocity(id, body);
	const unsigned blocked = state_blockedDOFs(state);
	const bool moves = (blocked & 7) != 7, turns = (blocked & 56) != 56;
	const double mass = state_mass(state);
	const Vector3r& inertia = state_inertia(state);
	if (moves)
		mustMove(id, mass);
	for (int k = 0; k < 3; k++)
		if ((blocked & frame.dof(k + 3)) == 0)
			mustTurn(id, inertia[k], "xyz"[k], "XYZ"[k]);
	if (turns && !(inertia[0] == inertia[1] && inertia[1] == inertia[2]))
		refuseBody(id, text("has the moments of inertia ", inertia[0], ", ", inertia[1], ", ", inertia[2], " kg m^2"),
		    "A sphere that turns needs three equal ones: O.bodies[#].state.inertia=(I, I, I)");
	for (int k = 0; k < cd::Space3::freedoms; k++)
		body.inverseMass[k] = blocked & frame.dof(k) ? 0 : 1 / (k < 3 ? mass : inertia[k - 3]);
	std::fill_n(body.force, cd::Space3::freedoms, 0.);
	if (!moves && !turns)
		return;
	Vector3r force = forces.getForce(id), torque = forces.getTorque(id);
	if (inspecting)
		readPermanentForce(id, force, torque);
	mustBeFinite(id, "a force", force);
	mustBeFinite(id, "a torque", torque);
	for (int k = 0; k < 3; k++) {
		body.force[k] = force[k] + (moves ? mass * pull[k] : 0);
		body.force[k + 3] = torque[k];
	}
}

// Computes how a boundary stands in the axes of the world.
template <> void SceneLink<cd::Space3>::orient(int id)
{
	cd::SpaceShape& shape = world.shapes[id];
	const auto& q = orientations[id];
	if (shape.kind == cd::ShapeKind::box)
		for (int k = 0; k < 3; k++)
			shape.part[k] = turned(q, { k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0. });
	else if (shape.kind == cd::ShapeKind::facet)
		for (int k = 0; k < 3; k++)
			shape.part[k] = turned(q, corners[id][k]);
}

// Boundaries turn only as prescribed: contacts of bodies that turn freely off their centres would need a row with all of their inertia.
template <> bool SceneLink<cd::Space3>::readShape(int id, cd::SpaceBody& body)
{
	const KnownBody& known = bodies[id];
	const auto kind = kindOf(known.shape);
	if (!kind)
		refuseShape(id, known.shape);
	cd::SpaceShape& shape = world.shapes[id];
	if (shape.kind != *kind) {
		shape = {};
		shape.kind = *kind;
	}
	body.radius = 0;
	if (*kind == cd::ShapeKind::disk) {
		body.radius = radiusOf(id, known.shape);
		return true;
	}
	if ((state_blockedDOFs(known.state) & 56) != 56)
		refuseBody(id, text("is a ", className(known.shape), " that is free to turn"),
		    "In space boundaries move along axes or turn as prescribed: add 'XYZ' to O.bodies[#].state.blockedDOFs");
	bool joins = true;
	if (*kind == cd::ShapeKind::box)
		shape.half = read(extentsOf(id, known.shape));
	else if (*kind == cd::ShapeKind::facet) {
		corners.resize(bodies.size());
		joins = readCorners(id, known.shape, corners[id]);
	} else {
		const Vector3r& spin = state_angVel(known.state);
		shape.axis = wall_axis(known.shape);
		shape.sense = senseOf(id, known.shape);
		if (spin[0] != 0 || spin[1] != 0 || spin[2] != 0)
			refuseBody(id, "is a wall with an angular velocity", "Set O.bodies[#].state.angVel to 0, or use a Box, which can turn");
		if (shape.axis < 0 || shape.axis > 2)
			refuseBody(id, text("is a wall with the axis ", shape.axis),
			    "Set O.bodies[#].shape.axis to 0, 1 or 2, the axis it is perpendicular to");
	}
	orient(id);
	return joins;
}

} // namespace cd_engine
