// Which contacts can be solved at once: groups of eight contacts that share no movable body and are near each other in the order given.
#pragma once

#include "group.hpp"

#include <cstddef>
#include <vector>

namespace cd {

struct Grouping {
	std::vector<int32_t> members; // Group::lanes a group: numbers of contacts, -1: the lane is empty
	std::vector<int32_t> loose; // contacts without a group
	std::size_t groups() const { return members.size() / Group::lanes; }
};

class GroupBuilder {
    public:
	// Forgets what was grouped before.
	void begin(std::size_t bodies, std::size_t contacts, Grouping& result);
	// Contacts must come in an order in which neighbours are near each other.
	void add(int32_t contact, int32_t a, bool movableA, int32_t b, bool movableB);
	// Closes all groups. A contact added later is in no group with an earlier one.
	void end();

    private:
	void retireOldest();

	// Open groups lie in a ring of so many places, of which one stays free. A contact goes to the oldest open group that has room, if neither
	// this group nor the groups next to it in the sweep contain its bodies. So no group waits for velocities that the last one has just written
	// (a third of the time).
	static constexpr int places = 64;
	// A group with fewer contacts costs more than solving them one by one.
	static constexpr int fewest = 3;

	struct OpenGroup {
		int count = 0;
		int32_t contacts[Group::lanes];
		int32_t bodies[2 * Group::lanes];
	};
	OpenGroup group[places];
	int oldest = 0;
	uint64_t withRoom = ~uint64_t(0);
	std::vector<uint64_t> has; // of every movable body: the places in the ring whose groups contain it, one bit a place
	Grouping* grouping = nullptr;
};

} // namespace cd
