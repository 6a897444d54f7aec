#include "graph/grouping.hpp"

#include <cassert>

namespace cd {
namespace {

	// Rows are sorted by length in windows of this size, ascending in one window and descending in the next. A group has as many slices as its
	// longest row has blocks, so rows of similar length leave few lanes empty.
	constexpr std::size_t window = 512;
	// A longer row is solved faster alone, with eight of its blocks in a slice.
	constexpr std::size_t longest = 16;

	struct RowMarks {
		struct Item {
			int32_t contact;
		};
		static constexpr int fewest = 2;

		// Calls f for all contacts that a row couples to, itself included.
		template <class F> void forEachCoupled(int32_t row, const F& f) const
		{
			for (std::size_t k = system.start[row]; k < system.start[row + 1]; k++)
				f(system.column[k]);
		}
		// Tests both directions, as W need not be symmetric.
		uint64_t influences(const Item& row) const
		{
			uint64_t taken = coupled[row.contact];
			forEachCoupled(row.contact, [&](int32_t other) { taken |= has[other]; });
			return taken;
		}
		void set(const Item& row, uint64_t bit)
		{
			has[row.contact] = bit;
			forEachCoupled(row.contact, [&](int32_t other) { coupled[other] |= bit; });
		}
		void clear(const Item& row, uint64_t bit)
		{
			has[row.contact] = 0;
			forEachCoupled(row.contact, [&](int32_t other) { coupled[other] &= ~bit; });
		}

		const DelassusSystem& system;
		std::vector<uint64_t>& has; // of each row: the place of the open group that contains it
		std::vector<uint64_t>& coupled; // of each row: the places of the open groups with a row coupled to it
	};

} // namespace

void RowGrouping::group(const DelassusSystem& s)
{
	assert(s.consistent());
	has.assign(s.contacts(), 0);
	coupled.assign(s.contacts(), 0);
	GroupRing<RowMarks> groups(*this, s, has, coupled);
	for (std::size_t from = 0; from < s.contacts(); from += window) {
		sortWindow(s, from, std::min(from + window, s.contacts()), from / window % 2 != 0);
		for (const int32_t row : sorted)
			if (s.others(row) > longest)
				loose.push_back(row);
			else
				groups.add({ row });
	}
	groups.end();
	firstSpread = this->groups();
	for (const int32_t row : loose) {
		members.push_back(row);
		members.resize(members.size() + lanes - 1, -1);
	}
}

// Counting sort; rows of the same length keep their order.
void RowGrouping::sortWindow(const DelassusSystem& s, std::size_t from, std::size_t to, bool descending)
{
	std::size_t first[longest + 2] = {};
	const auto key = [&](std::size_t row) {
		const std::size_t length = std::min(s.others(static_cast<int32_t>(row)), longest);
		return descending ? longest - length : length;
	};
	for (std::size_t row = from; row < to; row++)
		first[key(row) + 1]++;
	for (std::size_t i = 1; i < longest + 2; i++)
		first[i] += first[i - 1];
	sorted.resize(to - from);
	for (std::size_t row = from; row < to; row++)
		sorted[first[key(row)]++] = static_cast<int32_t>(row);
}

} // namespace cd
