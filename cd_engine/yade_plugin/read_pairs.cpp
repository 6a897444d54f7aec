// The near pairs the collider found, their friction, reference overlaps and the forces they carry now.
#include "inheritance.hpp"
#include "scene_link.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cd_engine {
namespace {

	// Of a disk's radius: overlaps above this are no springs' but a mistake in the scene (the paper's are 1e-3).
	constexpr double mostOverlap = 0.2;

	// Where a pair comes in the list of contacts, from which the sweeps take their order. A function of its ids alone, so that the result of a
	// step depends neither on the order of the scene's list nor on which other pairs are in it. Pairs of 32 neighbouring ids stay together, for
	// locality, and are scattered among themselves, so that near in the list are contacts without a common body: those are solved eight at a
	// time (core/grouping.hpp).
	uint64_t sweepKey(int id1, int id2)
	{
		const uint64_t low = std::min(id1, id2), high = std::max(id1, id2);
		uint64_t h = (low << 32 | high) * 0x9E3779B97F4A7C15ull; // Fibonacci hashing (Knuth, vol. 3, section 6.4)
		h ^= h >> 32;
		h *= 0xD6E8FEB86659FD93ull;
		return low >> 5 << 40 | h >> 24;
	}

} // namespace

bool SceneLink::pairsUnchanged(yade::InteractionContainer* container) const
{
	const auto& all = at<std::vector<boost::shared_ptr<yade::Interaction>>>(container, layout.interactions_linear);
	if (all.size() != listed.size())
		return false;
	for (std::size_t i = 0; i < all.size(); i++) {
		yade::Interaction* const p = all[i].get();
		if (p != listed[i].interaction || at<int>(p, layout.interaction_id1) != listed[i].id1
		    || at<int>(p, layout.interaction_id2) != listed[i].id2)
			return false;
	}
	return true;
}

void SceneLink::rebuildPairs(yade::InteractionContainer* container, const ReferenceOverlaps& known)
{
	const auto& all = at<std::vector<boost::shared_ptr<yade::Interaction>>>(container, layout.interactions_linear);
	std::vector<cd::Pair> pairs;
	std::vector<yade::Interaction*> of;
	const int count = static_cast<int>(bodies.size());
	for (const auto& shared : all) {
		yade::Interaction* const interaction = shared.get();
		int& id1 = at<int>(interaction, layout.interaction_id1);
		int& id2 = at<int>(interaction, layout.interaction_id2);
		if (id1 >= count || id2 >= count || !bodies[id1].exists || !bodies[id2].exists)
			continue;
		if ((bodies[id1].boundary && bodies[id2].boundary) || !bodies[id1].inPlane || !bodies[id2].inPlane)
			continue;
		const bool turned = bodies[id2].boundary; // YADE's own functors, too, want the boundary first
		if (turned && !inspecting) {
			at<boost::shared_ptr<yade::IGeom>>(interaction, layout.interaction_geom).reset();
			at<boost::shared_ptr<yade::IPhys>>(interaction, layout.interaction_phys).reset();
			interaction->swapOrder();
		}
		cd::Pair pair;
		// id1 and id2 are references: swapOrder has exchanged them.
		pair.a = turned && inspecting ? id2 : id1;
		pair.b = turned && inspecting ? id1 : id2;
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
	for (std::size_t i = 0; i < interactions.size() + ahead; i++) {
		if (i < interactions.size()) {
			char* const interaction = reinterpret_cast<char*>(interactions[i]);
			void* const geom = pointer<yade::IGeom>(interaction, layout.interaction_geom);
			void* const phys = pointer<yade::IPhys>(interaction, layout.interaction_phys);
			forces[i] = { geom, phys, geom || phys };
			if (geom)
				__builtin_prefetch(geom);
			if (phys)
				__builtin_prefetch(phys);
			if (phys)
				__builtin_prefetch(static_cast<char*>(phys) + 64);
		}
		if (i < ahead)
			continue;
		Forces& f = forces[i - ahead];
		if (!f.geom || !f.phys || !inherits(f.geom, Base::ScGeom) || !inherits(f.phys, Base::FrictPhys))
			f.geom = f.phys = nullptr;
	}
}

// The force present on the contact, along its own normal, times dt: what YADE keeps is all the memory a warm start needs.
void SceneLink::readImpulse(std::size_t index, double dt)
{
	cd::Pair& pair = world.pairs[index];
	pair.pn = pair.pt = 0;
	if (!forces[index].geom)
		return;
	const Vector3r& n = at<Vector3r>(forces[index].geom, layout.geom_normal);
	const Vector3r& fn = at<Vector3r>(forces[index].phys, layout.phys_normalForce);
	const Vector3r& ft = at<Vector3r>(forces[index].phys, layout.phys_shearForce);
	const double normal = n[0] * fn[0] + n[1] * fn[1], tangential = n[0] * ft[1] - n[1] * ft[0];
	if (!(normal > 0) || !std::isfinite(tangential))
		return; // springs may pull; a rigid contact does not
	pair.pn = dt * normal;
	pair.pt = dt * tangential;
}

void SceneLink::gatherPairs(yade::Scene* scene, double dt, bool impulses, const ReferenceOverlaps& known)
{
	auto* const container = at<boost::shared_ptr<yade::InteractionContainer>>(scene, layout.scene_interactions).get();
	if (!pairsUnchanged(container))
		rebuildPairs(container, known);
	findForces();
	for (std::size_t i = 0; i < world.pairs.size(); i++) {
		cd::Pair& pair = world.pairs[i];
		if (inspecting && pair.a != at<int>(interactions[i], layout.interaction_id1))
			forces[i] = {}; // the step itself would forget them with their order
		pair.mu = std::min(bodies[pair.a].friction, bodies[pair.b].friction); // the smaller angle of the two, as YADE
		if (impulses)
			readImpulse(i, dt);
		else
			pair.pn = pair.pt = 0;
	}
}

void SceneLink::takeOverlaps()
{
	for (cd::Pair& pair : world.pairs) {
		pair.reference = 0;
		const cd::Body& a = world.bodies[pair.a];
		cd::locateContact(pair, cd::placeAhead(a, 0), cd::placeAhead(world.bodies[pair.b], 0), a.shape);
		pair.reference = std::max(0., pair.overlap);
		const double radius = world.bodies[pair.b].shape.radius;
		if (!(pair.reference <= mostOverlap * radius))
			throw SceneError("ContactDynamics: bodies #" + std::to_string(pair.a) + " and #" + std::to_string(pair.b) + " overlap by "
			    + std::to_string(pair.reference / radius)
			    + " of a radius at the hand-over, more than springs leave behind. Move them apart");
	}
}

void SceneLink::collectOverlaps(const ReferenceOverlaps& all) const
{
	std::vector<const cd::Pair*> kept;
	for (const cd::Pair& pair : world.pairs)
		if (pair.reference > 0)
			kept.push_back(&pair);
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
	std::size_t low = 0, high = overlaps.size();
	while (low < high) {
		const std::size_t middle = (low + high) / 2;
		if (std::make_pair(ids[2 * middle], ids[2 * middle + 1]) < wanted)
			low = middle + 1;
		else
			high = middle;
	}
	return low < overlaps.size() && std::make_pair(ids[2 * low], ids[2 * low + 1]) == wanted ? overlaps[low] : 0;
}

} // namespace cd_engine
