#include "scene/hidden_features.hpp"

#include <algorithm>

namespace cd {
namespace {

	constexpr double flush = 1e-6; // of a sphere's radius: distances up to this are none

	bool isFeature(const HiddenFeatures::Standing& s, const Pair& pair)
	{
		return footOnBoundary(s.shapes[pair.a], s.places[pair.b].at - s.places[pair.a].at).feature;
	}

} // namespace

void HiddenFeatures::list(const WorldOf<Space3>& world)
{
	if (world.listing != 0 && world.listing == listing && world.pairs.size() == pairs)
		return;
	listing = world.listing;
	pairs = world.pairs.size();
	near.clear();
	for (std::size_t k = 0; k < pairs; k++)
		if (const Pair& pair = world.pairs[k]; isBoundary(world.bodyOf(pair.a)) && isGuided(world.bodyOf(pair.a)))
			near.push_back({ pair.b, static_cast<int32_t>(k) });
	std::sort(
	    near.begin(), near.end(), [](const Near& a, const Near& b) { return a.sphere != b.sphere ? a.sphere < b.sphere : a.pair < b.pair; });
}

bool HiddenFeatures::covers(const Standing& s, std::size_t other, std::size_t index, double dt) const
{
	const Pair &pair = s.world.pairs[index], &by = s.world.pairs[other];
	const SpacePlace& sphere = s.places[pair.b];
	const SpaceMeeting &here = s.meetings[index], &there = s.meetings[other];
	const double small = flush * sphere.radius;
	if (there.overlap < here.overlap - small)
		return false;
	// The points of both contacts, from the sphere's centre.
	const Vector3 arm = -(sphere.radius - here.overlap) * here.n, otherArm = -(sphere.radius - there.overlap) * there.n, point = sphere.at + arm;
	if (footOnBoundary(s.shapes[by.a], point - s.places[by.a].at).distance > small)
		return false;
	// Of two different points the nearer one counts. If they are the same, a face comes before a feature, else the lower number.
	if (length(otherArm - arm) > small) {
		if (there.overlap <= here.overlap)
			return false;
	} else {
		const bool feature = isFeature(s, pair), otherFeature = isFeature(s, by);
		if (feature != otherFeature ? otherFeature : by.a > pair.a)
			return false;
	}
	const auto speed = [&](const Pair& of) { return velocityAt(s.world.bodyOf(of.a), point - s.places[of.a].at); };
	return dt * dot(speed(pair) - speed(by), there.n) <= small; // else it comes out
}

template <class Visit> bool HiddenFeatures::anyCovering(const Standing& s, std::size_t index, double dt, const Visit& visit) const
{
	return anyBeside(s.world, index, [&](std::size_t other) { return covers(s, other, index, dt) && visit(other); });
}

bool HiddenFeatures::isHidden(const Standing& s, std::size_t index, double dt) const
{
	const Pair& pair = s.world.pairs[index];
	return isBoundary(s.places[pair.a]) && isGuided(s.world.bodyOf(pair.a)) && anyCovering(s, index, dt, [](std::size_t) { return true; });
}

bool HiddenFeatures::meetsAhead(const Standing& s, std::size_t index, double dt, SpaceMeeting& ahead) const
{
	const Pair& pair = s.world.pairs[index];
	const SpaceShape& facet = s.shapes[pair.a];
	const SpacePlace& sphere = s.places[pair.b];
	Vector3 nearest;
	SpaceFoot foot;
	if (facet.kind != ShapeKind::facet || !footBeyondEdge(facet, sphere.at - s.places[pair.a].at, nearest, foot))
		return false;
	ahead = { foot.n, sphere.radius - foot.distance };
	const double small = flush * sphere.radius;
	bool concave = false;
	const bool flat = anyCovering(s, index, dt, [&](std::size_t other) {
		if (isFeature(s, s.world.pairs[other]))
			return false;
		double lowest = endless, highest = -endless;
		for (const Vector3& corner : facet.part) {
			const double above = dot(s.meetings[other].n, corner - nearest);
			lowest = std::min(lowest, above);
			highest = std::max(highest, above);
		}
		concave = concave || (lowest >= -small && highest > small);
		return lowest >= -small && highest <= small; // it lies in the facet's plane, and meets the sphere there
	});
	return concave && !flat;
}

} // namespace cd
