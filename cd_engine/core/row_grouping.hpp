// Which rows of W can be solved at once: groups of eight rows that do not couple, have about equally many blocks, and are near in the order given.
#pragma once

#include "delassus_system.hpp"
#include "row_group.hpp"

namespace cd {

struct RowGrouping {
	std::vector<int32_t> members; // RowGroup::lanes a group: rows of the system; -1: the lane is empty
	std::size_t firstSpread = 0; // from this group on, each group has one row, in its first lane
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
	// Calls f for all contacts that a row couples to, itself included.
	template <class F> void forEachCoupled(int32_t row, F&& f) const
	{
		for (std::size_t k = system->start[row]; k < system->start[row + 1]; k++)
			f(system->column[k]);
	}

	// Rows are sorted by length in windows of this size, ascending in one window and descending in the next. A group has as many slices as its
	// longest row has blocks, so rows of similar length leave few lanes empty.
	static constexpr std::size_t window = 512;
	// A longer row is solved faster alone, with eight of its blocks in a slice.
	static constexpr std::size_t longest = 16;
	// At most places - 1 groups are open at a time. A row goes to the oldest open group that has room, if neither this group nor the groups next
	// to it in the sweep contain a row coupled to it. So no group waits for impulses that the last one has just written.
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
	std::vector<uint64_t> has; // of each row: the place of the open group that contains it, as a bit
	std::vector<uint64_t> coupled; // of each row: the places of the open groups with a row coupled to it, one bit a place
	std::vector<int32_t> sorted, spread;
};

} // namespace cd
