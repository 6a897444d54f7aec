#include "inheritance.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

namespace cd_engine {
namespace {

	constexpr unsigned dofX = 1, dofY = 2, dofZ = 4, rotX = 8, rotY = 16, rotZ = 32;

	[[noreturn]] void refuseBody(int id, const std::string& what, const std::string& remedy)
	{
		throw SceneError("ContactDynamics: body #" + std::to_string(id) + " " + what + ". " + remedy);
	}

	std::string className(void* serializable) { return static_cast<yade::Serializable*>(serializable)->getClassName(); }

	std::string text(double x)
	{
		std::ostringstream s;
		s << x;
		return s.str();
	}

	void mustBeFinite(int id, const char* what, const Vector3r& v)
	{
		if (!v.allFinite())
			refuseBody(id, std::string("has a ") + what + " that is not a number", "Look for what set O.bodies[" + std::to_string(id) + "] to it, or for a failed step before");
	}

	// Where a pair comes in the sweeps. A function of its ids alone, so that the result of a step depends neither on the order of the
	// scene's list nor on which other pairs are in it. Pairs of 32 neighbouring ids stay together, for locality, and are scattered
	// among themselves, so that a sweep seldom waits on velocities it has just written (a third faster than sorted ids).
	uint64_t sweepKey(int id1, int id2)
	{
		const uint64_t low = std::min(id1, id2), high = std::max(id1, id2);
		uint64_t       h = (low << 32 | high) * 0x9E3779B97F4A7C15ull; // Fibonacci hashing (Knuth, vol. 3, section 6.4)
		h ^= h >> 32;
		h *= 0xD6E8FEB86659FD93ull;
		return low >> 5 << 40 | h >> 24;
	}

	template <class T> void* pointer(char* object, long offset) { return at<boost::shared_ptr<T>>(object, offset).get(); }

} // namespace

// What a body is, looked at once: which of the shapes, whether the engine can move it.
void SceneLink::inspect(int id, void* body)
{
	KnownBody known;
	char* const raw = static_cast<char*>(body);
	known.body      = body;
	known.exists    = true;
	known.state     = static_cast<char*>(pointer<yade::State>(raw, layout.body_state));
	known.shape     = pointer<yade::Shape>(raw, layout.body_shape);
	known.material  = pointer<yade::Material>(raw, layout.body_material);
	const std::string name = "O.bodies[" + std::to_string(id) + "]";
	if (at<int>(raw, layout.body_clumpId) >= 0) refuseBody(id, "belongs to a clump", "Release the clump (O.bodies.releaseClump) or use single disks");
	if (!known.state) refuseBody(id, "has no state", "Give it one: " + name + ".state=State()");
	if (!known.shape) refuseBody(id, "has no shape", "Use Sphere, Box or Wall, or erase it");
	const std::string shape = className(known.shape);
	if (shape == "Sphere") known.kind = cd::ShapeKind::disk;
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
		if (!(radius > 0)) refuseBody(id, "has the radius " + text(radius) + " m", "A disk needs a positive one");
		if (!(std::abs(z - layer) <= 1e-9 * radius))
			refuseBody(id, "has z = " + text(z) + " m but body #" + std::to_string(layerId) + " has z = " + text(layer) + " m", "Put all disks in one plane");
	} else if (known.kind == cd::ShapeKind::wall)
		known.inPlane = at<int>(known.shape, layout.wall_axis) != 2;
	bodies[id] = known;
}

// The plane of the disks is that of the first one; if that one is gone, everything is looked at anew.
void SceneLink::findLayer(yade::BodyContainer& container)
{
	if (layerId >= 0 && layerId < static_cast<int>(container.size()) && container[layerId].get() == layerBody) return;
	layerId   = -1;
	layerBody = nullptr;
	bodies.assign(container.size(), KnownBody());
	for (std::size_t id = 0; id < container.size(); id++) {
		void* const body = container[id].get();
		if (!body) continue;
		void* const shape = pointer<yade::Shape>(static_cast<char*>(body), layout.body_shape);
		if (!shape || className(shape) != "Sphere") continue;
		layerId   = static_cast<int>(id);
		layerBody = body;
		layer     = at<Vector3r>(pointer<yade::State>(static_cast<char*>(body), layout.body_state), layout.state_se3)[2];
		return;
	}
}

// Whether the freedoms and velocities the body has now are those of a plane motion.
void SceneLink::inspectMotion(int id) const
{
	char* const     state = bodies[id].state;
	const Vector3r& velocity = at<Vector3r>(state, layout.state_vel);
	const Vector3r& spin     = at<Vector3r>(state, layout.state_angVel);
	mustBeFinite(id, "position", at<Vector3r>(state, layout.state_se3));
	mustBeFinite(id, "velocity", velocity);
	mustBeFinite(id, "angular velocity", spin);
	constexpr unsigned outside = dofZ | rotX | rotY;
	if ((at<unsigned>(state, layout.state_blockedDOFs) & outside) != outside)
		refuseBody(id, "is free to leave the plane", "Set O.bodies[" + std::to_string(id) + "].state.blockedDOFs='zXY' (a boundary also blocks what is not to move)");
	if (velocity[2] != 0 || spin[0] != 0 || spin[1] != 0)
		refuseBody(id, "moves out of the plane", "Set its z velocity and its x and y angular velocities to 0");
}

void SceneLink::readMotion(int id, cd::Body& body, yade::ForceContainer& forces, const Vector3r& g) const
{
	char* const     state    = bodies[id].state;
	const Vector3r& position = at<Vector3r>(state, layout.state_se3);
	const Vector3r& velocity = at<Vector3r>(state, layout.state_vel);
	body.x    = position[0];
	body.y    = position[1];
	body.v[0] = velocity[0];
	body.v[1] = velocity[1];
	body.v[2] = at<Vector3r>(state, layout.state_angVel)[2];

	const unsigned blocked = at<unsigned>(state, layout.state_blockedDOFs);
	const bool     moves   = !(blocked & dofX) || !(blocked & dofY), turns = !(blocked & rotZ);
	const double   mass    = at<double>(state, layout.state_mass), inertia = at<Vector3r>(state, layout.state_inertia)[2];
	if (moves && !(mass > 0 && std::isfinite(mass))) refuseBody(id, "is free to move but has the mass " + text(mass) + " kg", "Set O.bodies[" + std::to_string(id) + "].state.mass, or block its freedoms");
	if (turns && !(inertia > 0 && std::isfinite(inertia)))
		refuseBody(id, "is free to turn but has the moment of inertia " + text(inertia) + " kg m^2 about z", "Set O.bodies[" + std::to_string(id) + "].state.inertia, or block 'Z'");
	body.inverseMass[0] = blocked & dofX ? 0 : 1 / mass;
	body.inverseMass[1] = blocked & dofY ? 0 : 1 / mass;
	body.inverseMass[2] = blocked & rotZ ? 0 : 1 / inertia;
	std::fill_n(body.force, 3, 0.);
	if (!moves && !turns) return;
	const Vector3r &force = forces.getForce(id), &torque = forces.getTorque(id);
	mustBeFinite(id, "force", force);
	mustBeFinite(id, "torque", torque);
	body.force[0] = force[0] + (moves ? mass * g[0] : 0);
	body.force[1] = force[1] + (moves ? mass * g[1] : 0);
	body.force[2] = torque[2];
}

// The shape, whose size and orientation may change at any time, and the friction.
void SceneLink::readShape(int id, cd::Body& body)
{
	KnownBody& known = bodies[id];
	cd::Shape&       shape = body.shape;
	shape.kind             = known.kind;
	if (known.kind == cd::ShapeKind::disk) shape.radius = at<double>(known.shape, layout.sphere_radius);
	else if (known.kind == cd::ShapeKind::box) {
		const Vector3r& extents = at<Vector3r>(known.shape, layout.box_extents);
		const double*   q       = &at<double>(known.state, layout.state_orientation);
		const double    norm    = q[2] * q[2] + q[3] * q[3];
		if (std::abs(q[0]) > 1e-9 || std::abs(q[1]) > 1e-9) refuseBody(id, "is a box turned out of the plane", "Turn it about z only");
		// A box that the disks' plane does not cut (a front or back wall) is never touched.
		known.inPlane = layerId < 0 || std::abs(at<Vector3r>(known.state, layout.state_se3)[2] - layer) <= extents[2] * (1 + 1e-9);
		shape.ex     = extents[0];
		shape.ey     = extents[1];
		shape.cosine = (q[3] * q[3] - q[2] * q[2]) / norm;
		shape.sine   = 2 * q[2] * q[3] / norm;
	} else {
		shape.axis  = at<int>(known.shape, layout.wall_axis);
		shape.sense = at<int>(known.shape, layout.wall_sense);
	}
	const double angle = at<double>(known.material, layout.frictMat_frictionAngle);
	if (angle != known.frictionAngle) {
		if (!(angle >= 0 && angle < 1.5707963267948966)) refuseBody(id, "has the friction angle " + text(angle) + " rad", "It must lie in [0, pi/2)");
		known.frictionAngle = angle;
		known.friction      = std::tan(angle);
	}
}

void SceneLink::gatherBodies(yade::Scene* scene, const Vector3r& g)
{
	auto& container = *at<boost::shared_ptr<yade::BodyContainer>>(scene, layout.scene_bodies);
	auto& forces    = at<yade::ForceContainer>(scene, layout.scene_forces);
	const int count = static_cast<int>(container.size());
	findLayer(container);
	bodies.resize(count);
	world.bodies.resize(count);
	forces.sync();
	for (int id = 0; id < count; id++) {
		char* const body  = reinterpret_cast<char*>(container[id].get());
		KnownBody&  known = bodies[id];
		if (!body) {
			known            = KnownBody();
			world.bodies[id] = cd::Body();
			continue;
		}
		if (known.body != body || known.state != pointer<yade::State>(body, layout.body_state) || known.shape != pointer<yade::Shape>(body, layout.body_shape)
		    || known.material != pointer<yade::Material>(body, layout.body_material))
			inspect(id, body);
		inspectMotion(id);
		readShape(id, world.bodies[id]);
		readMotion(id, world.bodies[id], forces, g);
	}
}

bool SceneLink::pairsUnchanged(yade::InteractionContainer* container) const
{
	const auto& all = at<std::vector<boost::shared_ptr<yade::Interaction>>>(container, layout.interactions_linear);
	if (all.size() != listed.size()) return false;
	for (std::size_t i = 0; i < all.size(); i++) {
		yade::Interaction* const p = all[i].get();
		if (p != listed[i].interaction || at<int>(p, layout.interaction_id1) != listed[i].id1 || at<int>(p, layout.interaction_id2) != listed[i].id2) return false;
	}
	return true;
}

void SceneLink::rebuildPairs(yade::InteractionContainer* container, const ReferenceOverlaps& known)
{
	const auto& all = at<std::vector<boost::shared_ptr<yade::Interaction>>>(container, layout.interactions_linear);
	std::vector<cd::Pair>           pairs;
	std::vector<yade::Interaction*> of;
	const int count = static_cast<int>(bodies.size());
	for (const auto& shared : all) {
		yade::Interaction* const interaction = shared.get();
		int&                     id1 = at<int>(interaction, layout.interaction_id1);
		int&                     id2 = at<int>(interaction, layout.interaction_id2);
		if (id1 >= count || id2 >= count || !bodies[id1].exists || !bodies[id2].exists) continue;
		if ((bodies[id1].boundary && bodies[id2].boundary) || !bodies[id1].inPlane || !bodies[id2].inPlane) continue;
		if (bodies[id2].boundary) { // YADE's own functors, too, want the boundary first
			at<boost::shared_ptr<yade::IGeom>>(interaction, layout.interaction_geom).reset();
			at<boost::shared_ptr<yade::IPhys>>(interaction, layout.interaction_phys).reset();
			interaction->swapOrder();
		}
		cd::Pair pair;
		pair.a = id1;
		pair.b = id2;
		pair.reference = known.of(id1, id2);
		pairs.push_back(pair);
		of.push_back(interaction);
	}
	std::vector<uint64_t> keys;
	for (const cd::Pair& pair : pairs)
		keys.push_back(sweepKey(pair.a, pair.b));
	std::vector<int32_t> order(pairs.size());
	std::iota(order.begin(), order.end(), 0);
	std::sort(order.begin(), order.end(), [&](int32_t i, int32_t j) { return keys[i] < keys[j]; });
	world.pairs.clear();
	interactions.clear();
	spare.assign(pairs.size(), {});
	for (const int32_t i : order) {
		world.pairs.push_back(pairs[i]);
		interactions.push_back(of[i]);
	}
	listed.clear();
	for (const auto& shared : all)
		listed.push_back({ shared.get(), at<int>(shared.get(), layout.interaction_id1), at<int>(shared.get(), layout.interaction_id2) });
}

// Where each pair's geometry and forces lie. Three dependent look-ups a pair, all in different cache lines: asked for ahead.
void SceneLink::findForces()
{
	constexpr std::size_t ahead = 8;
	forces.resize(world.pairs.size());
	const auto objects = [&](std::size_t i) {
		return Forces { at<boost::shared_ptr<yade::IGeom>>(interactions[i], layout.interaction_geom).get(), at<boost::shared_ptr<yade::IPhys>>(interactions[i], layout.interaction_phys).get() };
	};
	for (std::size_t i = 0; i < interactions.size() + ahead; i++) {
		if (i < interactions.size()) {
			forces[i] = objects(i);
			if (forces[i].geom) __builtin_prefetch(forces[i].geom);
			if (forces[i].phys) __builtin_prefetch(forces[i].phys);
			if (i + ahead < interactions.size()) __builtin_prefetch(static_cast<char*>(static_cast<void*>(interactions[i + ahead])) + layout.interaction_geom);
		}
		if (i < ahead) continue;
		Forces& f = forces[i - ahead];
		if (!f.geom || !f.phys || !inherits(f.geom, Base::ScGeom) || !inherits(f.phys, Base::FrictPhys)) f = { nullptr, nullptr };
	}
}

// The force present on the contact, along its own normal, times dt: what YADE keeps is all the memory a warm start needs.
void SceneLink::readImpulse(std::size_t index, double dt)
{
	cd::Pair& pair = world.pairs[index];
	pair.pn = pair.pt = 0;
	if (!forces[index].geom) return;
	const Vector3r& n  = at<Vector3r>(forces[index].geom, layout.geom_normal);
	const Vector3r& fn = at<Vector3r>(forces[index].phys, layout.phys_normalForce);
	const Vector3r& ft = at<Vector3r>(forces[index].phys, layout.phys_shearForce);
	const double    normal = n[0] * fn[0] + n[1] * fn[1], tangential = n[0] * ft[1] - n[1] * ft[0];
	if (!(normal > 0) || !std::isfinite(tangential)) return; // springs may pull; a rigid contact does not
	pair.pn = dt * normal;
	pair.pt = dt * tangential;
}

void SceneLink::gatherPairs(yade::Scene* scene, double dt, bool impulses, const ReferenceOverlaps& known)
{
	auto* const container = at<boost::shared_ptr<yade::InteractionContainer>>(scene, layout.scene_interactions).get();
	if (!pairsUnchanged(container)) rebuildPairs(container, known);
	findForces();
	for (std::size_t i = 0; i < world.pairs.size(); i++) {
		cd::Pair& pair = world.pairs[i];
		pair.mu = std::min(bodies[pair.a].friction, bodies[pair.b].friction); // the smaller angle of the two, as YADE
		if (impulses) readImpulse(i, dt);
		else
			pair.pn = pair.pt = 0;
	}
}

void SceneLink::gather(yade::Scene* scene, const Vector3r& g, double dt, bool impulses, const ReferenceOverlaps& known, ColliderRest& rest)
{
	if (at<bool>(scene, layout.scene_isPeriodic)) throw SceneError("ContactDynamics: the scene is periodic, which is not supported. Set O.periodic=False and use walls");
	if (!(dt > 0 && std::isfinite(dt))) throw SceneError("ContactDynamics: the time step O.dt is " + text(dt) + " s. Set it to a positive number");
	gravity = g;
	gatherBodies(scene, g);
	rest.refresh(world, scene, cd::reach(world, dt));
	gatherPairs(scene, dt, impulses, known);
}

void SceneLink::takeOverlaps()
{
	for (cd::Pair& pair : world.pairs) {
		pair.reference = 0;
		cd::locateContact(pair, world.bodies[pair.a], world.bodies[pair.b], 0);
		pair.reference = std::max(0., pair.overlap);
	}
}

void SceneLink::collectOverlaps(const ReferenceOverlaps& all) const
{
	std::vector<const cd::Pair*> kept;
	for (const cd::Pair& pair : world.pairs)
		if (pair.reference > 0) kept.push_back(&pair);
	std::sort(kept.begin(), kept.end(), [](const cd::Pair* p, const cd::Pair* q) { return std::minmax(p->a, p->b) < std::minmax(q->a, q->b); });
	all.ids.clear();
	all.overlaps.clear();
	for (const cd::Pair* pair : kept) {
		all.ids.push_back(std::min(pair->a, pair->b));
		all.ids.push_back(std::max(pair->a, pair->b));
		all.overlaps.push_back(pair->reference);
	}
}

// By bisection: the pairs are sorted by their ids.
double ReferenceOverlaps::of(int id1, int id2) const
{
	const std::pair<int, int> wanted(std::min(id1, id2), std::max(id1, id2));
	std::size_t               low = 0, high = overlaps.size();
	while (low < high) {
		const std::size_t middle = (low + high) / 2;
		if (std::make_pair(ids[2 * middle], ids[2 * middle + 1]) < wanted) low = middle + 1;
		else
			high = middle;
	}
	return low < overlaps.size() && std::make_pair(ids[2 * low], ids[2 * low + 1]) == wanted ? overlaps[low] : 0;
}

} // namespace cd_engine
