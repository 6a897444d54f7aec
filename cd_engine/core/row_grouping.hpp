// Which rows of W can be solved at once: groups of eight that do not couple, of about as many blocks, near each other in the order given.
#pragma once

#include "delassus_system.hpp"
#include "row_group.hpp"

namespace cd {

struct RowGrouping {
	std::vector<int32_t> members; // RowGroup::lanes a group: rows of the system, -1: the lane is empty
	std::size_t firstSpread = 0; // the groups from here on have one row each, in their first lane
	std::size_t groups() const { return members.size() / RowGroup::lanes; }
};

class RowGroupBuilder {
    public:
	void build(const DelassusSystem&, RowGrouping& result);

    private:
	void sortWindow(std::size_t from, std::size_t to, bool descending);
	void add(int32_t row);
	void retireOldest();

	std::size_t others(int32_t row) const { return system->start[row + 1] - system->start[row] - 1; }
	// All contacts that a row couples to; itself among them.
	template <class F> void forEachCoupled(int32_t row, F&& f) const
	{
		for (std::size_t k = system->start[row]; k < system->start[row + 1]; k++)
			f(system->column[k]);
	}

	// Rows are taken in windows of so many, the short before the long and in the next one the long before the short: a group has as many
	// slices as its longest row has blocks, and few of them are left empty.
	static constexpr std::size_t window = 512;
	// A row with more blocks is better off alone, with eight of them in a slice.
	static constexpr std::size_t longest = 16;
	// So many groups less one are open at a time: a row goes to the oldest with room that has none it couples to, and whose neighbours in the
	// order of the sweep have none, so that no group waits for impulses the last one has just written.
	static constexpr int places = 64;

	struct OpenGroup {
		int count = 0;
		int32_t rows[RowGroup::lanes];
	};
	const DelassusSystem* system = nullptr;
	RowGrouping* grouping = nullptr;
	OpenGroup group[places];
	int oldest = 0;
	uint64_t withRoom = 0;
	std::vector<uint64_t> has; // of each row: the place of the open group that has it
	std::vector<uint64_t> coupled; // of each row: the places of the open groups with a row that couples to it
	std::vector<int32_t> sorted, spread;
};

} // namespace cd
