#include "scene_link.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

namespace cd_engine {
namespace {

	constexpr std::size_t early = 10; // number of contacts or bodies ahead whose memory is prefetched

	template <class T> boost::shared_ptr<T> create(const char* name)
	{
		const boost::shared_ptr<yade::Factorable> made = Singleton<yade::ClassFactory>::instance().createShared(name);
		return boost::shared_ptr<T>(made, reinterpret_cast<T*>(made.get()));
	}

	bool isA(void* serializable, const char* name) { return static_cast<yade::Serializable*>(serializable)->getClassName() == name; }

} // namespace

// Keeps the objects of forgotten pairs, so that contacts that come and go allocate no memory. Objects that somebody else holds, or that springs have
// made, are not kept, because stiffnesses stay with their pair.
void SceneLink::recycle(Spare&& s)
{
	if (s.geom.use_count() == 1 && s.phys.use_count() == 1 && isA(s.geom.get(), "ScGeom") && isA(s.phys.get(), "FrictPhys")
	    && at<double>(s.phys.get(), layout.phys_kn) == 0)
		pool.push_back(std::move(s));
}

SceneLink::Spare SceneLink::takeSpare()
{
	if (pool.empty())
		return { create<yade::IGeom>("ScGeom"), create<yade::IPhys>("FrictPhys") };
	Spare taken = std::move(pool.back());
	pool.pop_back();
	return taken;
}

// Gives an interaction to a pair that carries something for the first time.
void SceneLink::insert(yade::InteractionContainer& container, std::size_t index)
{
	const int a = pairs[index].a, b = pairs[index].b;
	if (!container.find(a, b))
		container.insert(a, b);
	interactions[index] = container.find(a, b).get();
	turn(index);
}

// Empties and erases the interactions of pairs that no longer exist. Those that the collider would keep, by the bounds that it knows, stay in the
// list, because the collider notices only changes.
void SceneLink::eraseParted(yade::Scene* scene)
{
	auto& container = *at<boost::shared_ptr<yade::InteractionContainer>>(scene, layout.scene_interactions);
	auto& all = *at<boost::shared_ptr<yade::BodyContainer>>(scene, layout.scene_bodies);
	const auto& list = at<std::vector<boost::shared_ptr<yade::Interaction>>>(&container, layout.interactions_linear);
	std::sort(parted.begin(), parted.end());
	for (std::size_t i = parted.empty() ? 0 : list.size(); i-- > 0;) { // backwards: the last one takes the place of an erased one
		yade::Interaction* const interaction = list[i].get();
		if (!std::binary_search(parted.begin(), parted.end(), interaction))
			continue;
		auto& geom = at<boost::shared_ptr<yade::IGeom>>(interaction, layout.interaction_geom);
		auto& phys = at<boost::shared_ptr<yade::IPhys>>(interaction, layout.interaction_phys);
		recycle({ std::move(geom), std::move(phys) });
		forget(interaction);
		const int a = at<int>(interaction, layout.interaction_id1), b = at<int>(interaction, layout.interaction_id2);
		const auto bound = [&](int id) {
			char* const body = reinterpret_cast<char*>(all[id].get());
			return body ? static_cast<char*>(pointer<yade::Bound>(body, layout.body_bound)) : nullptr;
		};
		char *const p = bound(a), *const q = bound(b);
		bool apart = !p || !q;
		for (int axis = 0; axis < 3 && !apart; axis++)
			apart = at<Vector3r>(p, layout.bound_min)[axis] > at<Vector3r>(q, layout.bound_max)[axis]
			    || at<Vector3r>(q, layout.bound_min)[axis] > at<Vector3r>(p, layout.bound_max)[axis];
		if (apart)
			container.erase(a, b, static_cast<int>(i));
	}
	parted.clear();
}

// Gives an interaction the objects that hold its force: those from when it was last loaded, or others, in which every member is set anew.
void SceneLink::makeReal(std::size_t index)
{
	auto& geom = at<boost::shared_ptr<yade::IGeom>>(interactions[index], layout.interaction_geom);
	auto& phys = at<boost::shared_ptr<yade::IPhys>>(interactions[index], layout.interaction_phys);
	if (!spare[index].geom)
		spare[index] = takeSpare();
	geom = spare[index].geom;
	phys = spare[index].phys;
	forces[index] = { geom.get(), phys.get(), true };
	const cd::Pair& pair = world.pairs[index];
	const double radiusB = world.bodies[pair.b].radius;
	at<double>(geom.get(), layout.geom_refR1) = bodies[pair.a].boundary ? radiusB : world.bodies[pair.a].radius;
	at<double>(geom.get(), layout.geom_refR2) = radiusB;
	at<Vector3r>(geom.get(), layout.geom_shearInc) = Vector3r::Zero();
	at<Vector3r>(geom.get(), layout.geom_normal) = Vector3r::Zero(); // YADE does not initialise it; no contact has a zero normal
}

void SceneLink::makeUnreal(std::size_t index)
{
	auto& geom = at<boost::shared_ptr<yade::IGeom>>(interactions[index], layout.interaction_geom);
	auto& phys = at<boost::shared_ptr<yade::IPhys>>(interactions[index], layout.interaction_phys);
	if (forces[index].geom)
		spare[index] = { geom, phys };
	forces[index] = { nullptr, nullptr, false };
	geom.reset();
	phys.reset();
	at<long>(interactions[index], layout.interaction_iterMadeReal) = -1;
}

// The forces in YADE's signs: normalForce + shearForce act on the second body.
void SceneLink::writeContact(std::size_t index, const cd::Touch& touch)
{
	const cd::Carried& carried = world.carried[index];
	assert(at<int>(interactions[index], layout.interaction_id1) == pairs[index].a);
	at<long>(interactions[index], layout.interaction_iterMadeReal) = carried.since;
	void* const g = forces[index].geom;
	void* const p = forces[index].phys;
	at<Vector3r>(g, layout.geom_contactPoint) = Vector3r(touch.cx, touch.cy, layer);
	at<double>(g, layout.geom_penetrationDepth) = touch.overlap;
	at<double>(p, layout.phys_tangensOfFrictionAngle) = world.pairs[index].mu;
	at<Vector3r>(g, layout.geom_normal) = Vector3r(carried.nx, carried.ny, 0);
	at<Vector3r>(p, layout.phys_normalForce) = Vector3r(carried.fn[0], carried.fn[1], 0);
	at<Vector3r>(p, layout.phys_shearForce) = Vector3r(carried.ft[0], carried.ft[1], 0);
}

// Prefetches the memory lines that writeContact writes.
void SceneLink::prefetchContact(const Forces& f) const
{
	if (!f.geom)
		return;
	for (const long member : { layout.geom_normal, layout.geom_contactPoint + 16, layout.geom_penetrationDepth })
		prefetch(f.geom, member);
	prefetch(f.phys, layout.phys_normalForce);
	prefetch(f.phys, layout.phys_tangensOfFrictionAngle);
}

void SceneLink::writeMotion(std::size_t id)
{
	char* const state = bodies[id].state;
	const cd::Body& body = world.bodies[id];
	Vector3r& position = at<Vector3r>(state, layout.state_se3);
	Vector3r& velocity = at<Vector3r>(state, layout.state_vel);
	position[0] = body.x;
	position[1] = body.y;
	velocity[0] = body.v[0];
	velocity[1] = body.v[1];
	at<Vector3r>(state, layout.state_angVel)[2] = body.v[2];
	std::copy_n(orientations[id].data(), 4, &at<double>(state, layout.state_orientation));
}

// Applies the rotation of a step about z from the left. For the tiny rotations of quasi-static motion the first terms of the series are exact.
void SceneLink::hold(cd::TimeStep& step, double dt)
{
	const auto turn = [&](std::size_t from, std::size_t to) {
		bool finite = true;
		for (std::size_t id = from; id < to; id++) {
			const cd::Body& b = world.bodies[id];
			finite = finite && (b.x + b.y + b.v[0] + b.v[1] + b.v[2]) * 0 == 0;
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
			q[0] = x * inverse;
			q[1] = y * inverse;
			q[2] = z * inverse;
			q[3] = w * inverse;
			if (world.shapes[id].kind == cd::ShapeKind::box)
				orient(static_cast<int>(id));
		}
		return finite;
	};
	numbers = cd::reduceRanges<bool>(&step.threads, bodies.size(), turn, std::logical_and<bool>());
	heldStep = dt;
	behind = true;
}

void SceneLink::publishScene(yade::Scene* scene, const cd::TimeStep& step)
{
	auto& container = *at<boost::shared_ptr<yade::InteractionContainer>>(scene, layout.scene_interactions);
	assert(spare.size() == world.pairs.size() && forces.size() == world.pairs.size());
	eraseParted(scene);
	for (std::size_t i = 0; i < world.pairs.size(); i++) {
		if (i + early < world.pairs.size())
			prefetchContact(forces[i + early]);
		if (world.carried[i].any()) {
			if (!interactions[i])
				insert(container, i);
			if (!forces[i].geom)
				makeReal(i);
			writeContact(i, step.touchOf(world, i));
		} else if (forces[i].any)
			makeUnreal(i);
	}
	for (std::size_t id = 0; id < bodies.size(); id++) {
		if (id + early < bodies.size())
			prefetchBody(bodies[id + early]);
		if (bodies[id].exists)
			writeMotion(id);
	}
	if (const auto& list = at<std::vector<boost::shared_ptr<yade::Interaction>>>(&container, layout.interactions_linear); list != listed)
		listed = list;
	behind = false;
}

void SceneLink::catchUp(yade::Scene* scene, cd::TimeStep& step)
{
	if (!behind)
		return;
	step.lookBack(world, heldStep);
	publishScene(scene, step);
}

void SceneLink::publish(yade::Scene* scene, const cd::TimeStep& step)
{
	publishScene(scene, step);
	auto& container = at<yade::ForceContainer>(scene, layout.scene_forces);
	const double rate = 1 / heldStep;
	for (std::size_t id = 0; id < world.bodies.size(); id++) {
		if (!bodies[id].exists)
			continue;
		const double* w = world.bodies[id].inverseMass;
		const double weight = w[0] > 0 || w[1] > 0 ? at<double>(bodies[id].state, layout.state_mass) : 0;
		const std::array<double, 3>& p = step.impulseOn(id);
		container.addForce(static_cast<int>(id), Vector3r(p[0] * rate + weight * gravity[0], p[1] * rate + weight * gravity[1], 0));
		container.addTorque(static_cast<int>(id), Vector3r(0, 0, p[2] * rate));
	}
	// ForceResetter clears only the sums. What threads have added since the last sync would return in the next step.
	container.sync();
}

} // namespace cd_engine
