// Reads the near pairs, their friction, their reference overlaps and the forces that they carry now.
#include "inheritance.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

namespace cd_engine {
namespace {

	// Share of a disk's radius: a larger overlap is not left by springs but is a mistake in the scene (the paper's are 1e-3).
	constexpr double mostOverlap = 0.2;
	// Share of a disk's radius: smaller overlaps give no warning.
	constexpr double visible = 0.01;

	// Whether the indices are strictly ascending and below `of`.
	[[maybe_unused]] bool isSelection(const std::vector<int32_t>& chosen, std::size_t of)
	{
		return std::adjacent_find(chosen.begin(), chosen.end(), std::greater_equal<int32_t>()) == chosen.end()
		    && (chosen.empty() || (chosen.front() >= 0 && static_cast<std::size_t>(chosen.back()) < of));
	}

} // namespace

// Whether the pairs still match the scene's list. `listed` holds on to its interactions, so that a new one cannot get an old one's address.
bool SceneLink::listUnchanged(yade::InteractionContainer* container) const
{
	return !outdated && at<std::vector<boost::shared_ptr<yade::Interaction>>>(container, layout.interactions_linear) == listed;
}

// Warns if gravity moves a boundary down onto another one, or its velocity or a force moves it onto one from which it is still apart, since nothing
// will hold it there. The axis with the smaller overlap decides: a boundary that slides along a side wall overlaps it least across its motion, and
// a piston with clearance not at all.
void SceneLink::tellOfFall(int upper, int lower)
{
	const cd::Body &a = world.bodies[upper], &b = world.bodies[lower];
	const cd::Half ha = cd::halfSides(a, world.shapes[upper]), hb = cd::halfSides(b, world.shapes[lower]);
	const double way[2] = { b.x - a.x, b.y - a.y }, overlap[2] = { ha.x + hb.x - std::abs(way[0]), ha.y + hb.y - std::abs(way[1]) };
	const int axis = overlap[0] < overlap[1] ? 0 : 1;
	if (!(a.inverseMass[axis] > 0 && overlap[1 - axis] > 0))
		return;
	const bool falls = way[axis] * gravity[axis] > 0;
	if (falls || (overlap[axis] < 0 && (way[axis] * a.v[axis] > 0 || way[axis] * a.force[axis] > 0)))
		tell("body #" + std::to_string(upper) + " is a boundary that " + (falls ? "gravity" : "its velocity or a force")
			+ " moves onto another: Box and Wall never touch each other.",
		    "It will pass through body #" + std::to_string(lower) + ". Block its freedoms if it is not to do so.");
}

// Called after a search, because two boundaries make no pair.
void SceneLink::tellOfFalls()
{
	for (int i = 0; i < static_cast<int>(bodies.size()); i++) {
		const cd::Body& a = world.bodies[i];
		if (world.masks[i] == 0 || !bodies[i].boundary || (a.inverseMass[0] == 0 && a.inverseMass[1] == 0))
			continue;
		const cd::Half ha = cd::halfSides(a, world.shapes[i]);
		for (int k = 0; k < static_cast<int>(bodies.size()); k++) {
			if (k == i || world.masks[k] == 0 || !bodies[k].boundary)
				continue;
			const cd::Body& b = world.bodies[k];
			const cd::Half hb = cd::halfSides(b, world.shapes[k]);
			const double margin = search.marginOf(i) + search.marginOf(k);
			if (std::abs(b.x - a.x) <= ha.x + hb.x + margin && std::abs(b.y - a.y) <= ha.y + hb.y + margin)
				tellOfFall(i, k);
		}
	}
}

void SceneLink::forget(yade::Interaction* interaction) const
{
	if (inspecting)
		return;
	at<boost::shared_ptr<yade::IGeom>>(interaction, layout.interaction_geom).reset();
	at<boost::shared_ptr<yade::IPhys>>(interaction, layout.interaction_phys).reset();
	at<long>(interaction, layout.interaction_iterMadeReal) = -1;
}

// Puts the bodies of an interaction in the order of its pair. YADE's own functors, too, want the boundary first.
void SceneLink::turn(std::size_t index) const
{
	yade::Interaction* const interaction = interactions[index];
	if (inspecting || at<int>(interaction, layout.interaction_id1) == pairs[index].a)
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
void SceneLink::takePairs(yade::InteractionContainer* container, const std::vector<int>& rank)
{
	listed = at<std::vector<boost::shared_ptr<yade::Interaction>>>(container, layout.interactions_linear);
	before.clear();
	parted.clear();
	const auto exists = [this](int id) { return id >= 0 && id < static_cast<int>(bodies.size()) && bodies[id].exists; };
	for (std::size_t i = 0; i < listed.size(); i++) {
		const int32_t a = at<int>(listed[i].get(), layout.interaction_id1), b = at<int>(listed[i].get(), layout.interaction_id2);
		if (!exists(a) || !exists(b))
			continue;
		if (bodies[a].boundary && bodies[b].boundary)
			forget(listed[i].get()); // a disk may have become a box
		else
			before.push_back({ 0, a, b, static_cast<int32_t>(i) });
	}
	order.sort(before, rank);
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
	auto* const container = at<boost::shared_ptr<yade::InteractionContainer>>(scene, layout.scene_interactions).get();
	bool taken = reordered || (read && !listUnchanged(container));
	if (searched || reordered)
		order.sort(pairs, memory.order.rank);
	if (searched)
		tellOfFalls();
	if (searched && !taken)
		keepPairs();
	if (read && !taken)
		taken = !readForces(searched ? nullptr : &sleepers);
	if (taken) {
		takePairs(container, memory.order.rank);
		readForces(nullptr);
		outdated = false;
	}
	if (searched || taken) {
		listPairs(memory, taken);
		sleepers.wakeAll(world);
	} else
		sleepers.look(world);
}

// Finds the objects that hold a contact's force, and prefetches them.
void SceneLink::findForces(std::size_t index)
{
	char* const interaction = reinterpret_cast<char*>(interactions[index]);
	void* const geom = pointer<yade::IGeom>(interaction, layout.interaction_geom);
	void* const phys = pointer<yade::IPhys>(interaction, layout.interaction_phys);
	forces[index] = { geom, phys, geom || phys };
	if (geom) {
		prefetch(geom, 0);
		prefetch(geom, layout.geom_normal + 16);
	}
	if (phys) {
		prefetch(phys, 0);
		prefetch(phys, layout.phys_shearForce + 16);
	}
}

cd::Carried SceneLink::carriedIn(const Forces& f) const
{
	if (!f.geom)
		return {};
	const Vector3r& n = at<Vector3r>(f.geom, layout.geom_normal);
	const Vector3r& fn = at<Vector3r>(f.phys, layout.phys_normalForce);
	const Vector3r& ft = at<Vector3r>(f.phys, layout.phys_shearForce);
	return { n[0], n[1], { fn[0], fn[1] }, { ft[0], ft[1] }, -1 };
}

// Discards objects that a step cannot read or write. Returns false if the interaction's bodies were swapped, which the step itself would not notice.
bool SceneLink::checkForces(std::size_t index)
{
	const bool turned = pairs[index].a != at<int>(interactions[index], layout.interaction_id1);
	Forces& f = forces[index];
	if (turned || !f.geom || !f.phys || !inherits(f.geom, Base::ScGeom) || !inherits(f.phys, Base::FrictPhys))
		f.geom = f.phys = nullptr;
	return !turned;
}

// Reads the present force of every contact: three dependent look-ups in different memory lines, each prefetched before the next. A force that
// somebody has changed wakes its island. Returns false if the bodies of an interaction were swapped since the pairs were made.
bool SceneLink::readForces(cd::Sleepers* sleepers)
{
	constexpr std::size_t early = 12;
	const std::size_t count = pairs.size();
	assert(interactions.size() == count && forces.size() == count && world.carried.size() == count);
	for (std::size_t i = 0; i < count + 2 * early; i++) {
		if (i < count && interactions[i]) {
			prefetch(interactions[i], layout.interaction_id1);
			prefetch(interactions[i], layout.interaction_phys);
		}
		if (i >= early && i - early < count && interactions[i - early])
			findForces(i - early);
		if (i < 2 * early || !interactions[i - 2 * early])
			continue; // a pair without interaction carries nothing
		const std::size_t now = i - 2 * early;
		if (!checkForces(now) && !inspecting)
			return false;
		const cd::Carried found = carriedIn(forces[now]);
		if (found.same(world.carried[now]))
			continue;
		world.carried[now] = found;
		if (found.any())
			world.carried[now].since = at<long>(interactions[now], layout.interaction_iterMadeReal);
		if (sleepers)
			sleepers->disturb(pairs[now].a, pairs[now].b);
	}
	return true;
}

void SceneLink::setFriction(cd::Threads* threads)
{
	assert(isSelection(world.awake, world.pairs.size()));
	cd::forRanges(threads, world.awake.size(), [&](std::size_t from, std::size_t to) {
		for (std::size_t k = from; k < to; k++) {
			cd::Pair& pair = world.pairs[world.awake[k]];
			pair.mu = std::min(world.bodies[pair.a].friction, world.bodies[pair.b].friction); // the smaller angle of the two, as YADE
		}
	});
}

bool SceneLink::isBehind(const cd::Pair& pair) const
{
	const cd::Shape& wall = world.shapes[pair.a];
	const cd::Body &a = world.bodies[pair.a], &b = world.bodies[pair.b];
	return a.radius == 0 && wall.kind == cd::ShapeKind::wall && wall.sense * (wall.axis == 0 ? b.x - a.x : b.y - a.y) < 0;
}

std::string SceneLink::tellBehind(const cd::Pair& pair) const
{
	return "body #" + std::to_string(pair.b) + " is behind Wall #" + std::to_string(pair.a)
	    + ", which with sense=" + std::to_string(world.shapes[pair.a].sense)
	    + " has one side only and is solid behind it. Move the body to the other side, or set O.bodies[" + std::to_string(pair.a)
	    + "].shape.sense=0 for a wall of two sides";
}

void SceneLink::takeOverlaps()
{
	for (cd::Pair& pair : world.pairs) {
		const cd::Place a = cd::placeAhead(world.bodies[pair.a], 0), b = cd::placeAhead(world.bodies[pair.b], 0);
		pair.reference = std::max(0., cd::locateContact(a, b, world.shapes[pair.a]).overlap);
		const double radius = world.bodies[pair.b].radius;
		const auto what = [&] {
			return "bodies #" + std::to_string(pair.a) + " and #" + std::to_string(pair.b) + " overlap by "
			    + std::to_string(pair.reference / radius) + " of a radius at the start";
		};
		if (!(pair.reference <= mostOverlap * radius))
			throw SceneError(
			    "ContactDynamics: " + (isBehind(pair) ? tellBehind(pair) : what() + ", more than springs leave behind. Move them apart"));
		if (pair.reference > visible * radius && !world.carried[&pair - world.pairs.data()].any() && told.insert("overlap").second)
			tell(what() + ", and no springs press them. This overlap is kept: it counts as touching.",
			    "Move such bodies apart, or set handover=False and gapCorrection=0.1, which pushes overlaps out.");
	}
}

const cd::Pair& SceneLink::deepest(const cd::TimeStep& step) const
{
	const std::vector<int32_t>& pairs = step.pairs();
	assert(!pairs.empty());
	return world
	    .pairs[*std::min_element(pairs.begin(), pairs.end(), [&](int32_t i, int32_t k) { return step.gapOf(world, i) < step.gapOf(world, k); })];
}

} // namespace cd_engine
