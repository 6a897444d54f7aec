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

bool HiddenFeatures::isHidden(const Standing& s, std::size_t index, double dt) const
{
	const Pair& pair = s.world.pairs[index];
	if (!isBoundary(s.places[pair.a]) || !isGuided(s.world.bodyOf(pair.a)))
		return false;
	auto other = std::lower_bound(near.begin(), near.end(), pair.b, [](const Near& n, int32_t sphere) { return n.sphere < sphere; });
	for (; other != near.end() && other->sphere == pair.b; other++)
		if (other->pair != static_cast<int32_t>(index) && covers(s, static_cast<std::size_t>(other->pair), index, dt))
			return true;
	return false;
}

} // namespace cd
