// Finds disks that have left the scene.
#include "search/pair_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {
namespace {

	// The smallest upright rectangle around some bodies.
	struct Extent {
		double low[Plane::components] = { endless, endless }, high[Plane::components] = { -endless, -endless };

		bool empty() const { return low[0] > high[0]; }
		double spread() const { return std::hypot(high[0] - low[0], high[1] - low[1]); }

		// Ignores boundaries without an end.
		void add(const Body& b, const Shape& shape)
		{
			const Half half = halfSides(b, shape);
			if (std::isinf(half.x) || std::isinf(half.y))
				return;
			const double place[] = { b.x, b.y }, side[] = { half.x, half.y };
			for (int k = 0; k < Plane::components; k++) {
				low[k] = std::min(low[k], place[k] - side[k]);
				high[k] = std::max(high[k], place[k] + side[k]);
			}
		}

		// Whether a body is further away than the diagonal of the extent, moves away, and no force brings it back.
		bool leaves(const Body& b) const
		{
			constexpr double far = 50; // of its radii; what is less far may be part of a small scene
			const double dx = b.x - std::clamp(b.x, low[0], high[0]), dy = b.y - std::clamp(b.y, low[1], high[1]);
			return std::hypot(dx, dy) > std::max(spread(), far * b.radius) && dx * b.v[0] + dy * b.v[1] > 0
			    && dx * b.force[0] + dy * b.force[1] >= 0;
		}
	};

	// Whether it belongs to the scene's outline: a boundary, or a disk that is held in its place.
	bool isOutline(const World& world, std::size_t i)
	{
		const double* const inverse = world.bodyOf(i).inverseMass;
		return world.shapes[i].kind != ShapeKind::disk || (inverse[0] == 0 && inverse[1] == 0);
	}

	// Whether a Wall, which has no end, lies where the force on a body leads, or its velocity if there is none.
	bool comesToWall(const World& world, const Body& b)
	{
		const double* const leads = b.force[0] != 0 || b.force[1] != 0 ? b.force : b.v;
		for (std::size_t i = 0; i < world.shapes.size(); i++) {
			const int k = world.shapes[i].axis;
			const double way = k == 0 ? world.bodyOf(i).x - b.x : world.bodyOf(i).y - b.y;
			if (world.shapes[i].kind == ShapeKind::wall && world.masks[i] != 0 && way * leads[k] > 0)
				return true;
		}
		return false;
	}

} // namespace

int leftBehind(const World& world, const std::vector<std::size_t>& some)
{
	assert(world.shapes.size() == world.bodies.size() && world.masks.size() == world.shapes.size());
	if (some.empty())
		return -1;
	const auto extentOf = [&world](auto belongs) {
		Extent extent;
		for (std::size_t i = 0; i < world.shapes.size(); i++)
			if (world.masks[i] != 0 && belongs(i)) // erased bodies have the mask 0
				extent.add(world.bodyOf(i), world.shapes[i]);
		return extent;
	};
	Extent scene = extentOf([&](std::size_t i) { return isOutline(world, i); });
	if (scene.empty())
		scene = extentOf([&](std::size_t i) { return std::find(some.begin(), some.end(), i) == some.end(); });
	if (scene.empty())
		return -1;
	scene = extentOf([&](std::size_t i) { return isOutline(world, i) || !scene.leaves(world.bodyOf(i)); });
	const auto isLost = [&](std::size_t i) { return scene.leaves(world.bodyOf(i)) && !comesToWall(world, world.bodyOf(i)); };
	const auto lost = std::find_if(some.begin(), some.end(), isLost);
	return lost == some.end() ? -1 : static_cast<int>(*lost);
}

} // namespace cd
