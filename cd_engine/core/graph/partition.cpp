#include "graph/partition.hpp"

#include <algorithm>
#include <cassert>
#include <functional>
#include <numeric>

namespace cd {

int32_t Partition::root(int32_t body)
{
	while (name[body] != body)
		body = name[body] = name[name[body]];
	return body;
}

namespace {

	// Whether `of` holds what now(i) says of all; makes it so.
	template <class Of, class Now> bool renew(Of& of, std::size_t count, const Now& now, Threads* threads)
	{
		const bool known = of.size() == count;
		of.resize(count);
		const auto compare = [&](std::size_t from, std::size_t to) {
			bool same = known;
			for (std::size_t i = from; i < to; i++) {
				const auto one = now(i);
				if (of[i] == one)
					continue;
				same = false;
				of[i] = one;
			}
			return same;
		};
		return reduceRanges<bool>(threads, of.size(), compare, std::logical_and<bool>());
	}

} // namespace

template <class Space> bool Partition::sameLinks(const ContactSystem<Space>& system, Threads* threads)
{
	if (knows(system))
		return true;
	const bool same = renew(
	    links, system.contacts.size(), [&](std::size_t i) { return linkOf(system.contacts[i]); }, threads);
	// A contact that could not be solved may be solvable the next time.
	contactSet = anyOf(threads, links.size(), [&](std::size_t i) { return !links[i].solvable; }) ? 0 : system.contactSet;
	return same;
}

template <class Space> bool Partition::update(const ContactSystem<Space>& system, Threads* threads)
{
	assert(knows(system) || system.consistent());
	const auto count = [&](std::size_t i) { return static_cast<uint8_t>(system.isStill(i) ? 0 : freedoms(system.bodies[i])); };
	const bool bodies = renew(freedom, system.bodies.size(), count, threads);
	const bool contacts = sameLinks(system, threads);
	if (bodies && contacts)
		return false;
	name.resize(freedom.size());
	std::iota(name.begin(), name.end(), 0);
	for (const Link& link : links)
		if (link.solvable && freedom[link.a] > 0 && freedom[link.b] > 0) {
			const int32_t a = root(link.a), b = root(link.b);
			name[std::max(a, b)] = std::min(a, b);
		}
	number();
	return true;
}

template bool Partition::update(const ContactSystem<Plane>&, Threads*);
template bool Partition::update(const ContactSystem<RollingPlane>&, Threads*);
template bool Partition::update(const ContactSystem<Space3>&, Threads*);

void Partition::number()
{
	ofBody.assign(name.size(), -1);
	ofContact.resize(links.size());
	islands.clear();
	for (std::size_t i = 0; i < links.size(); i++) {
		ofContact[i] = -1;
		if (!links[i].solvable)
			continue;
		int32_t& island = ofBody[root(mobileOf(links[i]))];
		if (island < 0) {
			island = static_cast<int32_t>(islands.size());
			islands.push_back({ static_cast<int32_t>(i), 0 });
		}
		ofContact[i] = island;
		islands[island].contacts++;
	}
	// The body that names an island comes first in it, so its entries are final before the other bodies copy them.
	for (std::size_t i = 0; i < name.size(); i++) {
		name[i] = name[name[i]];
		ofBody[i] = ofBody[name[i]];
	}
}

} // namespace cd
