// The order in which the contacts of pairs are swept.
#pragma once

#include "near_pairs.hpp"

#include <vector>

namespace cd {

// The place of a pair is a function of its numbers and ranks alone, so the result of a step does not depend on which other pairs are listed.
class PairOrder {
    public:
	// rank: of the bodies along the curve (space_order.hpp); empty: their numbers.
	void sort(std::vector<NearPair>&, const std::vector<int>& rank);

    private:
	std::vector<NearPair> sorted;
	std::vector<std::size_t> begins, next; // of blocks
};

// Sets `from` of every pair in `now` to its place in `before`, or to -1. Both are sorted by the same ranks. left: the places of
// those in `before` that are in `now` no longer.
void findAgain(std::vector<NearPair>& now, const std::vector<NearPair>& before, std::vector<int32_t>& left);

} // namespace cd
