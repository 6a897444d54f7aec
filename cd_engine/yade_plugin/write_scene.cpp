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

	Vector3r written(const cd::Vector3& v) { return { v.x, v.y, v.z }; }

	// Renormalised, because round-off would grow over 1e6 steps.
	std::array<double, 4> normalized(const std::array<double, 4>& q)
	{
		const double inverse = 1 / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
		return { q[0] * inverse, q[1] * inverse, q[2] * inverse, q[3] * inverse };
	}

} // namespace

// Keeps the objects of forgotten pairs, so that contacts that come and go allocate no memory. Objects that somebody else holds, or that springs have
// made, are not kept, because stiffnesses stay with their pair.
template <class Space> void SceneLink<Space>::recycle(ForceObjects&& o)
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
template <class Space> void SceneLink<Space>::insert(yade::InteractionContainer& container, std::size_t index)
{
	const int a = world.pairs[index].a, b = world.pairs[index].b;
	if (!container.find(a, b))
		container.insert(a, b);
	interactions[index] = container.find(a, b).get();
	turn(index);
}

// Empties and erases the interactions of pairs that no longer exist. Those that the collider would keep, by the bounds that it knows, stay in the
// list, because the collider notices only changes.
template <class Space> void SceneLink<Space>::eraseParted(yade::Scene* scene)
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
template <class Space> void SceneLink<Space>::makeReal(std::size_t index)
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
	geom_refR1(o.geom) = firstRadius(world.pairs[index]);
	geom_refR2(o.geom) = world.bodyOf(world.pairs[index].b).radius;
	geom_shearInc(o.geom) = Vector3r::Zero();
	geom_normal(o.geom) = Vector3r::Zero(); // YADE does not initialise it; no contact has a zero normal
}

// The forces in YADE's signs: normalForce + shearForce act on the second body.
template <class Space> void SceneLink<Space>::writeContact(std::size_t index, const Touch& touch)
{
	assert(interaction_id1(interactions[index]) == world.pairs[index].a);
	interaction_iterMadeReal(interactions[index]) = world.carried[index].since;
	void *const g = objects[index].geom.get(), *const p = objects[index].phys.get();
	geom_penetrationDepth(g) = touch.overlap;
	phys_tangensOfFrictionAngle(p) = world.pairs[index].mu;
	if (world.compliant()) {
		phys_kn(p) = world.stiffnesses[index].kn;
		phys_ks(p) = world.stiffnesses[index].kt;
	}
	writeVectors(index, touch);
}

template <> void SceneLink<cd::Plane>::writeVectors(std::size_t index, const cd::Touch& touch) const
{
	const cd::Carried& carried = world.carried[index];
	void *const g = objects[index].geom.get(), *const p = objects[index].phys.get();
	geom_contactPoint(g) = frame.toSpace(touch.cx, touch.cy, layer);
	geom_normal(g) = frame.toSpace(carried.nx, carried.ny);
	phys_normalForce(p) = frame.toSpace(carried.fn[0], carried.fn[1]);
	phys_shearForce(p) = frame.toSpace(carried.ft[0], carried.ft[1]);
	if (!objects[index].holdMoment)
		return;
	cohPhys_moment(p) = frame.torque(carried.moment);
	cohPhys_momentRotationLaw(p) = rolls(index);
	cohPhys_maxRollPl(p) = rolls(index) ? world.rollings[index].bound : 0;
	if (world.compliant() && rolls(index))
		cohPhys_kr(p) = world.rollings[index].stiffness;
}

template <> void SceneLink<cd::Space3>::writeVectors(std::size_t index, const cd::SpaceTouch& touch) const
{
	const cd::SpaceCarried& carried = world.carried[index];
	void *const g = objects[index].geom.get(), *const p = objects[index].phys.get();
	geom_contactPoint(g) = written(touch.c);
	geom_normal(g) = written(carried.n);
	phys_normalForce(p) = written(carried.fn);
	phys_shearForce(p) = written(carried.ft);
}

// Springs belong to the places at the end of the step; the normal is that of the force.
template <> cd::Touch SceneLink<cd::Plane>::touchAfterStep(std::size_t index) const
{
	const cd::Pair& pair = world.pairs[index];
	const cd::Place a = cd::placeAhead(world.bodyOf(pair.a), 0), b = cd::placeAhead(world.bodyOf(pair.b), 0);
	return cd::touchAt(world.carried[index].nx, world.carried[index].ny, -cd::locateContact(a, b, world.shapes[pair.a]).overlap, b);
}

template <> cd::SpaceTouch SceneLink<cd::Space3>::touchAfterStep(std::size_t index) const
{
	const cd::Pair& pair = world.pairs[index];
	const cd::SpacePlace a = placeAhead(world.bodyOf(pair.a), 0), b = placeAhead(world.bodyOf(pair.b), 0);
	return cd::touchAt(world.carried[index].n, -cd::locateContact(a, b, world.shapes[pair.a]).overlap, b);
}

template <> void SceneLink<cd::Plane>::writePlace(std::size_t id) const
{
	void* const state = bodies[id].state;
	state_pos(state)[frame.x] = world.bodies[id].x;
	state_pos(state)[frame.y] = world.bodies[id].y;
	const auto& o = orientations[id];
	double* const q = &state_ori(state);
	q[frame.x] = frame.turn * o[0];
	q[frame.y] = frame.turn * o[1];
	q[frame.normal] = frame.turn * o[2];
	q[3] = o[3];
}

template <> void SceneLink<cd::Space3>::writePlace(std::size_t id) const
{
	state_pos(bodies[id].state) = written(world.bodies[id].at);
	std::copy_n(orientations[id].data(), 4, &state_ori(bodies[id].state));
}

template <class Space> void SceneLink<Space>::writeMotion(std::size_t id)
{
	void* const state = bodies[id].state;
	const Body& body = world.bodies[id];
	writePlace(id);
	// Blocked freedoms keep their velocity. Somebody may have blocked them, or set another velocity, meanwhile, at the console of a run.
	const unsigned blocked = state_blockedDOFs(state);
	for (int k = 0; k < Space::freedoms; k++)
		if (body.inverseMass[k] > 0 && !(blocked & frame.dof(k)))
			frame.setVelocity(state, k, body.v[k]);
}

// Applies the rotation of a step about the normal of the plane from the left. For the tiny rotations of quasi-static motion the first terms of the
// series are exact.
template <> bool SceneLink<cd::Plane>::rotate(std::size_t id)
{
	const cd::Body& b = world.bodies[id];
	const double half = 0.5 * b.turn, square = half * half;
	if (half != 0) { // an erased body does not turn
		auto& q = orientations[id];
		const bool tiny = square < 1e-7;
		const double s = tiny ? half * (1 - square / 6) : std::sin(half), c = tiny ? 1 - square * (0.5 - square / 24) : std::cos(half);
		q = normalized({ c * q[0] - s * q[1], c * q[1] + s * q[0], c * q[2] + s * q[3], c * q[3] - s * q[2] });
		if (isBoundary(b) && world.shapes[id].kind == cd::ShapeKind::box)
			orient(static_cast<int>(id));
	}
	return (b.x + b.y + b.v[0] + b.v[1] + b.v[2]) * 0 == 0;
}

// The same about any axis.
template <> bool SceneLink<cd::Space3>::rotate(std::size_t id)
{
	const cd::SpaceBody& b = world.bodies[id];
	const double square = 0.25 * dot(b.turn, b.turn);
	if (square != 0) {
		auto& q = orientations[id];
		const bool tiny = square < 1e-7;
		const double half = std::sqrt(square), share = 0.5 * (tiny ? 1 - square / 6 : std::sin(half) / half),
			     c = tiny ? 1 - square * (0.5 - square / 24) : std::cos(half);
		const cd::Vector3 axis = share * b.turn, of { q[0], q[1], q[2] }, now = c * of + q[3] * axis + cross(axis, of);
		q = normalized({ now.x, now.y, now.z, c * q[3] - dot(axis, of) });
		if (isBoundary(b))
			orient(static_cast<int>(id));
	}
	const cd::Vector3 sum = b.at + velocityOf(b) + spinOf(b);
	return (sum.x + sum.y + sum.z) * 0 == 0;
}

template <class Space> void SceneLink<Space>::finishStep(TimeStep& step, double dt)
{
	const uint8_t* const still = world.still.data();
	const auto turn = [&](std::size_t from, std::size_t to) {
		bool all = true;
		for (std::size_t id = from; id < to; id++)
			all = (still[id] || rotate(id)) && all;
		return all;
	};
	finite = cd::reduceRanges<bool>(&step.threads, bodies.size(), turn, std::logical_and<bool>());
	lastDt = dt;
	unpublished = true;
}

template <class Space> void SceneLink<Space>::publishScene(yade::Scene* scene, const TimeStep& step)
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

template <class Space> bool SceneLink<Space>::areBoundaries(const std::vector<int>& ids) const
{
	return std::all_of(ids.begin(), ids.end(),
	    [this](int id) { return id >= 0 && id < static_cast<int>(bodies.size()) && bodies[id].body && isBoundary(world.bodies[id]); });
}

template <class Space> void SceneLink<Space>::publishMotion(const std::vector<int>& ids)
{
	for (const int id : driven = ids) {
		writeMotion(id);
		world.still[id] = false;
	}
}

template <class Space> void SceneLink<Space>::saveMotion()
{
	for (std::size_t id = 0; unpublished && id < bodies.size(); id++) {
		if (id + early < bodies.size())
			prefetchBody(bodies[id + early]);
		if (bodies[id].body)
			writeMotion(id);
	}
}

template <class Space> void SceneLink<Space>::catchUp(yade::Scene* scene, TimeStep& step)
{
	if (!unpublished)
		return;
	step.locateBack(world, lastDt);
	publishScene(scene, step);
}

// Adds what a body has got in the last step, its weight included.
template <> void SceneLink<cd::Plane>::addForces(yade::ForceContainer& container, int id, const std::array<double, 3>& p) const
{
	const double* const w = world.bodies[id].inverseMass;
	const double rate = 1 / lastDt, weight = w[0] > 0 || w[1] > 0 ? state_mass(bodies[id].state) : 0;
	container.addForce(id, frame.toSpace(p[0] * rate + weight * pull[0], p[1] * rate + weight * pull[1]));
	container.addTorque(id, frame.torque(p[2] * rate));
}
template <> void SceneLink<cd::Space3>::addForces(yade::ForceContainer& container, int id, const std::array<double, 6>& p) const
{
	const double* const w = world.bodies[id].inverseMass;
	const double rate = 1 / lastDt, weight = w[0] > 0 || w[1] > 0 || w[2] > 0 ? state_mass(bodies[id].state) : 0;
	container.addForce(id, Vector3r(rate * p[0] + weight * pull[0], rate * p[1] + weight * pull[1], rate * p[2] + weight * pull[2]));
	container.addTorque(id, Vector3r(rate * p[3], rate * p[4], rate * p[5]));
}

template <class Space> void SceneLink<Space>::publish(yade::Scene* scene, TimeStep& step)
{
	assert(unpublished && lastDt > 0);
	const auto& impulses = step.impulsesOn(world); // first, because it may find no memory
	publishScene(scene, step);
	auto& container = scene_forces(scene);
	for (std::size_t id = 0; id < world.bodies.size(); id++)
		if (bodies[id].body)
			addForces(container, static_cast<int>(id), impulses[id]);
	// ForceResetter clears only the sums. What threads have added since the last sync would return in the next step.
	container.sync();
}

#define INSTANTIATE(Space)                                                                                                                           \
	template void SceneLink<Space>::recycle(ForceObjects&&);                                                                                     \
	template void SceneLink<Space>::finishStep(cd::TimeStep<Space>&, double);                                                                    \
	template void SceneLink<Space>::publish(yade::Scene*, cd::TimeStep<Space>&);                                                                 \
	template void SceneLink<Space>::publishScene(yade::Scene*, const cd::TimeStep<Space>&);                                                      \
	template void SceneLink<Space>::publishMotion(const std::vector<int>&);                                                                      \
	template bool SceneLink<Space>::areBoundaries(const std::vector<int>&) const;                                                                \
	template void SceneLink<Space>::catchUp(yade::Scene*, cd::TimeStep<Space>&);                                                                 \
	template void SceneLink<Space>::saveMotion();
INSTANTIATE(cd::Plane)
INSTANTIATE(cd::Space3)

} // namespace cd_engine
