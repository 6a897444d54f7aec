// Overlaps that count as touching: what springs have left behind.
#include "scene_link.hpp"

#include <boost/iterator/counting_iterator.hpp>

#include <algorithm>
#include <set>

namespace cd_engine {
namespace {

	// Share of a disk's radius: a larger overlap is not left by springs but is a mistake in the scene (the paper's are 1e-3).
	constexpr double mostOverlap = 0.2;
	// Share of a disk's radius: smaller overlaps give no warning.
	constexpr double visible = 0.01;

} // namespace

template <class Space> std::string SceneLink<Space>::behindWall(const cd::Pair& pair) const
{
	const Shape& wall = world.shapes[pair.a];
	const Body &a = world.bodyOf(pair.a), &b = world.bodyOf(pair.b);
	if (!isBoundary(a) || wall.kind != cd::ShapeKind::wall || wall.sense * (centreOf(b) - centreOf(a))[wall.axis] >= 0)
		return "";
	return text("body #", pair.b, " is behind Wall #", pair.a, ", which with sense=", wall.sense, " has one side only and is solid behind it. ",
	    "Move the body to the other side, or set O.bodies[", pair.a, "].shape.sense=0 for a wall of two sides");
}

template <class Space> double SceneLink<Space>::takeOverlaps(bool ofOwnSprings)
{
	double largest = 0;
	std::vector<double> overlaps; // a refusal leaves the pairs as they are
	overlaps.reserve(world.pairs.size());
	struct Worst {
		const cd::Pair* pair = nullptr;
		double share = 0; // its overlap over the radius
	} worst, unloaded;
	for (const cd::Pair& pair : world.pairs) {
		const cd::PlaceOf<Space> a = placeAhead(world.bodyOf(pair.a), 0), b = placeAhead(world.bodyOf(pair.b), 0);
		const double overlap = overlaps.emplace_back(std::max(0., cd::locateContact(a, b, world.shapes[pair.a]).overlap));
		if (isGuided(world, pair))
			continue;
		largest = std::max(largest, overlap);
		const double share = overlap / world.bodyOf(pair.b).radius;
		if (!(share <= worst.share))
			worst = { &pair, share };
		if (!(share <= unloaded.share) && !world.carries(&pair - world.pairs.data()))
			unloaded = { &pair, share };
	}
	const auto what = [](const Worst& of) {
		return text("bodies #", of.pair->a, " and #", of.pair->b, " overlap by ", of.share, " of a radius at the start");
	};
	if (!ofOwnSprings && !(worst.share <= mostOverlap)) {
		const std::string reason = behindWall(*worst.pair);
		const bool plate = worst.share > 1 && isBoundary(world.bodyOf(worst.pair->a));
		const std::string remedy = plate ? text(", or erase body #", worst.pair->a, " if it is a plate in front of or behind the disks") : "";
		throw SceneError(
		    "ContactDynamics: " + (reason.empty() ? what(worst) + ", more than springs leave behind. Move them apart" + remedy : reason));
	}
	for (std::size_t k = 0; k < overlaps.size(); k++)
		world.pairs[k].reference = overlaps[k];
	if (unloaded.share > visible && warned.insert("overlap").second)
		warnOnce(what(unloaded) + ", and no spring force acts between them. The engine keeps this overlap and counts it as touching.",
		    "Move such bodies apart, or set handover=False and gapCorrection=0.1, which removes overlaps.");
	return largest;
}

template <class Space> void SceneLink<Space>::forgetOverlaps()
{
	for (cd::Pair& pair : world.pairs)
		pair.reference = 0;
}

template <class Space> const cd::Pair& SceneLink<Space>::deepest(const TimeStep& step) const
{
	const std::vector<int32_t>& pairs = step.pairs();
	const auto gap = [&](int32_t i) { return isGuided(world, world.pairs[i]) ? cd::endless : step.gapOf(world, i); };
	return world.pairs[*std::min_element(pairs.begin(), pairs.end(), [&](int32_t i, int32_t k) { return gap(i) < gap(k); })];
}

template <class Space> void SceneLink<Space>::collectOverlaps(const ReferenceOverlaps& all) const
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

double ReferenceOverlaps::of(int id1, int id2) const
{
	const std::pair<int, int> wanted = std::minmax(id1, id2);
	const boost::counting_iterator<std::size_t> begin(0), end(overlaps.size());
	const auto found = std::lower_bound(begin, end, wanted, [this](std::size_t i, const auto& value) { return pair(i) < value; });
	return found != end && pair(*found) == wanted ? overlaps[*found] : 0;
}

void ReferenceOverlaps::forget(const std::vector<cd::Pair>& pairs, const std::vector<int32_t>& which) const
{
	std::set<std::pair<int, int>> all;
	for (const int32_t i : which)
		all.insert(std::minmax(pairs[i].a, pairs[i].b));
	std::size_t kept = 0;
	for (std::size_t i = 0; i < overlaps.size(); i++) {
		if (all.count(pair(i)) > 0)
			continue;
		ids[2 * kept] = ids[2 * i];
		ids[2 * kept + 1] = ids[2 * i + 1];
		overlaps[kept++] = overlaps[i];
	}
	ids.resize(2 * kept);
	overlaps.resize(kept);
}

#define INSTANTIATE(Space)                                                                                                                           \
	template std::string SceneLink<Space>::behindWall(const cd::Pair&) const;                                                                    \
	template double SceneLink<Space>::takeOverlaps(bool);                                                                                        \
	template void SceneLink<Space>::forgetOverlaps();                                                                                            \
	template const cd::Pair& SceneLink<Space>::deepest(const cd::TimeStep<Space>&) const;                                                        \
	template void SceneLink<Space>::collectOverlaps(const ReferenceOverlaps&) const;
INSTANTIATE(cd::Plane)
INSTANTIATE(cd::Space3)

} // namespace cd_engine
