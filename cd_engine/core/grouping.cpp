#include "grouping.hpp"

#include <algorithm>

namespace cd {
namespace {

	uint64_t rotateLeft(uint64_t x, int by) { return x << (by & 63) | x >> (-by & 63); }

} // namespace

void GroupBuilder::begin(std::size_t bodies, std::size_t contacts, Grouping& result)
{
	has.assign(bodies, 0);
	for (OpenGroup& g : group)
		g.count = 0;
	oldest = 0;
	withRoom = ~uint64_t(0) >> 1; // the last place is reserved for the group before the oldest
	grouping = &result;
	result.members.clear();
	result.members.reserve(contacts + contacts / 8);
	result.loose.clear();
}

void GroupBuilder::add(int32_t contact, int32_t a, bool movableA, int32_t b, bool movableB)
{
	const uint64_t taken = has[a] | has[b];
	const uint64_t allowed = withRoom & ~(taken | rotateLeft(taken, 1) | rotateLeft(taken, -1));
	if (allowed == 0) { // one of the bodies has very many contacts
		grouping->loose.push_back(contact);
		return;
	}
	const int slot = (oldest + __builtin_ctzll(rotateLeft(allowed, -oldest))) & (places - 1);
	const uint64_t bit = uint64_t(1) << slot;
	OpenGroup& g = group[slot];
	g.contacts[g.count] = contact;
	g.bodies[2 * g.count] = a;
	g.bodies[2 * g.count + 1] = b;
	has[a] |= movableA ? bit : 0;
	has[b] |= movableB ? bit : 0;
	if (++g.count < Group::lanes)
		return;
	withRoom &= ~bit;
	while (!(withRoom >> oldest & 1))
		retireOldest();
}

// A closed group stays in its place until the next group is closed, because the next one must not contain its bodies.
void GroupBuilder::retireOldest()
{
	OpenGroup& done = group[oldest];
	if (done.count >= fewest) {
		std::fill(done.contacts + done.count, done.contacts + Group::lanes, -1);
		grouping->members.insert(grouping->members.end(), done.contacts, done.contacts + Group::lanes);
	} else
		grouping->loose.insert(grouping->loose.end(), done.contacts, done.contacts + done.count);
	const int previous = (oldest + places - 1) % places;
	const uint64_t bit = uint64_t(1) << previous;
	for (int i = 0; i < 2 * group[previous].count; i++)
		has[group[previous].bodies[i]] &= ~bit;
	group[previous].count = 0;
	withRoom = (withRoom | bit) & ~(uint64_t(1) << oldest);
	oldest = (oldest + 1) % places;
}

void GroupBuilder::end()
{
	for (int i = 0; i < places; i++) // the last pass only frees the place of the last closed group
		retireOldest();
}

} // namespace cd
