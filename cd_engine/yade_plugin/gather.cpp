// How a step reads the scene: the bodies, the search for pairs, and what the pairs carry now.
#include "kind.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iostream>
#include <utility>

namespace cd_engine {
namespace {

	double sideOf(const cd::Half& half, int axis) { return axis == 0 ? half.x : half.y; }
	double sideOf(const cd::Vector3& half, int axis) { return half[axis]; }
	double speedOf(const cd::Body& b) { return std::hypot(b.v[0], b.v[1]); }
	double speedOf(const cd::SpaceBody& b) { return length(velocityOf(b)); }

} // namespace

template <class Space> void SceneLink<Space>::warnOnce(const std::string& what, const std::string& remedy)
{
	if (!inspecting && warned.insert(what).second)
		std::cerr << "ContactDynamics: " << what << " " << remedy << '\n';
}

template <class Space> double SceneLink<Space>::massRatio() const
{
	double least = cd::endless, most = 0; // inverse masses
	for (const auto& b : world.bodies)
		if (const double inverse = *std::max_element(b.inverseMass, b.inverseMass + Space::components); inverse > 0) {
			least = std::min(least, inverse);
			most = std::max(most, inverse);
		}
	return most > 0 ? most / least : 1;
}

template <class Space> void SceneLink<Space>::checkScene(yade::Scene* scene, double dt)
{
	if (scene_isPeriodic(scene))
		throw SceneError("ContactDynamics: the scene is periodic, which is not supported. Set O.periodic=False and use walls");
	if (dt == 1e-8)
		warnOnce("O.dt is 1e-8 s, the value that YADE starts with.", "Rigid contacts take steps of about 1e-3 s: set O.dt.");
	if (!(dt > 0 && std::isfinite(dt)))
		throw SceneError(text("ContactDynamics: the time step O.dt is ", dt, " s. Set it to a positive number"));
}

// Two boundaries make no pair, so nothing holds one that gravity moves down onto another, or that its velocity or a force moves onto one from which
// it is still apart. Warns of such a pair once, and if gravity moves all of them. Called after a search.
template <class Space> void SceneLink<Space>::warnOfUnheldBoundaries(double dt)
{
	const double fits = 1.8 * cd::smallestRadius(world); // where a disk fits between two, pressed in by a tenth [m]
	const int count = static_cast<int>(bodies.size());
	constexpr int axes = Space::components;
	const char* const kinds = axes == 2 ? "Box and Wall" : "Box, Wall and Facet";
	int falling = -1;
	bool held = false;
	for (int mover = 0; mover < count; mover++) {
		const Body& a = world.bodies[mover];
		if (world.masks[mover] == 0)
			continue;
		bool pulled = false, moves = false;
		for (int k = 0; k < axes; k++) {
			pulled = pulled || a.inverseMass[k] * pull[k] != 0;
			moves = moves || a.inverseMass[k] != 0;
		}
		held = held || !pulled; // a fixed disk holds the scene, too
		if (!isBoundary(a) || !moves)
			continue;
		falling = pulled ? mover : falling;
		const auto ha = cd::halfSides(a, world.shapes[mover]);
		// A large force makes the margin wide. If the boundary has disks near it, which may carry the force, only its present motion counts.
		const bool meetsDisks = std::any_of(world.pairs.begin(), world.pairs.end(), [&](const cd::Pair& pair) { return pair.a == mover; });
		const double most = meetsDisks ? fits + 10 * dt * speedOf(a) : cd::endless;
		for (int other = 0; other < count; other++) {
			const Body& b = world.bodies[other];
			if (other == mover || !isBoundary(b) || world.masks[other] == 0)
				continue;
			const auto hb = cd::halfSides(b, world.shapes[other]);
			const auto way = centreOf(b) - centreOf(a);
			const double margin = std::min(search.marginOf(mover) + search.marginOf(other), most);
			// The axis with the smallest overlap decides: a boundary that slides along a side wall overlaps it least across its motion,
			// and a piston with clearance not at all. What lies across another in all its thickness crosses it from the beginning, as
			// the plates of aabbWalls do, or a Wall, endless along itself.
			double overlap[axes];
			for (int i = 0; i < axes; i++)
				overlap[i] = sideOf(ha, i) + sideOf(hb, i) - std::abs(way[i]);
			int k = axes - 1;
			for (int i = axes - 1; i-- > 0;)
				k = overlap[i] < overlap[k] ? i : k;
			bool besides = false; // they miss each other along another axis
			for (int i = 0; i < axes; i++)
				besides = besides || (i != k && !(overlap[i] > 0));
			const bool crosses = overlap[k] == cd::endless || overlap[k] > std::max(margin, 2 * sideOf(ha, k));
			if (crosses || overlap[k] < -margin || a.inverseMass[k] == 0 || besides)
				continue;
			const bool falls = way[k] * pull[k] > 0, comes = overlap[k] < 0 && (way[k] * a.v[k] > 0 || way[k] * a.force[k] > 0);
			const auto [first, second] = std::minmax(mover, other); // having passed through each other they meet again
			if ((falls || comes) && warned.insert(text("boundaries ", first, " ", second)).second)
				warnOnce(text("body #", mover, " is a boundary that ", falls ? "gravity" : "its velocity or a force",
					     " moves onto another: ", kinds, " never touch each other."),
				    text("It will pass through body #", other,
					". To prevent this, block its motion (state.blockedDOFs), or leave a gap between the two."));
		}
	}
	if (falling >= 0 && !held)
		warnOnce(text("gravity moves every boundary, such as body #", falling, ", so the whole scene falls."),
		    "Fix the boundary that has to hold the scene: state.blockedDOFs='xyzXYZ'.");
}

template <class Space> void SceneLink<Space>::forget(yade::Interaction* interaction) const
{
	if (inspecting)
		return;
	interaction_geom(interaction).reset();
	interaction_phys(interaction).reset();
	interaction_iterMadeReal(interaction) = -1;
}

// Puts the bodies of an interaction in the order of its pair. YADE's own functors, too, want the boundary first.
template <class Space> void SceneLink<Space>::turn(std::size_t index) const
{
	yade::Interaction* const interaction = interactions[index];
	if (inspecting || interaction_id1(interaction) == world.pairs[index].a)
		return;
	forget(interaction);
	interaction->swapOrder();
}

// Pairs that were listed before keep their objects.
template <class Space> void SceneLink<Space>::keepPairs()
{
	for (const int32_t i : search.left()) {
		if (interactions[i])
			parted.push_back(interactions[i]);
		recycle(std::move(objects[i]));
	}
	search.rearrange(interactions);
	search.rearrange(objects);
}

// Gives the pairs the interactions that the scene has for them. Interactions without a pair lose their forces: a disk may have become a box.
template <class Space> void SceneLink<Space>::takePairs(yade::Scene* scene)
{
	listed = interactionsOf(scene);
	parted.clear();
	interactions.clear();
	for (const cd::Pair& pair : world.pairs)
		interactions.push_back(scene_interactions(scene)->find(pair.a, pair.b).get());
	std::vector<yade::Interaction*> taken(interactions);
	std::sort(taken.begin(), taken.end());
	for (const auto& interaction : listed)
		if (!std::binary_search(taken.begin(), taken.end(), interaction.get()))
			forget(interaction.get());
	for (std::size_t k = 0; k < interactions.size(); k++)
		if (interactions[k])
			turn(k);
	for (ForceObjects& o : objects)
		recycle(std::move(o));
	objects.assign(world.pairs.size(), {});
	world.carried.assign(world.pairs.size(), {});
}

// Gives the pairs their reference overlaps: all, or those that were not listed before.
template <class Space> void SceneLink<Space>::takeReferences(const Memory& memory, bool all)
{
	world.listing++;
	std::size_t touching = 0;
	const auto isGone = [this](int id) { return std::binary_search(gone.begin(), gone.end(), id); };
	for (std::size_t k = 0; k < world.pairs.size(); k++) {
		cd::Pair& pair = world.pairs[k];
		if (all || search.from()[k] < 0)
			pair.reference = isGone(pair.a) || isGone(pair.b) ? 0 : memory.overlaps.of(pair.a, pair.b);
		touching += pair.reference > 0;
	}
	if (inspecting || touching == memory.overlaps.overlaps.size())
		return;
	const std::lock_guard<std::mutex> lock(memory.lock);
	collectOverlaps(memory.overlaps); // leaves out those of bodies that are gone or that somebody has moved apart
}

// read: whether the scene has been read; searched: whether the list of pairs is new; reordered: whether its order is new.
template <class Space>
void SceneLink<Space>::gatherPairs(yade::Scene* scene, const Memory& memory, bool read, bool searched, bool reordered, Sleepers& sleepers)
{
	// `listed` holds on to its interactions, so that a new one cannot get an old one's address.
	bool taken = reordered || (read && (outdated || interactionsOf(scene) != listed));
	if (searched && !taken)
		keepPairs();
	if (read && !taken)
		taken = !readForces(searched ? nullptr : &sleepers);
	if (taken) {
		takePairs(scene);
		readForces(nullptr);
		outdated = false;
	}
	if (!searched && !taken)
		return sleepers.update(world);
	takeReferences(memory, taken);
	if (searched && search.mover() >= 0)
		sleepers.wakeAll(world, { "near pairs were searched anew, since a body has moved far", search.mover() });
	else
		sleepers.wakeAll(world);
}

// Whether an interaction holds the force of a contact in objects that a step can read and write.
template <class Space> bool SceneLink<Space>::holdsForce(std::size_t index, bool turned)
{
	const auto& geom = interaction_geom(interactions[index]);
	const auto& phys = interaction_phys(interactions[index]);
	ForceObjects& known = objects[index];
	known.real = geom || phys;
	if (!known.real)
		return false;
	if (turned || !geom || !phys || !isScGeom(geom.get()) || !isFrictPhys(phys.get())) {
		known.geom.reset();
		known.phys.reset();
		return false;
	}
	if (known.geom != geom)
		known.geom = geom;
	if (known.phys != phys) {
		known.phys = phys;
		known.holdMoment = isCohFrictPhys(phys.get());
	}
	return true;
}

template <> cd::Carried SceneLink<cd::Plane>::readForce(std::size_t index, bool turned)
{
	if (!holdsForce(index, turned))
		return {};
	const ForceObjects& o = objects[index];
	const Vector3r &n = geom_normal(o.geom), &fn = phys_normalForce(o.phys), &ft = phys_shearForce(o.phys);
	const int x = frame.x, y = frame.y;
	const double moment = o.holdMoment ? frame.turn * cohPhys_moment(o.phys)[frame.normal] : 0;
	return { n[x], n[y], { fn[x], fn[y] }, { ft[x], ft[y] }, -1, moment };
}

template <> cd::SpaceCarried SceneLink<cd::Space3>::readForce(std::size_t index, bool turned)
{
	if (!holdsForce(index, turned))
		return {};
	const ForceObjects& o = objects[index];
	const auto read = [](const Vector3r& v) { return cd::Vector3 { v[0], v[1], v[2] }; };
	return { read(geom_normal(o.geom)), read(phys_normalForce(o.phys)), read(phys_shearForce(o.phys)), -1 };
}

// Reads the present force of every contact: three dependent look-ups in different memory lines, each prefetched before the next. A force that
// somebody has changed wakes its island. Returns false if the bodies of an interaction were swapped since the pairs were made.
template <class Space> bool SceneLink<Space>::readForces(Sleepers* sleepers)
{
	constexpr std::size_t early = 12;
	const std::size_t count = world.pairs.size();
	assert(interactions.size() == count && objects.size() == count && world.carried.size() == count);
	for (std::size_t i = 0; i < count + 2 * early; i++) {
		if (i < count && interactions[i])
			prefetch(interactions[i], { interaction_id1, interaction_phys });
		if (i >= early && i - early < count && interactions[i - early]) {
			if (void* const geom = interaction_geom(interactions[i - early]).get())
				prefetch(geom, { 0, geom_normal + 16 });
			if (void* const phys = interaction_phys(interactions[i - early]).get())
				prefetch(phys, { 0, phys_shearForce + 16 });
		}
		if (i < 2 * early || !interactions[i - 2 * early])
			continue; // a pair without interaction carries nothing
		const std::size_t now = i - 2 * early;
		const cd::Pair& pair = world.pairs[now];
		const bool turned = pair.a != interaction_id1(interactions[now]); // which the step itself would not notice
		if (turned && !inspecting)
			return false;
		const Carried found = readForce(now, turned);
		if (found.same(world.carried[now]))
			continue;
		world.carried[now] = found;
		if (found.any())
			world.carried[now].since = interaction_iterMadeReal(interactions[now]);
		if (sleepers)
			sleepers->disturb(pair.a, pair.b);
	}
	return true;
}

template <class Space>
void SceneLink<Space>::gather(yade::Scene* scene, const Vector3r& g, double dt, const Memory& memory, bool checksOrder, double margin, TimeStep& step,
    const std::vector<double>& outran)
{
	checkScene(scene, dt);
	for (const int id : driven) // all of them, since a refusal writes them back
		readVelocity(id, world.bodies[id]);
	if (unpublished && (g != gravity || mask != maskBefore))
		publishScene(scene, step); // so that the bodies are read anew, with their new weights and surfaces
	std::for_each(driven.begin(), driven.end(), [this](int id) { checkMotion(id); });
	const bool read = !unpublished;
	if (read) {
		gravity = g;
		gatherBodies(scene);
	} else if (!driven.empty()) {
		scene_forces(scene).sync();
		for (const int id : driven)
			readMotion(id, world.bodies[id], scene_forces(scene));
	}
	bool reordered;
	{
		const std::lock_guard<std::mutex> lock(memory.lock);
		reordered = cd::renewOrder(world, memory.order, checksOrder);
	}
	if (unpublished && reordered)
		publishScene(scene, step); // the pairs are then read from it in their new order
	const bool searched = search.needed(world, dt, margin, outran, &step.threads) || reordered;
	if (searched) {
		search.find(world, memory.order.rank);
		warnOfUnheldBoundaries(dt);
	}
	gatherPairs(scene, memory, read, searched, reordered, step.sleepers);
	gone.clear();
	if (read || searched || newValues) {
		setFriction(step.threads);
		setRestitution();
	}
	newValues = false;
	if (!stiffness.rigid() || world.compliant())
		setStiffness(step.sleepers);
	if (anyRolls || world.rolls())
		setRolling(step.sleepers);
	if (std::exchange(newSurfaces, false))
		step.sleepers.wakeAll(world, { "the surface of a belt has another velocity", -1 });
}

template <class Space> void SceneLink<Space>::inspectScene(yade::Scene* scene, const Vector3r& g, double dt, const Memory& memory, bool checksOrder)
{
	inspecting = true;
	TimeStep none;
	gather(scene, g, dt, memory, checksOrder, 0, none, {});
}

#define INSTANTIATE(Space)                                                                                                                           \
	template void SceneLink<Space>::warnOnce(const std::string&, const std::string&);                                                            \
	template double SceneLink<Space>::massRatio() const;                                                                                         \
	template void SceneLink<Space>::forget(yade::Interaction*) const;                                                                            \
	template void SceneLink<Space>::turn(std::size_t) const;                                                                                     \
	template void SceneLink<Space>::gather(                                                                                                      \
	    yade::Scene*, const Vector3r&, double, const Memory&, bool, double, cd::TimeStep<Space>&, const std::vector<double>&);                   \
	template void SceneLink<Space>::inspectScene(yade::Scene*, const Vector3r&, double, const Memory&, bool);
INSTANTIATE(cd::Plane)
INSTANTIATE(cd::Space3)

} // namespace cd_engine
