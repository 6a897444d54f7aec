// Which contacts can be solved at once: groups of eight that do not influence each other and are near each other in the order given.
#pragma once

#include "base/base.hpp"
#include "problem/problem.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cd {

struct Grouping {
	std::vector<int32_t> members; // lanes a group: numbers of contacts, -1: the lane is empty
	std::vector<int32_t> loose; // contacts without a group
	std::size_t groups() const { return members.size() / lanes; }
};

// Fills groups. At most places - 1 are open at a time, in a ring. A contact goes to the oldest open group that has room, if neither this group nor
// the groups next to it in the sweep influence it. So no group has to wait for results that the group before it has just written; such waits would
// take a third of the time.
//
// Marks says who influences whom. It keeps a word for whatever contacts share, with a bit for every place in the ring: influences(item) has the bits
// of the groups that may not take an item, set() and clear() those of a group that has taken it.
template <class Marks> class GroupRing : Marks {
    public:
	using Item = typename Marks::Item; // has the number of a contact

	// Replaces what `result` holds. marks: what Marks is made from.
	template <class... Of>
	GroupRing(Grouping& result, Of&... marks)
	    : Marks { marks... }
	    , grouping(result)
	{
		grouping.members.clear();
		grouping.loose.clear();
	}

	// Contacts must come in an order in which neighbours are near each other.
	void add(const Item& item)
	{
		const uint64_t taken = Marks::influences(item);
		const uint64_t allowed = withRoom & ~(taken | rotateLeft(taken, 1) | rotateLeft(taken, -1));
		if (allowed == 0) { // a body or a row with very many contacts
			grouping.loose.push_back(item.contact);
			return;
		}
		const int slot = (oldest + __builtin_ctzll(rotateLeft(allowed, -oldest))) & (places - 1);
		OpenGroup& g = open[slot];
		g.items[g.count++] = item;
		Marks::set(item, bit(slot));
		if (g.count < lanes)
			return;
		withRoom &= ~bit(slot);
		while (!(withRoom & bit(oldest)))
			closeOldest();
	}

	// Closes all groups. A contact added later is in no group with an earlier one.
	void end()
	{
		for (int i = 0; i < places; i++) // the last pass only frees the place of the last closed group
			closeOldest();
	}

    private:
	static constexpr int places = 64;

	struct OpenGroup {
		int count = 0;
		Item items[lanes];
	};

	static uint64_t bit(int place) { return uint64_t(1) << place; }
	static uint64_t rotateLeft(uint64_t x, int by) { return x << (by & 63) | x >> (-by & 63); }

	// A closed group stays in its place until the next group is closed, because the next one must not contain what it influences.
	void closeOldest()
	{
		OpenGroup& done = open[oldest];
		const bool full = done.count >= Marks::fewest;
		for (int i = 0; i < done.count; i++)
			(full ? grouping.members : grouping.loose).push_back(done.items[i].contact);
		if (full)
			grouping.members.resize(grouping.members.size() + lanes - done.count, -1);
		const int previous = (oldest + places - 1) % places;
		for (int i = 0; i < open[previous].count; i++)
			Marks::clear(open[previous].items[i], bit(previous));
		open[previous].count = 0;
		withRoom = (withRoom | bit(previous)) & ~bit(oldest);
		oldest = (oldest + 1) % places;
	}

	OpenGroup open[places];
	int oldest = 0;
	uint64_t withRoom = ~bit(places - 1); // the place before the oldest stays free
	Grouping& grouping;
};

// For contacts between bodies: those that share a movable body influence each other.
struct BodyMarks {
	struct Item {
		int32_t contact, a, b; // its movable bodies; the same twice if only one can move
	};
	static constexpr int fewest = 3; // a group with fewer contacts costs more than solving them one by one

	uint64_t influences(const Item& c) const { return has[c.a] | has[c.b]; }
	void set(const Item& c, uint64_t bit)
	{
		has[c.a] |= bit;
		has[c.b] |= bit;
	}
	void clear(const Item& c, uint64_t bit)
	{
		has[c.a] &= ~bit;
		has[c.b] &= ~bit;
	}

	std::vector<uint64_t>& has; // of every body: the places of the groups that contain it; 0 at first
};
using BodyGroups = GroupRing<BodyMarks>;

// Groups of rows of W that do not couple and have about equally many blocks. Rows that are in no group follow, each in the first lane of a group of
// its own.
struct RowGrouping : Grouping {
	std::size_t firstSpread = 0; // from this group on, each group has one row

	void group(const DelassusSystem&);

    private:
	void sortWindow(const DelassusSystem&, std::size_t from, std::size_t to, bool descending);

	std::vector<uint64_t> has, coupled;
	std::vector<int32_t> sorted;
};

} // namespace cd
