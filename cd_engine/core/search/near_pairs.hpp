// Broad phase of the collision detection: finds the pairs of bodies that are near each other, by a grid of square or cubic cells.
#pragma once

#include "scene/scene.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace cd {

// What is sorted: a pair before it has its place in World::pairs.
struct NearPair {
	uint64_t key; // position in the order of the sweeps (pair_order.hpp)
	int32_t a, b; // a: the boundary if there is one, else the smaller number
};

// Each shape has a bounding box, enlarged by its margin. In every row of cells along x that this box covers, the shape is entered in its first cell,
// and compared with those that are entered in its cells after it; two that share several rows are compared in the first. The cells are kept in a hash
// table with at least one slot an entry. Distant cells may share a slot, so one far away costs nothing. Shapes that cover many cells are compared
// with all others.
template <class Space> class NearPairsOf {
	using World = WorldOf<Space>;
	static constexpr int axes = Space::components;

    public:
	// Finds all pairs whose surfaces are at most the sum of their margins apart [m], except pairs of two boundaries. With boxes it also finds
	// some that are further apart. Two make no pair if their masks share no bit, or if both have one mask that is kept apart (World::apart).
	void find(const World&, const std::vector<double>& margins, std::vector<NearPair>& found);

    private:
	struct Box {
		double low[axes], high[axes];
		bool large = false; // not in the grid

		// All comparisons in one branch, because the processor cannot predict the single ones.
		bool meets(const Box& o) const
		{
			bool meets = true;
			for (int k = 0; k < axes; k++)
				meets &= (low[k] <= o.high[k]) & (o.low[k] <= high[k]);
			return meets;
		}
	};
	struct Entry {
		Box box;
		int32_t row[axes - 1], firstRow[axes - 1], shape; // the cells' numbers along y, and along z
		uint32_t place, lastPlace; // slots of the first and last cell of the box in this row
	};
	// Whether it is the first row that both shapes share.
	static bool sharesFirst(const Entry& p, const Entry& q)
	{
		bool first = true;
		for (int k = 0; k < axes - 1; k++)
			first &= (q.row[k] == p.row[k]) & (std::max(p.firstRow[k], q.firstRow[k]) == p.row[k]);
		return first;
	}
	int32_t cellOf(double at, int axis) const;
	void enter(int32_t shape);
	void sortByPlace();
	void compareInRows(const World&, const std::vector<double>& margins, std::vector<NearPair>& found) const;
	void compare(const World&, const std::vector<double>& margins, int32_t a, int32_t b, std::vector<NearPair>& found) const;

	double width = 0, origin[axes] = {}; // of the cells [m]
	std::vector<double> sides, coordinates[axes]; // of the disks, scratch
	std::vector<Box> boxes;
	std::vector<int32_t> order; // shapes as they are entered: of bodies, then of boundaries
	std::vector<int32_t> large;
	std::vector<Entry> entries, sorted;
	std::vector<uint32_t> ends; // of each slot of the table: the end of its entries
};

using NearPairs = NearPairsOf<Plane>;

} // namespace cd
