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

	uint64_t alongCurve(const uint32_t (&cell)[2]) { return alongCurve(cell[0], cell[1]); }
	// The same of 2^16 cells a side in space (Skilling 2004, Programming the Hilbert curve: axes to transpose, then its bits one after the
	// other).
	uint64_t alongCurve(const uint32_t (&of)[3])
	{
		uint32_t x[3] = { of[0], of[1], of[2] };
		constexpr uint32_t top = 1u << 15;
		for (uint32_t bit = top; bit > 1; bit /= 2)
			for (uint32_t& each : x)
				if (each & bit)
					x[0] ^= bit - 1;
				else {
					const uint32_t other = (x[0] ^ each) & (bit - 1);
					x[0] ^= other;
					each ^= other;
				}
		x[1] ^= x[0];
		x[2] ^= x[1];
		uint32_t turn = 0;
		for (uint32_t bit = top; bit > 1; bit /= 2)
			if (x[2] & bit)
				turn ^= bit - 1;
		uint64_t along = 0;
		for (uint32_t bit = top; bit > 0; bit /= 2)
			for (const uint32_t each : x)
				along = 2 * along + (((each ^ turn) & bit) != 0);
		return along;
	}

	// The disks in the order of the curve.
	template <class Space> std::vector<int> disksAlongCurve(const std::vector<BodyOf<Space>>& bodies)
	{
		constexpr int axes = Space::components;
		double low[axes], high[axes], size = 0;
		std::fill_n(low, axes, std::numeric_limits<double>::infinity());
		std::fill_n(high, axes, -std::numeric_limits<double>::infinity());
		for (const BodyOf<Space>& b : bodies)
			for (int k = 0; k < axes && !isBoundary(b); k++) {
				low[k] = std::min(low[k], centreOf(b)[k]);
				high[k] = std::max(high[k], centreOf(b)[k]);
			}
		for (int k = 0; k < axes; k++)
			size = std::max(size, high[k] - low[k]);
		const double scale = size > 0 ? 65535 / size : 0;
		std::vector<std::pair<uint64_t, int>> places;
		for (std::size_t i = 0; i < bodies.size(); i++) {
			if (isBoundary(bodies[i]))
				continue;
			uint32_t cell[axes];
			for (int k = 0; k < axes; k++)
				cell[k] = static_cast<uint32_t>(scale * (centreOf(bodies[i])[k] - low[k]));
			places.emplace_back(alongCurve(cell), static_cast<int>(i));
		}
		std::sort(places.begin(), places.end());
		std::vector<int> disks;
		for (const auto& place : places)
			disks.push_back(place.second);
		return disks;
	}

	template <class Body> double lengthOf(const std::vector<int>& way, const std::vector<Body>& bodies)
	{
		const auto centre = [&](std::size_t i) { return centreOf(bodies[way[i]]); };
		double sum = 0;
		for (std::size_t i = 1; i < way.size(); i++)
			sum += length(centre(i) - centre(i - 1));
		return sum;
	}

	// Length of the path through the disks in the order of their ranks. Disks that have become boundaries or were erased are left out. Infinite
	// if a rank is invalid, as in a damaged file.
	template <class Body> double lengthByRank(const std::vector<Body>& bodies, const std::vector<int>& rank)
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

template <class Space> bool renewOrder(const WorldOf<Space>& world, const SpaceOrder& order, bool checks)
{
	const std::vector<BodyOf<Space>>& bodies = world.bodies;
	if (bodies.size() <= fewDisks) {
		const bool had = !order.rank.empty();
		order.rank.clear();
		order.path = 0;
		return had;
	}
	if (order.rank.size() == bodies.size() && (!checks || lengthByRank(bodies, order.rank) <= 2 * order.path))
		return false;
	const std::vector<int> disks = disksAlongCurve<Space>(bodies);
	order.rank.assign(bodies.size(), none);
	for (std::size_t i = 0; i < disks.size(); i++)
		order.rank[disks[i]] = static_cast<int>(i);
	order.path = lengthOf(disks, bodies);
	return true;
}

template bool renewOrder(const WorldOf<Plane>&, const SpaceOrder&, bool);
template bool renewOrder(const WorldOf<Space3>&, const SpaceOrder&, bool);

} // namespace cd
