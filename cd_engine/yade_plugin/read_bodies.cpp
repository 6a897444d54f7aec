// What the bodies are and how they move now, read from the scene; what the engine cannot do is refused here.
#include "inheritance.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace cd_engine {
namespace {

	constexpr unsigned dofX = 1, dofY = 2, dofZ = 4, rotX = 8, rotY = 16, rotZ = 32;

	[[noreturn]] void refuseBody(int id, const std::string& what, const std::string& remedy)
	{
		throw SceneError("ContactDynamics: body #" + std::to_string(id) + " " + what + ". " + remedy);
	}

	std::string className(void* serializable) { return static_cast<yade::Serializable*>(serializable)->getClassName(); }

	// One test for several vectors, since nearly always all are well: a product with 0 is 0 unless there is an infinity or a NaN.
	template <class... V> bool allFinite(const V&... v) { return ((v[0] * 0 + v[1] * 0 + v[2] * 0) + ...) == 0; }

	std::string text(double x)
	{
		std::ostringstream s;
		s << x;
		return s.str();
	}

	void mustBeFinite(int id, const char* what, const Vector3r& v)
	{
		if (!v.allFinite())
			refuseBody(id, std::string("has a ") + what + " that is not a number",
			    "Look for what set O.bodies[" + std::to_string(id) + "] to it, or for a failed step before");
	}

} // namespace

// What a body is, looked at once: which of the shapes, whether the engine can move it.
void SceneLink::inspect(int id, void* body)
{
	KnownBody known;
	char* const raw = static_cast<char*>(body);
	known.body = body;
	known.exists = true;
	known.state = static_cast<char*>(pointer<yade::State>(raw, layout.body_state));
	known.shape = pointer<yade::Shape>(raw, layout.body_shape);
	known.material = pointer<yade::Material>(raw, layout.body_material);
	const std::string name = "O.bodies[" + std::to_string(id) + "]";
	if (at<int>(raw, layout.body_clumpId) >= 0)
		refuseBody(id, "belongs to a clump", "Release the clump (O.bodies.releaseClump) or use single disks");
	if (!known.state)
		refuseBody(id, "has no state", "Give it one: " + name + ".state=State()");
	if (!known.shape)
		refuseBody(id, "has no shape", "Use Sphere, Box or Wall, or erase it");
	const std::string shape = className(known.shape);
	if (shape == "Sphere")
		known.kind = cd::ShapeKind::disk;
	else if (shape == "Box")
		known.kind = cd::ShapeKind::box;
	else if (shape == "Wall")
		known.kind = cd::ShapeKind::wall;
	else
		refuseBody(id, "has the shape " + shape, "Only Sphere (a disk), Box and Wall are known; replace or erase it");
	known.boundary = known.kind != cd::ShapeKind::disk;
	if (!known.material || !inherits(known.material, Base::FrictMat))
		refuseBody(id, "has a material without friction angle", "Use FrictMat or a material derived from it");

	known.inPlane = true;
	if (known.kind == cd::ShapeKind::disk) {
		const double z = at<Vector3r>(known.state, layout.state_se3)[2], radius = at<double>(known.shape, layout.sphere_radius);
		if (!(radius > 0))
			refuseBody(id, "has the radius " + text(radius) + " m", "A disk needs a positive one");
		if (!(std::abs(z - layer) <= 1e-9 * radius))
			refuseBody(id, "has z = " + text(z) + " m but body #" + std::to_string(layerId) + " has z = " + text(layer) + " m",
			    "Put all disks in one plane");
	} else if (known.kind == cd::ShapeKind::wall)
		known.inPlane = at<int>(known.shape, layout.wall_axis) != 2;
	bodies[id] = known;
	world.bodies[id] = {};
	world.shapes[id] = {};
	world.shapes[id].kind = known.kind;
}

// The plane of the disks is that of the first one; if that one is gone, everything is looked at anew.
void SceneLink::findLayer(yade::BodyContainer& container)
{
	if (layerId >= 0 && layerId < static_cast<int>(container.size()) && container[layerId].get() == layerBody)
		return;
	layerId = -1;
	layerBody = nullptr;
	bodies.assign(container.size(), KnownBody());
	for (std::size_t id = 0; id < container.size(); id++) {
		void* const body = container[id].get();
		if (!body)
			continue;
		void* const shape = pointer<yade::Shape>(static_cast<char*>(body), layout.body_shape);
		if (!shape || className(shape) != "Sphere")
			continue;
		layerId = static_cast<int>(id);
		layerBody = body;
		layer = at<Vector3r>(pointer<yade::State>(static_cast<char*>(body), layout.body_state), layout.state_se3)[2];
		return;
	}
}

// Whether the freedoms and velocities the body has now are those of a plane motion.
void SceneLink::inspectMotion(int id) const
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
	if ((at<unsigned>(state, layout.state_blockedDOFs) & outside) != outside)
		refuseBody(id, "is free to leave the plane",
		    "Set O.bodies[" + std::to_string(id) + "].state.blockedDOFs='zXY' (a boundary also blocks what is not to move)");
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
		refuseBody(id, "is free to move but has the mass " + text(mass) + " kg",
		    "Set O.bodies[" + std::to_string(id) + "].state.mass, or block its freedoms");
	if (turns && !(inertia > 0 && std::isfinite(inertia)))
		refuseBody(id, "is free to turn but has the moment of inertia " + text(inertia) + " kg m^2 about z",
		    "Set O.bodies[" + std::to_string(id) + "].state.inertia, or block 'Z'");
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

// The shape, whose size and orientation may change at any time, and the friction.
void SceneLink::readShape(int id, cd::Body& body)
{
	KnownBody& known = bodies[id];
	cd::Shape& shape = world.shapes[id];
	if (known.kind == cd::ShapeKind::disk)
		body.radius = at<double>(known.shape, layout.sphere_radius);
	else if (known.kind == cd::ShapeKind::box) {
		const Vector3r& extents = at<Vector3r>(known.shape, layout.box_extents);
		const double* q = &at<double>(known.state, layout.state_orientation);
		const double norm = q[2] * q[2] + q[3] * q[3];
		if (std::abs(q[0]) > 1e-9 || std::abs(q[1]) > 1e-9)
			refuseBody(id, "is a box turned out of the plane", "Turn it about z only");
		if (!(norm > 0.5 && norm < 2))
			refuseBody(id, "has an orientation that is not a rotation",
			    "Set O.bodies[" + std::to_string(id) + "].state.ori to a unit quaternion");
		// A box that the disks' plane does not cut (a front or back wall) is never touched.
		known.inPlane = layerId < 0 || std::abs(at<Vector3r>(known.state, layout.state_se3)[2] - layer) <= extents[2] * (1 + 1e-9);
		shape.ex = extents[0];
		shape.ey = extents[1];
		shape.cosine = (q[3] * q[3] - q[2] * q[2]) / norm;
		shape.sine = 2 * q[2] * q[3] / norm;
	} else {
		shape.axis = at<int>(known.shape, layout.wall_axis);
		shape.sense = at<int>(known.shape, layout.wall_sense);
	}
	const double angle = at<double>(known.material, layout.frictMat_frictionAngle);
	if (angle != known.frictionAngle) {
		if (!(angle >= 0 && angle < 1.5707963267948966))
			refuseBody(id, "has the friction angle " + text(angle) + " rad", "It must lie in [0, pi/2)");
		known.frictionAngle = angle;
		known.friction = std::tan(angle);
	}
}

// The lines of memory that a step reads of a body's objects, asked for before they are wanted.
void SceneLink::prefetchBody(const KnownBody& known) const
{
	if (!known.exists)
		return;
	prefetch(known.body, layout.body_material);
	prefetch(known.body, layout.body_shape);
	prefetch(known.shape, layout.sphere_radius);
	for (const long member : { layout.state_se3, layout.state_vel, layout.state_angVel, layout.state_inertia, layout.state_blockedDOFs })
		prefetch(known.state, member);
}

void SceneLink::gatherBodies(yade::Scene* scene, const Vector3r& g)
{
	constexpr int ahead = 6;
	auto& container = *at<boost::shared_ptr<yade::BodyContainer>>(scene, layout.scene_bodies);
	auto& forces = at<yade::ForceContainer>(scene, layout.scene_forces);
	const int count = static_cast<int>(container.size());
	findLayer(container);
	bodies.resize(count);
	surfaces.resize(count);
	world.bodies.resize(count);
	world.shapes.resize(count);
	forces.sync();
	for (int id = 0; id < count; id++) {
		if (id + ahead < count)
			prefetchBody(bodies[id + ahead]);
		char* const body = reinterpret_cast<char*>(container[id].get());
		KnownBody& known = bodies[id];
		if (!body) {
			known = KnownBody();
			world.bodies[id] = cd::Body();
			continue;
		}
		if (known.body != body || known.state != pointer<yade::State>(body, layout.body_state)
		    || known.shape != pointer<yade::Shape>(body, layout.body_shape)
		    || known.material != pointer<yade::Material>(body, layout.body_material))
			inspect(id, body);
		inspectMotion(id);
		readShape(id, world.bodies[id]);
		readMotion(id, world.bodies[id], forces, g);
		world.bodies[id].friction = known.friction;
		surfaces[id] = { known.friction, world.bodies[id].radius };
	}
}

void SceneLink::checkScene(yade::Scene* scene, double dt) const
{
	if (at<bool>(scene, layout.scene_isPeriodic))
		throw SceneError("ContactDynamics: the scene is periodic, which is not supported. Set O.periodic=False and use walls");
	if (!(dt > 0 && std::isfinite(dt)))
		throw SceneError("ContactDynamics: the time step O.dt is " + text(dt) + " s. Set it to a positive number");
}

void SceneLink::gather(yade::Scene* scene, const Vector3r& g, double dt, bool impulses, const Memory& memory, bool look, ColliderRest& rest,
    double margin, cd::Sleepers& sleepers)
{
	checkScene(scene, dt);
	gravity = g;
	gatherBodies(scene, g);
	if (cd::renewOrder(world, memory.order, look))
		listed.clear();
	// A list that changed while the collider rested was changed by somebody else, and may lack pairs.
	rest.refresh(
	    world, scene, dt, margin, !listUnchanged(at<boost::shared_ptr<yade::InteractionContainer>>(scene, layout.scene_interactions).get()));
	gatherPairs(scene, dt, impulses, memory, sleepers);
}

void SceneLink::inspectScene(yade::Scene* scene, const Vector3r& g, double dt, bool impulses, const Memory& memory, bool look)
{
	namespace py = boost::python;
	inspecting = true;
	checkScene(scene, dt);
	gatherBodies(scene, g);
	// O.forces holds what the last step left there, its contact forces among them; a ForceResetter comes before the next one.
	const py::object lasting = py::import("yade").attr("O").attr("forces");
	const bool any = py::extract<bool>(lasting.attr("getPermForceUsed")());
	for (int id = 0; id < static_cast<int>(world.bodies.size()); id++) {
		cd::Body& body = world.bodies[id];
		if (!bodies[id].exists || !(body.inverseMass[0] > 0 || body.inverseMass[1] > 0 || body.inverseMass[2] > 0))
			continue;
		Vector3r force = Vector3r::Zero(), torque = Vector3r::Zero();
		if (any) { // YADE reads past the end of its list where there are none
			force = py::extract<Vector3r>(lasting.attr("permF")(id));
			torque = py::extract<Vector3r>(lasting.attr("permT")(id));
		}
		setForce(id, body, force, torque, g);
	}
	cd::renewOrder(world, memory.order, look);
	cd::Sleepers none;
	gatherPairs(scene, dt, impulses, memory, none);
}

} // namespace cd_engine
