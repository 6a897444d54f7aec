// Reads from the scene what the bodies are and how they move now. Refuses what the engine cannot do.
#include "inheritance.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cmath>

namespace cd_engine {
namespace {

	// Whether both refer to the same body. A new body may get the address of an old one, but not its reference count, which exists as long as the
	// old body is remembered here.
	bool isSame(const boost::weak_ptr<yade::Body>& known, const boost::shared_ptr<yade::Body>& now)
	{
		return !known.owner_before(now) && !now.owner_before(known);
	}

	// One test for several vectors, since nearly always all are finite: a product with 0 is 0 unless a factor is infinite or NaN.
	template <class... V> bool allFinite(const V&... v) { return ((v[0] * 0 + v[1] * 0 + v[2] * 0) + ...) == 0; }

	void mustBeFinite(int id, const char* what, const Vector3r& v)
	{
		if (!v.allFinite())
			refuseBody(id, std::string("has a ") + what + " that is not a number",
			    "Look for what set " + ofBody(id) + " to it, or for a failed step before");
	}

} // namespace

// The plane of the disks is that of the first disk. That disk must stay in it, since boxes that reach this plane may not reach another.
void SceneLink::findLayer(yade::BodyContainer& container)
{
	const int before = layerId;
	const double stoodAt = layer;
	layerId = -1;
	for (std::size_t id = 0; id < container.size() && layerId < 0; id++) {
		char* const body = reinterpret_cast<char*>(container[id].get());
		const void* const shape = body ? pointer<yade::Shape>(body, layout.body_shape) : nullptr;
		void* const state = body ? pointer<yade::State>(body, layout.body_state) : nullptr;
		if (!shape || !state || kindOf(shape) != static_cast<int>(cd::ShapeKind::disk))
			continue;
		layerId = static_cast<int>(id);
		layer = at<Vector3r>(state, layout.state_se3)[2];
	}
	if (layerId < 0 || layerId != before || !isSame(bodies[layerId].identity, container[layerId]))
		return;
	const double z = layer;
	layer = stoodAt;
	if (std::isfinite(z) && std::abs(z - stoodAt) > 1e-9 * world.bodies[layerId].radius)
		refuseBody(layerId,
		    "has z = " + text(z) + " m but stood at z = " + text(stoodAt) + " m in the step before, in the plane of the scene",
		    "Set the third component of its state.pos back. A scene that moves to another plane as a whole needs a new engine: "
		    "O.engines=cd_engine.engines()");
}

// Checks that the present freedoms and velocities of the body are those of a plane motion.
void SceneLink::checkMotion(int id)
{
	char* const state = bodies[id].state;
	const Vector3r& velocity = at<Vector3r>(state, layout.state_vel);
	const Vector3r& spin = at<Vector3r>(state, layout.state_angVel);
	const Vector3r& position = at<Vector3r>(state, layout.state_se3);
	if (!allFinite(position, velocity, spin)) {
		mustBeFinite(id, "position", position);
		mustBeFinite(id, "velocity", velocity);
		mustBeFinite(id, "angular velocity", spin);
	}
	constexpr unsigned outside = dofZ | rotX | rotY;
	if ((at<unsigned>(state, layout.state_blockedDOFs) & outside) != outside) {
		if (at<int>(bodies[id].body, layout.body_clumpId) >= 0)
			refuseBody(id, "belongs to a clump", releaseClump);
		if (kindOf(bodies[id].shape) < 0)
			readShape(id, world.bodies[id]); // refuses it: to set its freedoms would not help
		refuseBody(
		    id, "is free to leave the plane", "Set " + ofBody(id) + ".state.blockedDOFs='zXY' (a boundary also blocks what is not to move)");
	}
	if (velocity[2] != 0 || spin[0] != 0 || spin[1] != 0)
		refuseBody(id, "moves out of the plane", "Set its z velocity and its x and y angular velocities to 0");
}

void SceneLink::readMotion(int id, cd::Body& body, yade::ForceContainer& forces, const Vector3r& g) const
{
	char* const state = bodies[id].state;
	const Vector3r& position = at<Vector3r>(state, layout.state_se3);
	const Vector3r& velocity = at<Vector3r>(state, layout.state_vel);
	body.x = position[0];
	body.y = position[1];
	body.v[0] = velocity[0];
	body.v[1] = velocity[1];
	body.v[2] = at<Vector3r>(state, layout.state_angVel)[2];

	const unsigned blocked = at<unsigned>(state, layout.state_blockedDOFs);
	const bool moves = !(blocked & dofX) || !(blocked & dofY), turns = !(blocked & rotZ);
	const double mass = at<double>(state, layout.state_mass), inertia = at<Vector3r>(state, layout.state_inertia)[2];
	if (moves && !(mass > 0 && std::isfinite(mass)))
		refuseBody(id, "is free to move but has the mass " + text(mass) + " kg", "Set " + ofBody(id) + ".state.mass, or block its freedoms");
	if (turns && !(inertia > 0 && std::isfinite(inertia)))
		refuseBody(id, "is free to turn but has the moment of inertia " + text(inertia) + " kg m^2 about z",
		    "Set " + ofBody(id) + ".state.inertia, or block 'Z'");
	body.inverseMass[0] = blocked & dofX ? 0 : 1 / mass;
	body.inverseMass[1] = blocked & dofY ? 0 : 1 / mass;
	body.inverseMass[2] = blocked & rotZ ? 0 : 1 / inertia;
	std::fill_n(body.force, 3, 0.);
	if (!moves && !turns)
		return;
	const Vector3r &force = forces.getForce(id), &torque = forces.getTorque(id);
	if (!allFinite(force, torque)) {
		mustBeFinite(id, "force", force);
		mustBeFinite(id, "torque", torque);
	}
	setForce(id, body, force, torque, g);
}

void SceneLink::setForce(int id, cd::Body& body, const Vector3r& force, const Vector3r& torque, const Vector3r& g) const
{
	const bool moves = body.inverseMass[0] > 0 || body.inverseMass[1] > 0;
	const double mass = at<double>(bodies[id].state, layout.state_mass);
	body.force[0] = force[0] + (moves ? mass * g[0] : 0);
	body.force[1] = force[1] + (moves ? mass * g[1] : 0);
	body.force[2] = torque[2];
}

void SceneLink::readFriction(int id, void* mat)
{
	KnownBody& known = bodies[id];
	if (!mat || !inherits(mat, Base::FrictMat))
		refuseBody(id, "has a material without friction angle", "Set " + ofBody(id) + ".mat to a FrictMat or a material derived from it");
	if (const void* const vtable = *static_cast<const void* const*>(mat); vtable != material) {
		tellOfMaterial(id, className(mat));
		material = vtable;
	}
	const double angle = at<double>(mat, layout.frictMat_frictionAngle);
	if (angle == known.frictionAngle)
		return;
	if (!(angle >= 0 && angle < 1.5707963267948966))
		refuseBody(id, "has the friction angle " + text(angle) + " rad", "Set " + ofBody(id) + ".mat.frictionAngle within [0, pi/2)");
	known.frictionAngle = angle;
	known.friction = std::tan(angle);
}

void SceneLink::tellOfMaterial(int id, const std::string& name)
{
	if (name != "FrictMat")
		tell("of a " + name + " only the frictionAngle is used: rigid contacts have no stiffness, cohesion or damping.",
		    "(Body #" + std::to_string(id) + " has one.) Use a FrictMat to say so, and `restitution` for bouncing.");
}

// Warns if somebody sets the position of a boundary step by step, since no disk sees it come. Once or twice may be a new beginning.
void SceneLink::tellOfPlacing(int id, bool same, double x, double y)
{
	constexpr int often = 3;
	const cd::Body& b = world.bodies[id];
	const bool placed = same && ((b.x != x && b.inverseMass[0] == 0 && b.v[0] == 0) || (b.y != y && b.inverseMass[1] == 0 && b.v[1] == 0));
	bodies[id].placed = placed ? std::min(bodies[id].placed + 1, often) : 0;
	if (bodies[id].placed < often)
		return;
	placesBoundaries = true;
	tell("body #" + std::to_string(id) + " is moved by its position while its velocity is 0: Contact Dynamics sees velocities only.",
	    "It came by " + text(std::hypot(b.x - x, b.y - y)) + " m since the last step and cuts into what is there. Set " + ofBody(id)
		+ ".state.vel instead, in an engine before ContactDynamics.");
}

// Reads all that a step needs to know of a body. Every step looks at all of it, since anybody may have changed it.
void SceneLink::readBody(int id, const boost::shared_ptr<yade::Body>& owned, yade::ForceContainer& forces, const Vector3r& g)
{
	KnownBody& known = bodies[id];
	char* const body = reinterpret_cast<char*>(owned.get());
	const bool same = known.exists && isSame(known.identity, owned);
	if (!same)
		known.identity = owned;
	known.state = static_cast<char*>(pointer<yade::State>(body, layout.body_state));
	known.shape = pointer<yade::Shape>(body, layout.body_shape);
	known.body = body;
	known.exists = true;
	if (!known.state)
		refuseBody(id, "has no state", "Give it one: " + ofBody(id) + ".state=State()");
	if (!known.shape)
		refuseBody(id, "has no shape", "Set " + ofBody(id) + ".shape to a Sphere, Box or Wall, or erase the body");
	checkMotion(id);
	std::copy_n(&at<double>(known.state, layout.state_orientation), 4, orientations[id].data());
	readShape(id, world.bodies[id]);
	readFriction(id, pointer<yade::Material>(body, layout.body_material));
	const double x = world.bodies[id].x, y = world.bodies[id].y;
	readMotion(id, world.bodies[id], forces, g);
	tellOfPlacing(id, same && known.boundary, x, y);
	world.bodies[id].friction = known.friction;
	constexpr int bounded = 1; // YADE's bit of Body.flags
	world.masks[id] = known.inPlane && (at<int>(body, layout.body_flags) & bounded) != 0 ? at<int>(body, layout.body_groupMask) : 0;
}

// Prefetches the memory lines of a body's objects that a step reads.
void SceneLink::prefetchBody(const KnownBody& known) const
{
	if (!known.exists)
		return;
	prefetch(known.body, layout.body_material);
	prefetch(known.body, layout.body_shape);
	prefetch(known.shape, 0);
	prefetch(known.shape, layout.sphere_radius);
	for (const long member : { layout.state_se3, layout.state_vel, layout.state_angVel, layout.state_inertia, layout.state_blockedDOFs })
		prefetch(known.state, member);
}

void SceneLink::gatherBodies(yade::Scene* scene, const Vector3r& g)
{
	constexpr int ahead = 6;
	auto& container = *at<boost::shared_ptr<yade::BodyContainer>>(scene, layout.scene_bodies);
	auto& forces = at<yade::ForceContainer>(scene, layout.scene_forces);
	findLayer(container);
	const int count = static_cast<int>(container.size());
	bool changed = outdated || bodies.size() != container.size();
	outdated = true; // stays true if a body is refused
	for (std::size_t id = container.size(); id < bodies.size(); id++)
		gone.push_back(static_cast<int>(id));
	bodies.resize(count);
	orientations.resize(count);
	world.bodies.resize(count);
	world.shapes.resize(count);
	world.masks.resize(count, 0);
	forces.sync();
	for (int id = 0; id < count; id++) {
		if (id + ahead < count)
			prefetchBody(bodies[id + ahead]);
		const boost::shared_ptr<yade::Body>& body = container[id];
		KnownBody& known = bodies[id];
		if (known.exists && !isSame(known.identity, body))
			gone.push_back(id);
		const bool boundary = known.boundary, inPlane = known.inPlane;
		if (body)
			readBody(id, body, forces, g);
		else {
			known = KnownBody();
			world.bodies[id] = cd::Body();
			world.masks[id] = 0;
		}
		changed = changed || known.boundary != boundary || known.inPlane != inPlane;
	}
	outdated = changed || !gone.empty();
}

} // namespace cd_engine
