// Reads from the scene what the bodies and their shapes are and how they move now. Refuses what the engine cannot do.
#include "body_checks.hpp"

#include <algorithm>
#include <cmath>

namespace cd_engine {

// Prefetches the memory lines of a body's objects that a step reads.
void prefetchBody(const KnownBody& known)
{
	if (!known.body)
		return;
	prefetch(known.body, { body_material, body_shape });
	prefetch(known.shape, { 0, sphere_radius });
	prefetch(known.state, { state_pos, state_vel, state_angVel, state_inertia, state_blockedDOFs });
}

template <class Space> void SceneLink<Space>::readVelocity(int id, Body& body)
{
	for (int k = 0; k < Space::freedoms; k++)
		body.v[k] = frame.velocity(bodies[id].state, k);
	if (world.surfaces.empty())
		return;
	std::array<double, Space::freedoms> now {};
	if (!(body_groupMask(bodies[id].body) & mask)) {
		std::copy_n(body.v, Space::freedoms, now.begin());
		std::fill_n(body.v, Space::freedoms, 0.);
	}
	newSurfaces = newSurfaces || now != world.surfaces[id];
	world.surfaces[id] = now;
}

template <class Space> void SceneLink<Space>::readFriction(int id, void* mat)
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
template <class Space> void SceneLink<Space>::readRolling(int id, void* mat)
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
// before: where the same body was after the last step.
template <class Space> void SceneLink<Space>::warnOfPlacing(int id, const Vector& before, long step)
{
	constexpr int often = 3, apart = 100; // steps between two moves from which on a scene is rather set up anew
	const Body& b = world.bodies[id];
	const Vector now = centreOf(b);
	KnownBody& known = bodies[id];
	bool placed = false;
	for (int k = 0; k < Space::components; k++)
		placed = placed || !(now[k] == before[k] || b.inverseMass[k] != 0 || b.v[k] != 0);
	if (!placed) {
		known.placed = 0;
		return;
	}
	known.placed = step - known.placedAt < apart ? std::min(known.placed + 1, often) : 1;
	known.placedAt = step;
	if (known.placed < often)
		return;
	placesBoundaries = true;
	warnOnce(text("body #", id, " is moved by its position while its velocity is 0: Contact Dynamics sees velocities only."),
	    text("It came by ", length(now - before), " m since the last step and cuts into what is there. Set O.bodies[", id,
		"].state.vel instead, in an engine before ContactDynamics."));
}

// Reads all that a step needs to know of a body. Every step looks at all of it, since anybody may have changed it.
template <class Space> void SceneLink<Space>::readBody(int id, const Shared<yade::Body>& body, yade::ForceContainer& forces, long step)
{
	KnownBody& known = bodies[id];
	const bool same = known.body && isSame(known.identity, body);
	if (known.body && !same)
		gone.push_back(id);
	if (!body) {
		known = KnownBody();
		world.bodies[id] = Body();
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
		refuseBody(id, "has no shape", "Set O.bodies[#].shape to a Sphere, Box, Wall or Facet, or erase the body");
	checkMotion(id);
	readOrientation(id);
	const bool inPlane = readShape(id, world.bodies[id]);
	readFriction(id, body_material(body).get());
	const Vector before = centreOf(world.bodies[id]);
	readMotion(id, world.bodies[id], forces);
	constexpr int bounded = 1; // YADE's bit of Body.flags
	world.masks[id] = inPlane && (body_flags(body) & bounded) != 0 ? body_groupMask(body) : 0;
	if (same && world.masks[id] != 0)
		warnOfPlacing(id, before, step);
}

template <class Space> void SceneLink<Space>::gatherBodies(yade::Scene* scene)
{
	constexpr int ahead = 6;
	auto& container = *scene_bodies(scene);
	auto& forces = scene_forces(scene);
	findFrame(container);
	const int count = static_cast<int>(container.size());
	bool changed = outdated || bodies.size() != container.size();
	outdated = true; // stays true if a body is refused
	bodies.resize(count);
	orientations.resize(count);
	world.bodies.resize(count);
	world.shapes.resize(count);
	world.masks.resize(count, 0);
	world.still.resize(count);
	world.reading++;
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
		const Body& b = world.bodies[id];
		world.still[id] = isBoundary(b) && isGuided(b) && std::none_of(b.v, b.v + Space::freedoms, [](double v) { return v != 0; })
		    && (world.surfaces.empty() || !world.isBelt(id));
		changed = changed || isBoundary(world.bodies[id]) != boundary || (world.masks[id] != 0) != joins || bodies[id].material != material;
	}
	std::sort(gone.begin(), gone.end());
	outdated = changed || !gone.empty();
}

template void SceneLink<cd::Plane>::gatherBodies(yade::Scene*);
template void SceneLink<cd::Space3>::gatherBodies(yade::Scene*);
template void SceneLink<cd::Plane>::readVelocity(int, cd::Body&);
template void SceneLink<cd::Space3>::readVelocity(int, cd::SpaceBody&);

} // namespace cd_engine
