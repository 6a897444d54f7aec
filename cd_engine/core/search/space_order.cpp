#include "search/space_order.hpp"

#include <algorithm>
#include <limits>

namespace cd {
namespace {

	constexpr int none = std::numeric_limits<int>::max();

	// All that a sweep reads of so many disks fits into the second-level cache, whatever the order.
	constexpr int fewDisks = 2048;

	// The place of cell (x, y) of 2^16 x 2^16 on Hilbert's curve (Hilbert 1891): quadrant by quadrant, with axes that turn as the curve turns.
	uint32_t alongCurve(uint32_t x, uint32_t y)
	{
		uint32_t along = 0;
		for (uint32_t half = 1u << 15; half > 0; half /= 2) {
			const bool right = x & half, upper = y & half;
			along += half * half * ((3 * right) ^ upper);
			if (!upper) {
				if (right) {
					x = ~x;
					y = ~y;
				}
				std::swap(x, y);
			}
		}
		return along;
	}

	// The disks in the order of the curve.
	std::vector<int> disksAlongCurve(const std::vector<Body>& bodies)
	{
		double left = std::numeric_limits<double>::infinity(), bottom = left, right = -left, top = -left;
		for (const Body& b : bodies)
			if (!isBoundary(b)) {
				left = std::min(left, b.x);
				bottom = std::min(bottom, b.y);
				right = std::max(right, b.x);
				top = std::max(top, b.y);
			}
		const double size = std::max(right - left, top - bottom), scale = size > 0 ? 65535 / size : 0;
		const auto cell = [&](double from, double x) { return static_cast<uint32_t>(scale * (x - from)); };
		std::vector<std::pair<uint32_t, int>> places;
		for (std::size_t i = 0; i < bodies.size(); i++)
			if (!isBoundary(bodies[i]))
				places.emplace_back(alongCurve(cell(left, bodies[i].x), cell(bottom, bodies[i].y)), static_cast<int>(i));
		std::sort(places.begin(), places.end());
		std::vector<int> disks;
		for (const auto& place : places)
			disks.push_back(place.second);
		return disks;
	}

	double lengthOf(const std::vector<int>& way, const std::vector<Body>& bodies)
	{
		const auto centre = [&](std::size_t i) { return Vector { bodies[way[i]].x, bodies[way[i]].y }; };
		double sum = 0;
		for (std::size_t i = 1; i < way.size(); i++)
			sum += length(centre(i) - centre(i - 1));
		return sum;
	}

	// Length of the path through the disks in the order of their ranks. Disks that have become boundaries or were erased are left out. Infinite
	// if a rank is invalid, as in a damaged file.
	double lengthByRank(const std::vector<Body>& bodies, const std::vector<int>& rank)
	{
		std::vector<int> disks(bodies.size(), none);
		for (std::size_t i = 0; i < bodies.size(); i++) {
			if (isBoundary(bodies[i]) || rank[i] == none)
				continue;
			if (rank[i] < 0 || static_cast<std::size_t>(rank[i]) >= disks.size())
				return std::numeric_limits<double>::infinity();
			disks[rank[i]] = static_cast<int>(i);
		}
		disks.erase(std::remove(disks.begin(), disks.end(), none), disks.end());
		return lengthOf(disks, bodies);
	}

} // namespace

bool renewOrder(const World& world, const SpaceOrder& order, bool checks)
{
	const std::vector<Body>& bodies = world.bodies;
	if (bodies.size() <= fewDisks) {
		const bool had = !order.rank.empty();
		order.rank.clear();
		order.path = 0;
		return had;
	}
	if (order.rank.size() == bodies.size() && (!checks || lengthByRank(bodies, order.rank) <= 2 * order.path))
		return false;
	const std::vector<int> disks = disksAlongCurve(bodies);
	order.rank.assign(bodies.size(), none);
	for (std::size_t i = 0; i < disks.size(); i++)
		order.rank[disks[i]] = static_cast<int>(i);
	order.path = lengthOf(disks, bodies);
	return true;
}

} // namespace cd
