#include "scene/hidden_corners.hpp"

#include <algorithm>

namespace cd {
namespace {

	constexpr double flush = 1e-6; // of a disk's radius: a corner that stands out by less is no obstacle

	// The velocity of a point of a body along n.
	double speedOf(const Body& b, const Place& at, Vector point, Vector n)
	{
		return n.x * (b.v[0] - b.v[2] * (point.y - at.y)) + n.y * (b.v[1] + b.v[2] * (point.x - at.x));
	}

} // namespace

void HiddenCorners::list(const World& world)
{
	if (world.listing != 0 && world.listing == listing && world.pairs.size() == pairs)
		return;
	listing = world.listing;
	pairs = world.pairs.size();
	near.clear();
	for (const Pair& pair : world.pairs)
		if (isBoundary(world.bodyOf(pair.a)))
			near.push_back({ pair.b, pair.a });
	std::sort(
	    near.begin(), near.end(), [](const Near& a, const Near& b) { return a.disk != b.disk ? a.disk < b.disk : a.boundary < b.boundary; });
}

bool HiddenCorners::isHidden(const World& world, const std::vector<Place>& places, const Pair& pair, double dt) const
{
	const Place &box = places[pair.a], &disk = places[pair.b];
	if (!isBoundary(box) || !isGuided(world.bodyOf(pair.a)) || !isBeyondCorner(world.shapes[pair.a], box, disk))
		return false;
	const Touch touch = locateContact(box, disk, world.shapes[pair.a]);
	const double distance = disk.radius - touch.overlap;
	const Vector corner { disk.x - distance * touch.nx, disk.y - distance * touch.ny };
	const auto first = std::lower_bound(near.begin(), near.end(), pair.b, [](const Near& n, int32_t body) { return n.disk < body; });
	return std::any_of(first, std::find_if(first, near.end(), [&](const Near& n) { return n.disk != pair.b; }), [&](const Near& n) {
		const Body& guide = world.bodyOf(n.boundary);
		const Place& other = places[n.boundary];
		const Shape& shape = world.shapes[n.boundary];
		if (n.boundary == pair.a || !isGuided(guide) || isBeyondCorner(shape, other, disk))
			return false;
		const Foot face = footOnBoundary(shape, other.turned, { disk.x - other.x, disk.y - other.y });
		const Vector normal { face.nx, face.ny };
		const double above = face.distance - dot(normal, { disk.x - corner.x, disk.y - corner.y });
		const double rise = dt * (speedOf(world.bodyOf(pair.a), box, corner, normal) - speedOf(guide, other, corner, normal));
		return above + std::max(rise, 0.) <= flush * disk.radius;
	});
}

} // namespace cd
