#include "spread.hpp"

#include <algorithm>
#include <numeric>

namespace cd {

std::vector<int32_t> spreadOrder(const std::vector<Pair>& pairs, size_t bodies)
{
	constexpr int window = 64; // pairs looked at; wider windows cost locality and gained nothing
	constexpr int apart  = 8;  // pairs between two uses of a body that hide its latency

	std::vector<int32_t> order, waiting, lastUse(bodies, -apart - 1);
	order.reserve(pairs.size());
	size_t next = 0;
	while (order.size() < pairs.size()) {
		while (waiting.size() < window && next < pairs.size())
			waiting.push_back(static_cast<int32_t>(next++));
		const int now = static_cast<int>(order.size());
		size_t    best = 0;
		int       bestAge = -1;
		for (size_t i = 0; i < waiting.size(); i++) {
			const Pair& p   = pairs[waiting[i]];
			const int   age = now - std::max(lastUse[p.a], lastUse[p.b]);
			if (age <= bestAge) continue;
			bestAge = age;
			best    = i;
			if (age > apart) break;
		}
		const int32_t chosen = waiting[best];
		lastUse[pairs[chosen].a] = lastUse[pairs[chosen].b] = now;
		order.push_back(chosen);
		waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(best));
	}
	return order;
}

} // namespace cd
