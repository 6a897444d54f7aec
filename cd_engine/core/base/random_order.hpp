// A new random order of the contacts for every sweep. The same seed gives the same orders.
#pragma once

#include "base/workspace.hpp"

#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace cd {

class RandomOrder {
    public:
	// seed 0: no random order.
	RandomOrder(unsigned seed, Workspace* workspace)
	    : memory(workspace)
	    , random(seed)
	    , asked(seed > 0)
	{
		order.clear();
	}

	explicit operator bool() const { return asked; }

	// Calls work(from, to) for ranges that make up the numbers below `count`: once for all, or number by number in a random order. `count` must
	// be the same at every call.
	template <class Work> void visit(std::size_t count, const Work& work)
	{
		if (!asked)
			return work(std::size_t(0), count);
		while (order.size() < count)
			order.push_back(static_cast<int32_t>(order.size()));
		for (std::size_t i = count; i > 1; i--)
			std::swap(order[i - 1], order[random() % i]);
		for (const std::size_t i : order)
			work(i, i + 1);
	}

    private:
	Borrowed<std::vector<int32_t>, RandomOrder> memory;
	std::vector<int32_t>& order = *memory;
	std::mt19937_64 random;
	bool asked;
};

} // namespace cd
