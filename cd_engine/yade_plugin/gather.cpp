// How a step reads the scene: the bodies, the search for pairs, and what the pairs carry now.
#include "kind.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iostream>

namespace cd_engine {
namespace {

	// Finds the objects that hold a contact's force, and prefetches them.
	Forces findForces(yade::Interaction* interaction)
	{
		void *const geom = interaction_geom(interaction).get(), *const phys = interaction_phys(interaction).get();
		if (geom)
			prefetch(geom, { 0, geom_normal + 16 });
		if (phys)
			prefetch(phys, { 0, phys_shearForce + 16 });
		return { geom, phys, geom || phys };
	}

	cd::Carried carriedIn(const Forces& f)
	{
		if (!f.geom)
			return {};
		const Vector3r &n = geom_normal(f.geom), &fn = phys_normalForce(f.phys), &ft = phys_shearForce(f.phys);
		return { n[0], n[1], { fn[0], fn[1] }, { ft[0], ft[1] }, -1 };
	}

} // namespace

void SceneLink::tell(const std::string& what, const std::string& remedy)
{
	if (!inspecting && told.insert(what).second)
		std::cerr << "ContactDynamics: " << what << " " << remedy << '\n';
}

void SceneLink::checkScene(yade::Scene* scene, double dt)
{
	if (scene_isPeriodic(scene))
		throw SceneError("ContactDynamics: the scene is periodic, which is not supported. Set O.periodic=False and use walls");
	if (dt == 1e-8)
		tell("O.dt is 1e-8 s, the value that YADE starts with.", "Rigid contacts take steps of about 1e-3 s: set O.dt.");
	if (!(dt > 0 && std::isfinite(dt)))
		throw SceneError(text("ContactDynamics: the time step O.dt is ", dt, " s. Set it to a positive number"));
}

// Warns if gravity moves a boundary down onto another one, or its velocity or a force moves it onto one from which it is still apart, since nothing
// will hold it there: two boundaries make no pair. Also if gravity moves all of them. Called after a search.
void SceneLink::tellOfFalls(double dt)
{
	const int count = static_cast<int>(bodies.size());
	const auto isSolid = [this](int id) { return bodies[id].boundary && world.masks[id] != 0; };
	int held = 0, falling = -1;
	const double fits = 1.8 * cd::smallestRadius(world); // where a disk fits between two, pressed in by a tenth [m]
	for (int upper = 0; upper < count; upper++) {
		const cd::Body& a = world.bodies[upper];
		const bool pulled = a.inverseMass[0] * gravity[0] != 0 || a.inverseMass[1] * gravity[1] != 0;
		held += !pulled && world.masks[upper] != 0; // a fixed disk holds the scene, too
		if (!isSolid(upper))
			continue;
		falling = pulled ? upper : falling;
		if (a.inverseMass[0] == 0 && a.inverseMass[1] == 0)
			continue;
		const cd::Half ha = cd::halfSides(a, world.shapes[upper]);
		// A large force makes the margin wide. If the boundary has disks near it, which may carry the force, only its present motion counts.
		const bool meetsDisks = std::any_of(pairs.begin(), pairs.end(), [upper](const cd::NearPair& pair) { return pair.a == upper; });
		const double most = meetsDisks ? fits + 10 * dt * std::hypot(a.v[0], a.v[1]) : cd::endless;
		for (int lower = 0; lower < count; lower++) {
			if (lower == upper || !isSolid(lower))
				continue;
			const cd::Body& b = world.bodies[lower];
			const cd::Half hb = cd::halfSides(b, world.shapes[lower]);
			const double margin = std::min(search.marginOf(upper) + search.marginOf(lower), most), way[2] = { b.x - a.x, b.y - a.y },
				     overlap[2] = { ha.x + hb.x - std::abs(way[0]), ha.y + hb.y - std::abs(way[1]) };
			// The axis with the smaller overlap decides: a boundary that slides along a side wall overlaps it least across its motion,
			// and a piston with clearance not at all.
			const int axis = overlap[0] < overlap[1] ? 0 : 1;
			// A Wall is endless along itself: it crosses others at right angles, and what stands on both of its sides.
			const bool cross
			    = overlap[axis] == cd::endless || (world.shapes[upper].kind == cd::ShapeKind::wall && overlap[axis] > margin);
			if (cross || overlap[axis] < -margin || a.inverseMass[axis] == 0 || !(overlap[1 - axis] > 0))
				continue;
			const bool falls = way[axis] * gravity[axis] > 0;
			const bool known = told.count(text("falls", lower, " ", upper)) > 0; // having passed through each other they meet again
			if (!known && (falls || (overlap[axis] < 0 && (way[axis] * a.v[axis] > 0 || way[axis] * a.force[axis] > 0)))) {
				told.insert(text("falls", upper, " ", lower));
				tell(text("body #", upper, " is a boundary that ", falls ? "gravity" : "its velocity or a force",
					 " moves onto another: Box and Wall never touch each other."),
				    text("It will pass through body #", lower,
					". To prevent this, block its motion (state.blockedDOFs), or leave a gap between the two."));
			}
		}
	}
	if (falling >= 0 && held == 0)
		tell(text("gravity moves every boundary, such as body #", falling, ", so the whole scene falls."),
		    "Fix the boundary that has to hold the scene: state.blockedDOFs='xyzXYZ'.");
}

void SceneLink::forget(yade::Interaction* interaction) const
{
	if (inspecting)
		return;
	interaction_geom(interaction).reset();
	interaction_phys(interaction).reset();
	interaction_iterMadeReal(interaction) = -1;
}

// Puts the bodies of an interaction in the order of its pair. YADE's own functors, too, want the boundary first.
void SceneLink::turn(std::size_t index) const
{
	yade::Interaction* const interaction = interactions[index];
	if (inspecting || interaction_id1(interaction) == pairs[index].a)
		return;
	forget(interaction);
	interaction->swapOrder();
}

// Pairs that were listed before keep their data, which move in place: both lists have the same order, so none overtakes another.
void SceneLink::keepPairs()
{
	cd::findAgain(pairs, before, left);
	for (const int32_t i : left) {
		if (interactions[i])
			parted.push_back(interactions[i]);
		recycle(std::move(spare[i]));
	}
	const auto rearrange = [this](auto& of) {
		std::size_t kept = 0;
		for (const cd::NearPair& pair : pairs)
			if (pair.from >= 0)
				of[kept++] = std::move(of[pair.from]);
		of.resize(pairs.size());
		for (std::size_t k = pairs.size(); k-- > kept;) // below, all have their places
			of[k] = pairs[k].from >= 0 ? std::move(of[--kept]) : typename std::decay_t<decltype(of)>::value_type {};
	};
	rearrange(interactions);
	rearrange(forces);
	rearrange(world.carried);
	rearrange(world.pairs);
	rearrange(spare);
}

// Gives the pairs the interactions that the scene has for them. Interactions without a pair lose their forces.
void SceneLink::takePairs(yade::Scene* scene, const std::vector<int>& rank)
{
	listed = interactionsOf(scene);
	before.clear();
	parted.clear();
	const auto exists = [this](int id) { return id >= 0 && id < static_cast<int>(bodies.size()) && bodies[id].exists; };
	for (std::size_t i = 0; i < listed.size(); i++) {
		const int32_t a = interaction_id1(listed[i]), b = interaction_id2(listed[i]);
		if (!exists(a) || !exists(b))
			continue;
		if (bodies[a].boundary && bodies[b].boundary)
			forget(listed[i].get()); // a disk may have become a box
		else
			before.push_back({ 0, a, b, static_cast<int32_t>(i) });
	}
	cd::sortPairs(before, rank);
	cd::findAgain(pairs, before, left);
	for (const int32_t i : left)
		forget(listed[before[i].from].get());
	interactions.assign(pairs.size(), nullptr);
	for (std::size_t k = 0; k < pairs.size(); k++) {
		if (pairs[k].from < 0)
			continue;
		interactions[k] = listed[before[pairs[k].from].from].get();
		turn(k);
	}
	for (Spare& s : spare)
		recycle(std::move(s));
	spare.assign(pairs.size(), {});
	forces.assign(pairs.size(), {});
	world.carried.assign(pairs.size(), {});
}

// Copies the pairs into the core's world: all, or those that were not listed before.
void SceneLink::listPairs(const Memory& memory, bool all)
{
	world.listing++;
	world.pairs.resize(pairs.size());
	std::size_t touching = 0;
	for (std::size_t k = 0; k < pairs.size(); k++) {
		const cd::NearPair& pair = pairs[k];
		assert(pair.a != pair.b && !bodies[pair.b].boundary);
		if (all || pair.from < 0)
			world.pairs[k] = { pair.a, pair.b, 0, memory.overlaps.of(pair.a, pair.b) };
		touching += world.pairs[k].reference > 0;
	}
	if (inspecting || touching == memory.overlaps.overlaps.size())
		return;
	const std::lock_guard<std::mutex> lock(memory.lock);
	collectOverlaps(memory.overlaps); // leaves out those of bodies that somebody has moved apart
}

// read: whether the scene has been read; searched: whether the list of pairs is new; reordered: whether its order is new.
void SceneLink::gatherPairs(yade::Scene* scene, const Memory& memory, bool read, bool searched, bool reordered, cd::Sleepers& sleepers)
{
	// `listed` holds on to its interactions, so that a new one cannot get an old one's address.
	bool taken = reordered || (read && (outdated || interactionsOf(scene) != listed));
	if (searched || reordered)
		cd::sortPairs(pairs, memory.order.rank);
	if (searched && !taken)
		keepPairs();
	if (read && !taken)
		taken = !readForces(searched ? nullptr : &sleepers);
	if (taken) {
		takePairs(scene, memory.order.rank);
		readForces(nullptr);
		outdated = false;
	}
	if (searched || taken) {
		listPairs(memory, taken);
		if (searched && search.mover() >= 0)
			sleepers.wakeAll(world, { "near pairs were searched anew, since a body has moved far", search.mover() });
		else
			sleepers.wakeAll(world);
	} else
		sleepers.look(world);
}

// Reads the present force of every contact: three dependent look-ups in different memory lines, each prefetched before the next. A force that
// somebody has changed wakes its island. Returns false if the bodies of an interaction were swapped since the pairs were made.
bool SceneLink::readForces(cd::Sleepers* sleepers)
{
	constexpr std::size_t early = 12;
	const std::size_t count = pairs.size();
	assert(interactions.size() == count && forces.size() == count && world.carried.size() == count);
	for (std::size_t i = 0; i < count + 2 * early; i++) {
		if (i < count && interactions[i])
			prefetch(interactions[i], { interaction_id1, interaction_phys });
		if (i >= early && i - early < count && interactions[i - early])
			forces[i - early] = findForces(interactions[i - early]);
		if (i < 2 * early || !interactions[i - 2 * early])
			continue; // a pair without interaction carries nothing
		const std::size_t now = i - 2 * early;
		const bool turned = pairs[now].a != interaction_id1(interactions[now]); // which the step itself would not notice
		if (turned && !inspecting)
			return false;
		Forces& f = forces[now];
		if (turned || !f.geom || !f.phys || !isScGeom(f.geom) || !isFrictPhys(f.phys))
			f.geom = f.phys = nullptr; // a step cannot read or write such objects
		const cd::Carried found = carriedIn(f);
		if (found.same(world.carried[now]))
			continue;
		world.carried[now] = found;
		if (found.any())
			world.carried[now].since = interaction_iterMadeReal(interactions[now]);
		if (sleepers)
			sleepers->disturb(pairs[now].a, pairs[now].b);
	}
	return true;
}

void SceneLink::setFriction(cd::Threads& threads)
{
	cd::forRanges(&threads, world.awake.size(), [&](std::size_t from, std::size_t to) {
		for (std::size_t k = from; k < to; k++) {
			cd::Pair& pair = world.pairs[world.awake[k]];
			pair.mu = std::min(world.bodies[pair.a].friction, world.bodies[pair.b].friction); // the smaller angle of the two, as YADE
		}
	});
}

void SceneLink::gather(yade::Scene* scene, const Vector3r& g, double dt, const Memory& memory, bool look, double margin, cd::TimeStep& step,
    const std::vector<double>& outran)
{
	checkScene(scene, dt);
	if (behind && g != gravity) {
		for (const int id : driven)
			readVelocity(id, world.bodies[id]);
		publishScene(scene, step); // so that the bodies are read anew, with their new weights
	}
	const bool read = !behind;
	if (read) {
		gravity = g;
		gatherBodies(scene);
	} else {
		for (const int id : driven) // all of them, since a refusal writes them back
			readVelocity(id, world.bodies[id]);
		std::for_each(driven.begin(), driven.end(), [this](int id) { checkMotion(id); });
	}
	bool reordered;
	{
		const std::lock_guard<std::mutex> lock(memory.lock);
		memory.overlaps.forgetBodies(gone);
		reordered = cd::renewOrder(world, memory.order, look);
	}
	gone.clear();
	if (behind && reordered)
		publishScene(scene, step); // the pairs are then read from it in their new order
	const bool searched = search.needed(world, dt, margin, outran, &step.threads);
	if (searched) {
		before.swap(pairs);
		search.find(world, pairs);
		tellOfFalls(dt);
	}
	gatherPairs(scene, memory, read, searched, reordered, step.sleepers);
	if (read || searched || reordered)
		setFriction(step.threads);
}

void SceneLink::inspectScene(yade::Scene* scene, const Vector3r& g, double dt, const Memory& memory, bool look)
{
	inspecting = true;
	cd::TimeStep none;
	gather(scene, g, dt, memory, look, 0, none, {});
}

} // namespace cd_engine
