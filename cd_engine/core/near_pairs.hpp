// Finds the pairs of bodies that are near each other, by a grid of square cells.
#pragma once

#include "world.hpp"

#include <cstdint>
#include <vector>

namespace cd {

struct NearPair {
	uint64_t key = 0; // its place in the order of the sweeps (pair_order.hpp)
	int32_t a, b; // the boundary first, or the smaller number
	int32_t from = -1; // place in a list that it is taken from
};

// Each body lies in a box, wider than itself by its margin, and stands in every cell that its box covers. Two bodies are compared in the first cell
// that they share. Cells are kept in a table of as many places as there are entries, which far cells share: one body far away costs nothing.
// Bodies that cover many cells are compared with all others.
class NearPairs {
    public:
	// All pairs, two boundaries excepted, whose surfaces are at most as far from each other as the sum of their margins [m]; of boxes also some
	// that are further. Bodies whose masks have no bit in common, or that are of one mask kept apart (World::apart), make no pair.
	void find(const World&, const std::vector<double>& margins, std::vector<NearPair>& found);

    private:
	struct Box {
		double low[2], high[2];
		int32_t first[2] = { 0, 0 }; // cell of its low corner
		bool large = false; // not in the grid
	};
	struct Entry {
		int32_t cell[2], body;
	};
	int32_t cellOf(double at, int axis) const;
	void enter(int32_t body);
	void sortByPlace();
	void compareInCells(const World&, const std::vector<double>& margins, std::vector<NearPair>& found) const;
	void compare(const World&, const std::vector<double>& margins, int32_t a, int32_t b, std::vector<NearPair>& found) const;

	double width = 0, origin[2] = { 0, 0 }; // of the cells [m]
	std::vector<double> sides, xs, ys; // of the disks, scratch
	std::vector<Box> boxes;
	std::vector<int32_t> large;
	std::vector<Entry> entries, sorted;
	std::vector<uint32_t> ends; // of the entries of each place of the table
};

} // namespace cd
