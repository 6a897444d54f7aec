#include "partition.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace cd {

int32_t Partition::root(int32_t body)
{
	while (name[body] != body)
		body = name[body] = name[name[body]];
	return body;
}

bool Partition::sameLinks(const ContactSystem& system, Threads* threads)
{
	const auto same = [threads](auto& of, const auto& all, const auto& now) { // and makes them so
		const bool known = of.size() == all.size();
		of.resize(all.size());
		const auto renew = [&](std::size_t from, std::size_t to) {
			bool same = known;
			for (std::size_t i = from; i < to; i++) {
				const auto one = now(all[i]);
				same = same && of[i] == one;
				of[i] = one;
			}
			return same;
		};
		return reduceRanges<bool>(threads, of.size(), renew, std::logical_and<bool>());
	};
	const bool bodies = same(freedom, system.bodies, [](const BodyVelocity& b) { return static_cast<uint8_t>(freedoms(b)); });
	return same(links, system.contacts, linkOf) && bodies;
}

bool Partition::update(const ContactSystem& system, Threads* threads)
{
	if (sameLinks(system, threads))
		return false;
	name.resize(freedom.size());
	std::iota(name.begin(), name.end(), 0);
	for (const Link& link : links)
		if (freedom[link.a] > 0 && freedom[link.b] > 0) {
			const int32_t a = root(link.a), b = root(link.b);
			name[std::max(a, b)] = std::min(a, b);
		}
	number();
	return true;
}

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
