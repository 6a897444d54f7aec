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
	const double small = flush * sphere.radius, nearer = s.meetings[other].overlap - s.meetings[index].overlap;
	if (nearer < -small)
		return false;
	// The point of the contact.
	const Vector3 point = sphere.at - (sphere.radius - s.meetings[index].overlap) * s.meetings[index].n;
	const SpaceFoot on = footOnBoundary(s.shapes[by.a], point - s.places[by.a].at);
	if (on.distance > small)
		return false;
	if (nearer <= small) { // as near: a face comes before a feature, else the lower number
		const bool feature = isFeature(s, pair), otherFeature = isFeature(s, by);
		if (feature != otherFeature ? otherFeature : by.a > pair.a)
			return false;
	}
	const auto speed = [&](const Pair& of) { return velocityAt(s.world.bodyOf(of.a), point - s.places[of.a].at); };
	return dt * dot(speed(pair) - speed(by), s.meetings[other].n) <= small; // else it comes out
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
