// Reads from the scene what the bodies and their shapes are and how they move now. Refuses what the engine cannot do.
#include "kind.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace cd_engine {
namespace {

	// Whether both refer to the same body. A new body may get the address of an old one, but not its reference count, which exists as long as the
	// old body is remembered here.
	bool isSame(const boost::weak_ptr<yade::Body>& known, const Shared<yade::Body>& now)
	{
		return !known.owner_before(now) && !now.owner_before(known);
	}

	void mustBeFinite(int id, const char* what, const Vector3r& v)
	{
		if (!((v[0] * 0 + v[1] * 0 + v[2] * 0) == 0)) // one test: a product with 0 is 0 unless a factor is infinite or NaN
			refuseBody(
			    id, text("has ", what, " that is not a number"), "Look for what set O.bodies[#] to it, or for a failed step before");
	}

	// What acts on a body before the next step. O.forces still holds what the last step left, its contact forces included; a ForceResetter clears
	// that. Without permanent forces YADE reads past the end of its list.
	void readPermanentForce(int id, Vector3r& force, Vector3r& torque)
	{
		const py::object lasting = py::import("yade").attr("O").attr("forces");
		const bool any = py::extract<bool>(lasting.attr("getPermForceUsed")());
		force = any ? py::extract<Vector3r>(lasting.attr("permF")(id))() : Vector3r::Zero();
		torque = any ? py::extract<Vector3r>(lasting.attr("permT")(id))() : Vector3r::Zero();
	}

	// None if a shape is none of the three. The address of a shape identifies nothing, because a new shape may get the address of an old one.
	std::optional<cd::ShapeKind> kindOf(const void* shape)
	{
		static Kind isSphere { "Sphere", Kind::exactly }, isBox { "Box", Kind::exactly }, isWall { "Wall", Kind::exactly };
		if (isSphere(shape))
			return cd::ShapeKind::disk;
		if (isBox(shape))
			return cd::ShapeKind::box;
		return isWall(shape) ? std::optional(cd::ShapeKind::wall) : std::nullopt;
	}

	[[noreturn]] void refuseShape(int id, const void* shape)
	{
		// A clump is a body itself. Its id comes after those of its members, which need no test of their own for this.
		const std::string name = className(shape);
		if (name == "Clump")
			refuseBody(id, "is a clump", releaseClump);
		refuseBody(id, "has the shape " + name, "Only Sphere (a disk), Box and Wall are known; replace or erase it");
	}

} // namespace

// Prefetches the memory lines of a body's objects that a step reads.
void prefetchBody(const KnownBody& known)
{
	if (!known.body)
		return;
	prefetch(known.body, { body_material, body_shape });
	prefetch(known.shape, { 0, sphere_radius });
	prefetch(known.state, { state_pos, state_vel, state_angVel, state_inertia, state_blockedDOFs });
}

void SceneLink::findPlane(yade::BodyContainer& container)
{
	const ScenePlane now = ScenePlane::of(container, plane, gravity);
	if (now.normal != plane.normal) { // nothing that is known of the bodies holds in it
		bodies.clear();
		layerId = -1;
		outdated = true;
	}
	plane = now;
	pull = plane.toPlane(gravity);
	if (pull[2] != 0)
		throw SceneError(
		    text("ContactDynamics: gravity = (", gravity[0], ", ", gravity[1], ", ", gravity[2], ") m/s^2 points out of the ", plane.name(),
			" plane, in which the blocked freedoms keep the scene. Block what keeps every disk in the plane of gravity: "
			"O.bodies[i].state.blockedDOFs='zXY' in x-y, 'yXZ' in x-z, 'xYZ' in y-z"));
}

std::string SceneLink::placeOf(const cd::Body& body) const
{
	return text('(', body.x, ", ", body.y, ") m", plane.normal == 2 ? "" : text(" in ", plane.name()));
}

// The layer of the disks is that of the first disk. That disk must stay in it, since boxes that reach this plane may not reach another.
void SceneLink::findLayer(yade::BodyContainer& container)
{
	const auto isDisk = [](const Shared<yade::Body>& body) {
		return body && body_state(body) && body_shape(body) && kindOf(body_shape(body).get()) == cd::ShapeKind::disk;
	};
	const int before = std::exchange(layerId, -1), count = static_cast<int>(container.size());
	for (int id = 0; id < count && layerId < 0; id++)
		layerId = isDisk(container[id]) ? id : -1;
	if (layerId < 0)
		return;
	const double z = state_pos(body_state(container[layerId]))[plane.normal];
	const char axis = plane.letter(plane.normal);
	if (layerId != before || !isSame(bodies[layerId].identity, container[layerId]))
		layer = z;
	else if (std::isfinite(z) && std::abs(z - layer) > 1e-9 * world.bodies[layerId].radius)
		refuseBody(layerId,
		    text("has ", axis, " = ", z, " m but stood at ", axis, " = ", layer, " m in the step before, in the plane of the scene"),
		    "Set that component of its state.pos back. A scene that moves to another plane as a whole needs a new engine: "
		    "O.engines=cd_engine.engines()");
}

// Checks that the present freedoms and velocities of the body are those of a plane motion.
void SceneLink::checkMotion(int id)
{
	void* const state = bodies[id].state;
	const Vector3r& velocity = state_vel(state);
	const Vector3r& spin = state_angVel(state);
	const Vector3r& position = state_pos(state);
	mustBeFinite(id, "a position", position);
	mustBeFinite(id, "a velocity", velocity);
	mustBeFinite(id, "an angular velocity", spin);
	if (!plane.keeps(state_blockedDOFs(state))) {
		if (body_clumpId(bodies[id].body) >= 0)
			refuseBody(id, "belongs to a clump", releaseClump);
		if (!kindOf(bodies[id].shape))
			refuseShape(id, bodies[id].shape); // to set its freedoms would not help
		refuseBody(id, text("is free to leave the ", plane.name(), " plane, in which the scene lies by the freedoms of its bodies"),
		    text("Set O.bodies[#].state.blockedDOFs='", plane.blocks(), "' (a boundary also blocks what is not to move)"));
	}
	if (velocity[plane.normal] != 0 || spin[plane.x] != 0 || spin[plane.y] != 0)
		refuseBody(id, text("moves out of the ", plane.name(), " plane"),
		    text("Set its ", plane.letter(plane.normal), " velocity and its ", plane.letter(plane.x), " and ", plane.letter(plane.y),
			" angular velocities to 0"));
}

void SceneLink::readVelocity(int id, cd::Body& body)
{
	for (int k = 0; k < cd::Plane::freedoms; k++)
		body.v[k] = plane.velocity(bodies[id].state, k);
	if (world.surfaces.empty())
		return;
	std::array<double, cd::Plane::freedoms> now {};
	if (!(body_groupMask(bodies[id].body) & mask)) {
		std::copy_n(body.v, cd::Plane::freedoms, now.begin());
		std::fill_n(body.v, cd::Plane::freedoms, 0.);
	}
	newSurfaces = newSurfaces || now != world.surfaces[id];
	world.surfaces[id] = now;
}

void SceneLink::readMotion(int id, cd::Body& body, yade::ForceContainer& forces)
{
	void* const state = bodies[id].state;
	const Vector3r& position = state_pos(state);
	body.x = position[plane.x];
	body.y = position[plane.y];
	readVelocity(id, body);

	const unsigned blocked = state_blockedDOFs(state);
	const bool moves = (blocked & plane.dof(0)) == 0 || (blocked & plane.dof(1)) == 0, turns = (blocked & plane.dof(2)) == 0;
	const double mass = state_mass(state), inertia = state_inertia(state)[plane.normal];
	if (moves && !(mass > 0 && std::isfinite(mass)))
		refuseBody(id, text("is free to move but has the mass ", mass, " kg"),
		    "Set O.bodies[#].state.mass, or block its degrees of freedom (state.blockedDOFs)");
	if (turns && !(inertia > 0 && std::isfinite(inertia)))
		refuseBody(id, text("is free to turn but has the moment of inertia ", inertia, " kg m^2 about ", plane.letter(plane.normal)),
		    text("Set O.bodies[#].state.inertia, or block '", "XYZ"[plane.normal], "'"));
	for (int k = 0; k < cd::Plane::freedoms; k++)
		body.inverseMass[k] = blocked & plane.dof(k) ? 0 : 1 / (k < cd::Plane::components ? mass : inertia);
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
	body.force[0] = force[plane.x] + (moves ? mass * pull[0] : 0);
	body.force[1] = force[plane.y] + (moves ? mass * pull[1] : 0);
	body.force[2] = plane.turn * torque[plane.normal];
}

// Reads class, size and orientation of the shape, any of which may change at any time. Returns whether it is in the plane of the disks.
bool SceneLink::readShape(int id, cd::Body& body)
{
	const auto kind = kindOf(bodies[id].shape);
	if (!kind)
		refuseShape(id, bodies[id].shape);
	cd::Shape& shape = world.shapes[id];
	if (shape.kind != *kind) {
		shape = {};
		shape.kind = *kind;
	}
	body.radius = 0;
	return *kind == cd::ShapeKind::disk ? readDisk(id, body) : *kind == cd::ShapeKind::box ? readBox(id, shape) : readWall(id, shape);
}

bool SceneLink::readDisk(int id, cd::Body& body)
{
	const KnownBody& known = bodies[id];
	const double z = state_pos(known.state)[plane.normal], radius = sphere_radius(known.shape);
	const char axis = plane.letter(plane.normal);
	if (!(radius > 0 && std::isfinite(radius)))
		refuseBody(id, text("has the radius ", radius, " m"), "Set O.bodies[#].shape.radius to a positive number");
	if (!(std::abs(z - layer) <= 1e-9 * radius))
		refuseBody(id, text("has ", axis, " = ", z, " m but body #", layerId, " has ", axis, " = ", layer, " m"),
		    "Put all disks in one plane: set that component of their state.pos");
	body.radius = radius;
	return true;
}

bool SceneLink::readBox(int id, cd::Shape& shape)
{
	const KnownBody& known = bodies[id];
	const Vector3r& extents = box_extents(known.shape);
	if (!extents.allFinite() || extents[0] < 0 || extents[1] < 0 || extents[2] < 0)
		refuseBody(id, text("is a box with the extents ", extents[0], ", ", extents[1], ", ", extents[2], " m"),
		    "Set O.bodies[#].shape.extents, the halves of its edges, to numbers that are not negative");
	const auto& q = orientations[id];
	const double norm = q[2] * q[2] + q[3] * q[3];
	if (!(std::abs(q[0]) <= 1e-9 && std::abs(q[1]) <= 1e-9))
		refuseBody(
		    id, "is a box turned out of the plane", text("Turn it about ", plane.letter(plane.normal), " only: O.bodies[#].state.ori"));
	if (!(norm > 0.5 && norm < 2))
		refuseBody(id, "has an orientation that is not a rotation", "Set O.bodies[#].state.ori to a unit quaternion");
	shape.ex = extents[plane.x];
	shape.ey = extents[plane.y];
	orient(id);
	// A box that the disks' plane does not cut (a front or back wall) is never touched.
	return layerId < 0 || std::abs(state_pos(known.state)[plane.normal] - layer) <= extents[plane.normal] * (1 + 1e-9);
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
bool SceneLink::readWall(int id, cd::Shape& shape)
{
	const KnownBody& known = bodies[id];
	const double spin = state_angVel(known.state)[plane.normal];
	const char about = plane.letter(plane.normal);
	if (spin != 0)
		refuseBody(id, text("is a wall with the angular velocity ", spin, " rad/s about ", about),
		    "Set O.bodies[#].state.angVel to 0, or use a Box, which can turn");
	if (!(state_blockedDOFs(known.state) & plane.dof(2)))
		refuseBody(id, text("is a wall that is free to turn about ", about),
		    text("Block '", "XYZ"[plane.normal], "' in O.bodies[#].state.blockedDOFs, or use a Box, which can turn"));
	const int axis = wall_axis(known.shape);
	shape.axis = axis == plane.x ? 0 : axis == plane.y ? 1 : 2;
	shape.sense = wall_sense(known.shape);
	if (axis < 0 || axis > 2)
		refuseBody(id, text("is a wall with the axis ", axis),
		    "Set O.bodies[#].shape.axis to 0, 1 or 2, the axis it is perpendicular to (that across the plane: never touched)");
	if (shape.sense < -1 || shape.sense > 1)
		refuseBody(id, text("is a wall with the sense ", shape.sense), "Set O.bodies[#].shape.sense to -1, 0 or 1");
	return shape.axis != 2;
}

void SceneLink::readFriction(int id, void* mat)
{
	static Kind isFrictMat { "FrictMat" };
	KnownBody& body = bodies[id];
	if (!mat || !isFrictMat(mat))
		refuseBody(id, "has a material without friction angle", "Set O.bodies[#].mat to a FrictMat or a material derived from it");
	const void* const vtable = *static_cast<const void* const*>(mat);
	auto known = std::find_if(materials.begin(), materials.end(), [&](const MaterialClass& m) { return m.vtable == vtable; });
	if (known == materials.end()) {
		const std::string name = className(mat);
		known = materials.insert(known, { vtable, isA(name, "CohFrictMat") });
		const char* const also = known->rolls ? " and, with its momentRotationLaw, etaRoll" : "";
		if (name != "FrictMat")
			warnOnce(stiffness.rigid()
				? text("of a ", name, " only the frictionAngle", also,
				    " is used: rigid contacts have no stiffness, cohesion or damping.")
				: text("of a ", name, " only the members of a FrictMat", also, " are used, not its cohesion or damping."),
			    text("(Body #", id, " has one.) Use a FrictMat to say so, and `restitution` for bouncing."));
	}
	body.etaRoll = 0;
	if (known->rolls)
		readRolling(id, mat);
	if (stiffness.ofMaterials) {
		body.young = elastMat_young(mat);
		body.poisson = elastMat_poisson(mat);
		if (!(body.young > 0 && std::isfinite(body.young) && body.poisson >= 0 && std::isfinite(body.poisson)))
			refuseBody(id, text("has a material with young = ", body.young, " Pa and poisson = ", body.poisson),
			    "With materialStiffness, set O.bodies[#].mat.young above 0 and .poisson (k_t/k_n of two equal bodies) to at least 0");
	}
	body.material = material_id(mat);
	const double angle = frictMat_frictionAngle(mat);
	if (angle == body.frictionAngle)
		return;
	const double mu = std::tan(angle);
	if (!(angle >= 0 && angle < 1.5707963267948966 && mu <= 1e6)) // with far larger mu rounding hides that a contact closes
		refuseBody(id, text("has the friction angle ", angle, " rad, mu = ", mu),
		    "Set O.bodies[#].mat.frictionAngle = math.atan(mu) with a mu from 0 to 1e6");
	body.frictionAngle = angle;
	world.bodies[id].friction = mu;
}

// As YADE, a contact has a moment only if both materials have a momentRotationLaw.
void SceneLink::readRolling(int id, void* mat)
{
	KnownBody& body = bodies[id];
	const double eta = cohMat_etaRoll(mat), alpha = cohMat_alphaKr(mat);
	if (!cohMat_momentRotationLaw(mat))
		return;
	if (!(eta < 0 || (eta <= 1e6 && alpha >= 0 && std::isfinite(alpha))))
		refuseBody(id, text("has a material with etaRoll = ", eta, " and alphaKr = ", alpha),
		    "Set O.bodies[#].mat.etaRoll to a share of the radius, from 0 to 1e6, and alphaKr to at least 0");
	if (eta < 0)
		warnOnce("a CohFrictMat has a momentRotationLaw and a negative etaRoll, for moments without a bound, which are not known here.",
		    text("(Body #", id, " has one.) Its contacts get no moment. Set etaRoll to the bound, as a share of the radius."));
	body.etaRoll = std::max(eta, 0.);
	body.alphaKr = alpha;
	anyRolls = anyRolls || eta > 0;
}

// Warns if somebody sets the position of a body without that freedom step by step, since no disk sees it come. Once or twice may be a new beginning.
// x, y: where the same body was after the last step.
void SceneLink::warnOfPlacing(int id, double x, double y, long step)
{
	constexpr int often = 3, apart = 100; // steps between two moves from which on a scene is rather set up anew
	const cd::Body& b = world.bodies[id];
	KnownBody& known = bodies[id];
	if ((b.x == x || b.inverseMass[0] != 0 || b.v[0] != 0) && (b.y == y || b.inverseMass[1] != 0 || b.v[1] != 0)) {
		known.placed = 0;
		return;
	}
	known.placed = step - known.placedAt < apart ? std::min(known.placed + 1, often) : 1;
	known.placedAt = step;
	if (known.placed < often)
		return;
	placesBoundaries = true;
	warnOnce(text("body #", id, " is moved by its position while its velocity is 0: Contact Dynamics sees velocities only."),
	    text("It came by ", std::hypot(b.x - x, b.y - y), " m since the last step and cuts into what is there. Set O.bodies[", id,
		"].state.vel instead, in an engine before ContactDynamics."));
}

// Reads all that a step needs to know of a body. Every step looks at all of it, since anybody may have changed it.
void SceneLink::readBody(int id, const Shared<yade::Body>& body, yade::ForceContainer& forces, long step)
{
	KnownBody& known = bodies[id];
	const bool same = known.body && isSame(known.identity, body);
	if (known.body && !same)
		gone.push_back(id);
	if (!body) {
		known = KnownBody();
		world.bodies[id] = cd::Body();
		world.masks[id] = 0;
		if (!world.surfaces.empty())
			world.surfaces[id] = {};
		return;
	}
	if (!same) {
		known.identity = body;
		known.came = step;
		known.placed = 0;
	}
	known.body = body.get();
	known.state = body_state(body).get();
	known.shape = body_shape(body).get();
	if (!known.state)
		refuseBody(id, "has no state", "Give it one: O.bodies[#].state=State()");
	if (!known.shape)
		refuseBody(id, "has no shape", "Set O.bodies[#].shape to a Sphere, Box or Wall, or erase the body");
	checkMotion(id);
	const double* const q = &state_ori(known.state);
	orientations[id] = { plane.turn * q[plane.x], plane.turn * q[plane.y], plane.turn * q[plane.normal], q[3] };
	const bool inPlane = readShape(id, world.bodies[id]);
	readFriction(id, body_material(body).get());
	const double x = world.bodies[id].x, y = world.bodies[id].y;
	readMotion(id, world.bodies[id], forces);
	constexpr int bounded = 1; // YADE's bit of Body.flags
	world.masks[id] = inPlane && (body_flags(body) & bounded) != 0 ? body_groupMask(body) : 0;
	if (same && world.masks[id] != 0)
		warnOfPlacing(id, x, y, step);
}

void SceneLink::gatherBodies(yade::Scene* scene)
{
	constexpr int ahead = 6;
	auto& container = *scene_bodies(scene);
	auto& forces = scene_forces(scene);
	findPlane(container);
	findLayer(container);
	const int count = static_cast<int>(container.size());
	bool changed = outdated || bodies.size() != container.size();
	outdated = true; // stays true if a body is refused
	bodies.resize(count);
	orientations.resize(count);
	world.bodies.resize(count);
	world.shapes.resize(count);
	world.masks.resize(count, 0);
	forces.sync();
	anyRolls = false;
	newSurfaces = newSurfaces || world.surfaces.empty() != (mask == 0);
	maskBefore = mask;
	world.surfaces.resize(mask > 0 ? count : 0);
	for (int id = 0; id < count; id++) {
		if (id + ahead < count)
			prefetchBody(bodies[id + ahead]);
		const bool boundary = isBoundary(world.bodies[id]), joins = world.masks[id] != 0;
		const int material = bodies[id].material;
		readBody(id, container[id], forces, scene_iter(scene));
		changed = changed || isBoundary(world.bodies[id]) != boundary || (world.masks[id] != 0) != joins || bodies[id].material != material;
	}
	std::sort(gone.begin(), gone.end());
	outdated = changed || !gone.empty();
}

} // namespace cd_engine
