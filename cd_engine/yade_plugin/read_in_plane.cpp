// Reads the bodies of a scene in the plane: which plane it is, and what the bodies are in it.
#include "body_checks.hpp"

#include <algorithm>
#include <utility>

namespace cd_engine {

template <> void SceneLink<cd::Plane>::findPlane(yade::BodyContainer& container)
{
	const ScenePlane now = ScenePlane::of(container, frame, gravity);
	if (now.normal != frame.normal) { // nothing that is known of the bodies holds in it
		bodies.clear();
		layerId = -1;
		outdated = true;
	}
	frame = now;
	pull = frame.toCore(gravity);
	if (pull[2] == 0)
		return;
	for (int id = 0; id < static_cast<int>(container.size()); id++) { // a scene that leaves the plane may have such a gravity
		const Shared<yade::Body>& body = container[id];
		if (body && body_state(body) && body_shape(body) && kindOf(body_shape(body).get())
		    && !frame.keeps(state_blockedDOFs(body_state(body))))
			throw LeavesPlane::of(id, false);
	}
	throw SceneError(
	    text("ContactDynamics: gravity = (", gravity[0], ", ", gravity[1], ", ", gravity[2], ") m/s^2 points out of the ", frame.name(),
		" plane, in which the blocked freedoms keep the scene. Block what keeps every disk in the plane of gravity: "
		"O.bodies[i].state.blockedDOFs='zXY' in x-y, 'yXZ' in x-z, 'xYZ' in y-z"));
}

// The layer of the disks is that of the first disk. That disk must stay in it, since boxes that reach this plane may not reach another.
template <> void SceneLink<cd::Plane>::findLayer(yade::BodyContainer& container)
{
	const auto isDisk = [](const Shared<yade::Body>& body) {
		return body && body_state(body) && body_shape(body) && kindOf(body_shape(body).get()) == cd::ShapeKind::disk;
	};
	const int before = std::exchange(layerId, -1), count = static_cast<int>(container.size());
	for (int id = 0; id < count && layerId < 0; id++)
		layerId = isDisk(container[id]) ? id : -1;
	if (layerId < 0)
		return;
	const double z = state_pos(body_state(container[layerId]))[frame.normal];
	const char axis = frame.letter(frame.normal);
	if (layerId != before || !isSame(bodies[layerId].identity, container[layerId]))
		layer = z;
	else if (std::isfinite(z) && std::abs(z - layer) > 1e-9 * world.bodies[layerId].radius)
		refuseBody(layerId,
		    text("has ", axis, " = ", z, " m but stood at ", axis, " = ", layer, " m in the step before, in the plane of the scene"),
		    "Set that component of its state.pos back. A scene that moves to another plane as a whole needs a new engine: "
		    "O.engines=cd_engine.engines()");
}

template <> void SceneLink<cd::Plane>::findFrame(yade::BodyContainer& container)
{
	findPlane(container);
	findLayer(container);
}

template <> void SceneLink<cd::Plane>::readOrientation(int id)
{
	const double* const q = &state_ori(bodies[id].state);
	orientations[id] = { frame.turn * q[frame.x], frame.turn * q[frame.y], frame.turn * q[frame.normal], q[3] };
}

template <> std::string SceneLink<cd::Plane>::placeOf(const cd::Body& body) const
{
	return text('(', body.x, ", ", body.y, ") m", frame.normal == 2 ? "" : text(" in ", frame.name()));
}

// Checks that the present freedoms and velocities of the body are those of a plane motion.
template <> void SceneLink<cd::Plane>::checkMotion(int id)
{
	void* const state = bodies[id].state;
	const Vector3r& velocity = state_vel(state);
	const Vector3r& spin = state_angVel(state);
	const Vector3r& position = state_pos(state);
	mustBeFinite(id, position, velocity, spin);
	if (!frame.keeps(state_blockedDOFs(state))) {
		if (body_clumpId(bodies[id].body) >= 0)
			refuseBody(id, "belongs to a clump", releaseClump);
		if (!kindOf(bodies[id].shape))
			refuseShape(id, bodies[id].shape); // to set its freedoms would not help
		throw LeavesPlane::of(id, false);
	}
	if (velocity[frame.normal] != 0 || spin[frame.x] != 0 || spin[frame.y] != 0)
		refuseBody(id, text("moves out of the ", frame.name(), " plane"),
		    text("Set its ", frame.letter(frame.normal), " velocity and its ", frame.letter(frame.x), " and ", frame.letter(frame.y),
			" angular velocities to 0"));
}

template <> void SceneLink<cd::Plane>::readMotion(int id, cd::Body& body, yade::ForceContainer& forces)
{
	void* const state = bodies[id].state;
	const Vector3r& position = state_pos(state);
	body.x = position[frame.x];
	body.y = position[frame.y];
	readVelocity(id, body);

	const unsigned blocked = state_blockedDOFs(state);
	const bool moves = (blocked & frame.dof(0)) == 0 || (blocked & frame.dof(1)) == 0, turns = (blocked & frame.dof(2)) == 0;
	const double mass = state_mass(state), inertia = state_inertia(state)[frame.normal];
	if (moves)
		mustMove(id, mass);
	if (turns)
		mustTurn(id, inertia, frame.letter(frame.normal), "XYZ"[frame.normal]);
	for (int k = 0; k < cd::Plane::freedoms; k++)
		body.inverseMass[k] = blocked & frame.dof(k) ? 0 : 1 / (k < cd::Plane::components ? mass : inertia);
	std::fill_n(body.force, cd::Plane::freedoms, 0.);
	if (!moves && !turns)
		return;
	if (!world.surfaces.empty() && !(body_groupMask(bodies[id].body) & mask))
		refuseBody(id, text("is free to move, but shares no bit of its groupMask with mask=", mask, ", which is for belts"),
		    "Set O.bodies[#].groupMask to one that shares a bit, or block its degrees of freedom (state.blockedDOFs)");
	Vector3r force = forces.getForce(id), torque = forces.getTorque(id);
	if (inspecting)
		readPermanentForce(id, force, torque);
	mustBeFinite(id, "a force", force);
	mustBeFinite(id, "a torque", torque);
	body.force[0] = force[frame.x] + (moves ? mass * pull[0] : 0);
	body.force[1] = force[frame.y] + (moves ? mass * pull[1] : 0);
	body.force[2] = frame.turn * torque[frame.normal];
}

template <> bool SceneLink<cd::Plane>::readDisk(int id, cd::Body& body)
{
	const KnownBody& known = bodies[id];
	const double z = state_pos(known.state)[frame.normal], radius = radiusOf(id, known.shape);
	const char axis = frame.letter(frame.normal);
	if (!(std::abs(z - layer) <= 1e-9 * radius))
		refuseBody(id, text("has ", axis, " = ", z, " m but body #", layerId, " has ", axis, " = ", layer, " m"),
		    "Put all disks in one plane: set that component of their state.pos");
	body.radius = radius;
	return true;
}

// Computes the orientation of a box in the frame.
template <> void SceneLink<cd::Plane>::orient(int id)
{
	const auto& q = orientations[id];
	const double norm = q[2] * q[2] + q[3] * q[3];
	world.shapes[id].cosine = (q[3] * q[3] - q[2] * q[2]) / norm;
	world.shapes[id].sine = 2 * q[2] * q[3] / norm;
}

template <> bool SceneLink<cd::Plane>::readBox(int id, cd::Shape& shape)
{
	const KnownBody& known = bodies[id];
	const Vector3r& extents = extentsOf(id, known.shape);
	const auto& q = orientations[id];
	const double norm = q[2] * q[2] + q[3] * q[3];
	if (!(std::abs(q[0]) <= 1e-9 && std::abs(q[1]) <= 1e-9))
		refuseBody(
		    id, "is a box turned out of the plane", text("Turn it about ", frame.letter(frame.normal), " only: O.bodies[#].state.ori"));
	if (!(norm > 0.5 && norm < 2))
		refuseBody(id, "has an orientation that is not a rotation", "Set O.bodies[#].state.ori to a unit quaternion");
	shape.ex = extents[frame.x];
	shape.ey = extents[frame.y];
	orient(id);
	// A box that the disks' plane does not cut (a front or back wall) is never touched.
	return layerId < 0 || std::abs(state_pos(known.state)[frame.normal] - layer) <= extents[frame.normal] * (1 + 1e-9);
}

// A wall is as wide as the plane, so it has no point to turn about.
template <> bool SceneLink<cd::Plane>::readWall(int id, cd::Shape& shape)
{
	const KnownBody& known = bodies[id];
	const double spin = state_angVel(known.state)[frame.normal];
	const char about = frame.letter(frame.normal);
	if (spin != 0)
		refuseBody(id, text("is a wall with the angular velocity ", spin, " rad/s about ", about),
		    "Set O.bodies[#].state.angVel to 0, or use a Box, which can turn");
	if (!(state_blockedDOFs(known.state) & frame.dof(2)))
		refuseBody(id, text("is a wall that is free to turn about ", about),
		    text("Block '", "XYZ"[frame.normal], "' in O.bodies[#].state.blockedDOFs, or use a Box, which can turn"));
	const int axis = wall_axis(known.shape);
	shape.axis = axis == frame.x ? 0 : axis == frame.y ? 1 : 2;
	shape.sense = senseOf(id, known.shape);
	if (axis < 0 || axis > 2)
		refuseBody(id, text("is a wall with the axis ", axis),
		    "Set O.bodies[#].shape.axis to 0, 1 or 2, the axis it is perpendicular to (that across the plane: never touched)");
	return shape.axis != 2;
}

// Reads class, size and orientation of the shape, any of which may change at any time. Returns whether it is in the plane of the disks.
template <> bool SceneLink<cd::Plane>::readShape(int id, cd::Body& body)
{
	const auto kind = kindOf(bodies[id].shape);
	if (!kind)
		refuseShape(id, bodies[id].shape);
	if (*kind == cd::ShapeKind::facet)
		throw LeavesPlane::of(id, true);
	cd::Shape& shape = world.shapes[id];
	if (shape.kind != *kind) {
		shape = {};
		shape.kind = *kind;
	}
	body.radius = 0;
	return *kind == cd::ShapeKind::disk ? readDisk(id, body) : *kind == cd::ShapeKind::box ? readBox(id, shape) : readWall(id, shape);
}

} // namespace cd_engine
