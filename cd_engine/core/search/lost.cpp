// Finds disks that have left the scene.
#include "search/pair_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {
namespace {

	double lengthOf(const double (&of)[2]) { return std::hypot(of[0], of[1]); }
	double lengthOf(const double (&of)[3]) { return std::hypot(of[0], of[1], of[2]); }
	double along(const Half& half, int axis) { return axis == 0 ? half.x : half.y; }
	double along(const Vector3& half, int axis) { return half[axis]; }

	// The smallest upright rectangle or box around some bodies.
	template <class Space> struct Extent {
		static constexpr int axes = Space::components;
		double low[axes], high[axes];

		Extent()
		{
			std::fill_n(low, axes, endless);
			std::fill_n(high, axes, -endless);
		}

		bool empty() const { return low[0] > high[0]; }
		double spread() const
		{
			double side[axes];
			for (int k = 0; k < axes; k++)
				side[k] = high[k] - low[k];
			return lengthOf(side);
		}

		// Ignores boundaries without an end.
		void add(const BodyOf<Space>& b, const ShapeOf<Space>& shape)
		{
			const auto half = halfSides(b, shape);
			const auto place = centreOf(b);
			for (int k = 0; k < axes; k++)
				if (std::isinf(along(half, k)))
					return;
			for (int k = 0; k < axes; k++) {
				low[k] = std::min(low[k], place[k] - along(half, k));
				high[k] = std::max(high[k], place[k] + along(half, k));
			}
		}

		// Whether a body is further away than the diagonal of the extent, moves away, and no force brings it back.
		bool leaves(const BodyOf<Space>& b) const
		{
			constexpr double far = 50; // of its radii; what is less far may be part of a small scene
			const auto place = centreOf(b);
			double away[axes], parts = 0, pulled = 0;
			for (int k = 0; k < axes; k++) {
				away[k] = place[k] - std::clamp(place[k], low[k], high[k]);
				parts += away[k] * b.v[k];
				pulled += away[k] * b.force[k];
			}
			return lengthOf(away) > std::max(spread(), far * b.radius) && parts > 0 && pulled >= 0;
		}
	};

	// Whether it belongs to the scene's outline: a boundary, or a disk that is held in its place.
	template <class Space> bool isOutline(const WorldOf<Space>& world, std::size_t i)
	{
		const double* const inverse = world.bodyOf(i).inverseMass;
		return world.shapes[i].kind != ShapeKind::disk || std::all_of(inverse, inverse + Space::components, [](double w) { return w == 0; });
	}

	// Whether a Wall, which has no end, lies where the force on a body leads, or its velocity if there is none.
	template <class Space> bool comesToWall(const WorldOf<Space>& world, const BodyOf<Space>& b)
	{
		const bool pushed = std::any_of(b.force, b.force + Space::components, [](double f) { return f != 0; });
		const double* const leads = pushed ? b.force : b.v;
		for (std::size_t i = 0; i < world.shapes.size(); i++) {
			const int k = world.shapes[i].axis;
			const double way = centreOf(world.bodyOf(i))[k] - centreOf(b)[k];
			if (world.shapes[i].kind == ShapeKind::wall && world.masks[i] != 0 && way * leads[k] > 0)
				return true;
		}
		return false;
	}

} // namespace

template <class Space> int leftBehind(const WorldOf<Space>& world, const std::vector<std::size_t>& some)
{
	assert(world.shapes.size() == world.bodies.size() && world.masks.size() == world.shapes.size());
	if (some.empty())
		return -1;
	const auto extentOf = [&world](auto belongs) {
		Extent<Space> extent;
		for (std::size_t i = 0; i < world.shapes.size(); i++)
			if (world.masks[i] != 0 && belongs(i)) // erased bodies have the mask 0
				extent.add(world.bodyOf(i), world.shapes[i]);
		return extent;
	};
	Extent<Space> scene = extentOf([&](std::size_t i) { return isOutline(world, i); });
	if (scene.empty())
		scene = extentOf([&](std::size_t i) { return std::find(some.begin(), some.end(), i) == some.end(); });
	if (scene.empty())
		return -1;
	scene = extentOf([&](std::size_t i) { return isOutline(world, i) || !scene.leaves(world.bodyOf(i)); });
	const auto isLost = [&](std::size_t i) { return scene.leaves(world.bodyOf(i)) && !comesToWall(world, world.bodyOf(i)); };
	const auto lost = std::find_if(some.begin(), some.end(), isLost);
	return lost == some.end() ? -1 : static_cast<int>(*lost);
}

template int leftBehind(const WorldOf<Plane>&, const std::vector<std::size_t>&);
template int leftBehind(const WorldOf<Space3>&, const std::vector<std::size_t>&);

} // namespace cd
