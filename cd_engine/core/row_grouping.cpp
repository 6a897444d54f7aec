#include "row_grouping.hpp"

#include <algorithm>

namespace cd {
namespace {

	uint64_t rotateLeft(uint64_t x, int by) { return x << (by & 63) | x >> (-by & 63); }

} // namespace

void RowGroupBuilder::build(const DelassusSystem& s, RowGrouping& result)
{
	system = &s;
	grouping = &result;
	result.members.clear();
	spread.clear();
	has.assign(s.contacts(), 0);
	coupled.assign(s.contacts(), 0);
	for (OpenGroup& g : group)
		g.count = 0;
	oldest = 0;
	withRoom = ~uint64_t(0) >> 1; // the last place is reserved for the group before the oldest
	for (std::size_t from = 0; from < s.contacts(); from += window) {
		sortWindow(from, std::min(from + window, s.contacts()), from / window % 2 != 0);
		for (const int32_t row : sorted)
			add(row);
	}
	for (int i = 0; i < places - 1; i++)
		retireOldest();
	result.firstSpread = result.groups();
	for (const int32_t row : spread) {
		result.members.push_back(row);
		result.members.insert(result.members.end(), RowGroup::lanes - 1, -1);
	}
}

// Counting sort; rows of the same length keep their order.
void RowGroupBuilder::sortWindow(std::size_t from, std::size_t to, bool descending)
{
	std::size_t first[longest + 2] = {};
	const auto key = [&](std::size_t row) {
		const std::size_t length = std::min(others(static_cast<int32_t>(row)), longest);
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

void RowGroupBuilder::add(int32_t row)
{
	// Tests both directions, as W need not be symmetric.
	uint64_t taken = coupled[row];
	forEachCoupled(row, [&](int32_t other) { taken |= has[other]; });
	const uint64_t allowed = withRoom & ~(taken | rotateLeft(taken, 1) | rotateLeft(taken, -1));
	if (others(row) > longest || allowed == 0) {
		spread.push_back(row);
		return;
	}
	const int slot = (oldest + __builtin_ctzll(rotateLeft(allowed, -oldest))) & (places - 1);
	const uint64_t bit = uint64_t(1) << slot;
	OpenGroup& g = group[slot];
	g.rows[g.count] = row;
	has[row] = bit;
	forEachCoupled(row, [&](int32_t other) { coupled[other] |= bit; });
	if (++g.count < RowGroup::lanes)
		return;
	withRoom &= ~bit;
	while (!(withRoom >> oldest & 1))
		retireOldest();
}

// A closed group stays in its place until the next group is closed, because the next one must not contain rows coupled to it.
void RowGroupBuilder::retireOldest()
{
	OpenGroup& done = group[oldest];
	if (done.count > 1) {
		std::fill(done.rows + done.count, done.rows + RowGroup::lanes, -1);
		grouping->members.insert(grouping->members.end(), done.rows, done.rows + RowGroup::lanes);
	} else
		spread.insert(spread.end(), done.rows, done.rows + done.count);
	const int previous = (oldest + places - 1) % places;
	const uint64_t bit = uint64_t(1) << previous;
	for (int i = 0; i < group[previous].count; i++) {
		has[group[previous].rows[i]] = 0;
		forEachCoupled(group[previous].rows[i], [&](int32_t other) { coupled[other] &= ~bit; });
	}
	group[previous].count = 0;
	withRoom = (withRoom | bit) & ~(uint64_t(1) << oldest);
	oldest = (oldest + 1) % places;
}

} // namespace cd
