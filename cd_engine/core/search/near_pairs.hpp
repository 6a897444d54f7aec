// Broad phase of the collision detection: finds the pairs of bodies that are near each other, by a grid of square cells.
#pragma once

#include "scene/scene.hpp"

#include <cstdint>
#include <vector>

namespace cd {

struct NearPair {
	uint64_t key = 0; // position in the order of the sweeps (pair_order.hpp)
	int32_t a, b; // a: the boundary if there is one, else the body with the smaller number
	int32_t from = -1; // index of the same pair in another list; -1: none
};

// Each body has a bounding box, enlarged by its margin. In every row of cells that this box covers, the body is entered in its first cell, and
// compared with those that are entered in its cells after it; two bodies that share several rows are compared in the first. The cells are kept in a
// hash table with at least one slot an entry. Distant cells may share a slot, so one body far away costs nothing. Bodies that cover many cells are
// compared with all others.
class NearPairs {
    public:
	// Finds all pairs whose surfaces are at most the sum of their margins apart [m], except pairs of two boundaries. With boxes it also finds
	// some that are further apart. Bodies make no pair if their masks share no bit, or if both have one mask that is kept apart (World::apart).
	void find(const World&, const std::vector<double>& margins, std::vector<NearPair>& found);

    private:
	struct Box {
		double low[2], high[2];
		bool large = false; // not in the grid

		// All four comparisons in one branch, because the processor cannot predict the single ones.
		bool meets(const Box& o) const
		{
			return (low[0] <= o.high[0]) & (o.low[0] <= high[0]) & (low[1] <= o.high[1]) & (o.low[1] <= high[1]);
		}
	};
	struct Entry {
		Box box; // of the body
		int32_t row, firstRow, body;
		uint32_t place, lastPlace; // slots of the first and last cell of the box in this row
	};
	int32_t cellOf(double at, int axis) const;
	void enter(int32_t body);
	void sortByPlace();
	void compareInRows(const World&, const std::vector<double>& margins, std::vector<NearPair>& found) const;
	void compare(const World&, const std::vector<double>& margins, int32_t a, int32_t b, std::vector<NearPair>& found) const;

	double width = 0, origin[2] = { 0, 0 }; // of the cells [m]
	std::vector<double> sides, xs, ys; // of the disks, scratch
	std::vector<Box> boxes;
	std::vector<int32_t> large;
	std::vector<Entry> entries, sorted;
	std::vector<uint32_t> ends; // of each slot of the table: the end of its entries
};

} // namespace cd
