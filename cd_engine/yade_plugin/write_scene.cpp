#include "kind.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

namespace cd_engine {
namespace {

	constexpr std::size_t early = 10; // number of contacts or bodies ahead whose memory is prefetched

	template <class T> Shared<T> create(const char* name)
	{
		return boost::reinterpret_pointer_cast<T>(Singleton<yade::ClassFactory>::instance().createShared(name));
	}

	// Prefetches the memory lines that writeContact writes.
	void prefetchContact(const ForceObjects& o)
	{
		if (!o.inUse())
			return;
		prefetch(o.geom.get(), { geom_normal, geom_contactPoint + 16, geom_penetrationDepth });
		prefetch(o.phys.get(), { phys_normalForce, phys_tangensOfFrictionAngle });
	}

	// Whether the bounding boxes that the collider knows are apart, or one is missing.
	bool boundsApart(const Shared<yade::Body>& a, const Shared<yade::Body>& b)
	{
		if (!a || !b || !body_bound(a) || !body_bound(b))
			return true;
		const Vector3r &lowA = bound_min(body_bound(a)), &highA = bound_max(body_bound(a));
		const Vector3r &lowB = bound_min(body_bound(b)), &highB = bound_max(body_bound(b));
		return (lowA.array() > highB.array()).any() || (lowB.array() > highA.array()).any();
	}

} // namespace

// Keeps the objects of forgotten pairs, so that contacts that come and go allocate no memory. Objects that somebody else holds, or that springs have
// made, are not kept, because stiffnesses stay with their pair.
void SceneLink::recycle(ForceObjects&& o)
{
	static Kind isPlainGeom { "ScGeom", Kind::exactly }, isPlainPhys { "FrictPhys", Kind::exactly };
	static Kind isTurningGeom { "ScGeom6D", Kind::exactly }, isMomentPhys { "CohFrictPhys", Kind::exactly };
	if (o.geom.use_count() != 1 || o.phys.use_count() != 1 || !(phys_kn(o.phys) == 0 || world.compliant()))
		return;
	o.holdMoment = isMomentPhys(o.phys.get());
	if (o.holdMoment ? !isTurningGeom(o.geom.get()) : !isPlainGeom(o.geom.get()) || !isPlainPhys(o.phys.get()))
		return;
	phys_kn(o.phys) = phys_ks(o.phys) = 0;
	if (o.holdMoment)
		cohPhys_kr(o.phys) = 0;
	(o.holdMoment ? momentPool : pool).push_back(std::move(o));
}

// Gives an interaction to a pair that carries something for the first time.
void SceneLink::insert(yade::InteractionContainer& container, std::size_t index)
{
	const int a = world.pairs[index].a, b = world.pairs[index].b;
	if (!container.find(a, b))
		container.insert(a, b);
	interactions[index] = container.find(a, b).get();
	turn(index);
}

// Empties and erases the interactions of pairs that no longer exist. Those that the collider would keep, by the bounds that it knows, stay in the
// list, because the collider notices only changes.
void SceneLink::eraseParted(yade::Scene* scene)
{
	auto& container = *scene_interactions(scene);
	auto& all = *scene_bodies(scene);
	const auto& list = interactionsOf(scene);
	std::sort(parted.begin(), parted.end());
	for (std::size_t i = parted.empty() ? 0 : list.size(); i-- > 0;) { // backwards: the last one takes the place of an erased one
		yade::Interaction* const interaction = list[i].get();
		if (!std::binary_search(parted.begin(), parted.end(), interaction))
			continue;
		recycle({ std::move(interaction_geom(interaction)), std::move(interaction_phys(interaction)) });
		forget(interaction);
		const int a = interaction_id1(interaction), b = interaction_id2(interaction);
		if (boundsApart(all[a], all[b]))
			container.erase(a, b, static_cast<int>(i));
	}
	parted.clear();
}

// Gives an interaction the objects that hold its force: those from when it was last loaded, or others, in which every member is set anew.
void SceneLink::makeReal(std::size_t index)
{
	ForceObjects& o = objects[index];
	const bool moment = rolls(index);
	if (moment && !o.holdMoment)
		recycle(std::exchange(o, {}));
	std::vector<ForceObjects>& kept = moment ? momentPool : pool;
	if (!o.geom && kept.empty())
		o = { create<yade::IGeom>(moment ? "ScGeom6D" : "ScGeom"), create<yade::IPhys>(moment ? "CohFrictPhys" : "FrictPhys"), false,
			moment };
	else if (!o.geom) {
		o = std::move(kept.back());
		kept.pop_back();
	}
	o.real = true;
	interaction_geom(interactions[index]) = o.geom;
	interaction_phys(interactions[index]) = o.phys;
	const cd::Body &a = world.bodyOf(world.pairs[index].a), &b = world.bodyOf(world.pairs[index].b);
	geom_refR1(o.geom) = isBoundary(a) ? b.radius : a.radius;
	geom_refR2(o.geom) = b.radius;
	geom_shearInc(o.geom) = Vector3r::Zero();
	geom_normal(o.geom) = Vector3r::Zero(); // YADE does not initialise it; no contact has a zero normal
}

// The forces in YADE's signs: normalForce + shearForce act on the second body.
void SceneLink::writeContact(std::size_t index, const cd::Touch& touch)
{
	const cd::Carried& carried = world.carried[index];
	assert(interaction_id1(interactions[index]) == world.pairs[index].a);
	interaction_iterMadeReal(interactions[index]) = carried.since;
	void *const g = objects[index].geom.get(), *const p = objects[index].phys.get();
	geom_contactPoint(g) = plane.toSpace(touch.cx, touch.cy, layer);
	geom_penetrationDepth(g) = touch.overlap;
	phys_tangensOfFrictionAngle(p) = world.pairs[index].mu;
	if (world.compliant()) {
		phys_kn(p) = world.stiffnesses[index].kn;
		phys_ks(p) = world.stiffnesses[index].kt;
	}
	geom_normal(g) = plane.toSpace(carried.nx, carried.ny);
	phys_normalForce(p) = plane.toSpace(carried.fn[0], carried.fn[1]);
	phys_shearForce(p) = plane.toSpace(carried.ft[0], carried.ft[1]);
	if (!objects[index].holdMoment)
		return;
	cohPhys_moment(p) = plane.torque(carried.moment);
	cohPhys_momentRotationLaw(p) = rolls(index);
	cohPhys_maxRollPl(p) = rolls(index) ? world.rollings[index].bound : 0;
	if (world.compliant() && rolls(index))
		cohPhys_kr(p) = world.rollings[index].stiffness;
}

// Springs belong to the places at the end of the step; the normal is that of the force.
cd::Touch SceneLink::touchAfterStep(std::size_t index) const
{
	const cd::Pair& pair = world.pairs[index];
	const cd::Place a = cd::placeAhead(world.bodyOf(pair.a), 0), b = cd::placeAhead(world.bodyOf(pair.b), 0);
	return cd::touchAt(world.carried[index].nx, world.carried[index].ny, -cd::locateContact(a, b, world.shapes[pair.a]).overlap, b);
}

void SceneLink::writeMotion(std::size_t id)
{
	void* const state = bodies[id].state;
	const cd::Body& body = world.bodies[id];
	state_pos(state)[plane.x] = body.x;
	state_pos(state)[plane.y] = body.y;
	// Blocked freedoms keep their velocity. Somebody may have blocked them, or set another velocity, meanwhile, at the console of a run.
	const unsigned blocked = state_blockedDOFs(state);
	for (int k = 0; k < cd::Plane::freedoms; k++)
		if (body.inverseMass[k] > 0 && !(blocked & plane.dof(k)))
			plane.setVelocity(state, k, body.v[k]);
	const auto& o = orientations[id];
	double* const q = &state_ori(state);
	q[plane.x] = plane.turn * o[0];
	q[plane.y] = plane.turn * o[1];
	q[plane.normal] = plane.turn * o[2];
	q[3] = o[3];
}

// Applies the rotation of a step about the normal of the plane from the left. For the tiny rotations of quasi-static motion the first terms of the
// series are exact.
void SceneLink::finishStep(cd::TimeStep<cd::Plane>& step, double dt)
{
	const auto turn = [&](std::size_t from, std::size_t to) {
		bool all = true;
		for (std::size_t id = from; id < to; id++) {
			const cd::Body& b = world.bodies[id];
			all = all && (b.x + b.y + b.v[0] + b.v[1] + b.v[2]) * 0 == 0;
			const double half = 0.5 * b.turn, square = half * half;
			if (half == 0) // an erased body does not turn
				continue;
			auto& q = orientations[id];
			const bool tiny = square < 1e-7;
			const double s = tiny ? half * (1 - square / 6) : std::sin(half),
				     c = tiny ? 1 - square * (0.5 - square / 24) : std::cos(half);
			const double x = c * q[0] - s * q[1], y = c * q[1] + s * q[0], z = c * q[2] + s * q[3], w = c * q[3] - s * q[2];
			// Renormalised, because round-off would grow over 1e6 steps.
			const double inverse = 1 / std::sqrt(x * x + y * y + z * z + w * w);
			q = { x * inverse, y * inverse, z * inverse, w * inverse };
			if (isBoundary(b) && world.shapes[id].kind == cd::ShapeKind::box)
				orient(static_cast<int>(id));
		}
		return all;
	};
	finite = cd::reduceRanges<bool>(&step.threads, bodies.size(), turn, std::logical_and<bool>());
	lastDt = dt;
	unpublished = true;
}

void SceneLink::publishScene(yade::Scene* scene, const cd::TimeStep<cd::Plane>& step)
{
	assert(interactions.size() == world.pairs.size() && objects.size() == world.pairs.size());
	eraseParted(scene);
	for (std::size_t i = 0; i < world.pairs.size(); i++) {
		if (i + early < world.pairs.size())
			prefetchContact(objects[i + early]);
		if (world.carries(i)) {
			if (!interactions[i])
				insert(*scene_interactions(scene), i);
			if (!objects[i].inUse() || (rolls(i) && !objects[i].holdMoment))
				makeReal(i);
			writeContact(i, world.compliant() ? touchAfterStep(i) : step.touchOf(world, i));
		} else if (objects[i].real) {
			objects[i].real = false;
			forget(interactions[i]);
		}
	}
	saveMotion();
	if (interactionsOf(scene) != listed)
		listed = interactionsOf(scene);
	unpublished = false;
	driven.clear();
}

bool SceneLink::areBoundaries(const std::vector<int>& ids) const
{
	return std::all_of(ids.begin(), ids.end(),
	    [this](int id) { return id >= 0 && id < static_cast<int>(bodies.size()) && bodies[id].body && isBoundary(world.bodies[id]); });
}

void SceneLink::publishMotion(const std::vector<int>& ids)
{
	for (const int id : driven = ids)
		writeMotion(id);
}

void SceneLink::saveMotion()
{
	for (std::size_t id = 0; unpublished && id < bodies.size(); id++) {
		if (id + early < bodies.size())
			prefetchBody(bodies[id + early]);
		if (bodies[id].body)
			writeMotion(id);
	}
}

void SceneLink::catchUp(yade::Scene* scene, cd::TimeStep<cd::Plane>& step)
{
	if (!unpublished)
		return;
	step.locateBack(world, lastDt);
	publishScene(scene, step);
}

void SceneLink::publish(yade::Scene* scene, cd::TimeStep<cd::Plane>& step)
{
	assert(unpublished && lastDt > 0);
	const auto& impulses = step.impulsesOn(world); // first, because it may find no memory
	publishScene(scene, step);
	auto& container = scene_forces(scene);
	const double rate = 1 / lastDt;
	for (std::size_t id = 0; id < world.bodies.size(); id++) {
		if (!bodies[id].body)
			continue;
		const double* w = world.bodies[id].inverseMass;
		const double weight = w[0] > 0 || w[1] > 0 ? state_mass(bodies[id].state) : 0;
		const std::array<double, 3>& p = impulses[id];
		container.addForce(static_cast<int>(id), plane.toSpace(p[0] * rate + weight * pull[0], p[1] * rate + weight * pull[1]));
		container.addTorque(static_cast<int>(id), plane.torque(p[2] * rate));
	}
	// ForceResetter clears only the sums. What threads have added since the last sync would return in the next step.
	container.sync();
}

} // namespace cd_engine
