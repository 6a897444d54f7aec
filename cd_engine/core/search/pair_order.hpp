// The order in which the contacts of pairs are swept.
#pragma once

#include "search/near_pairs.hpp"

#include <vector>

namespace cd {

// Sorts pairs. The position of a pair depends only on its numbers and ranks, so the result of a step does not depend on which other pairs are listed.
// rank: of the bodies along the space-filling curve (space_order.hpp); empty: the numbers of the bodies are their ranks.
void sortPairs(std::vector<NearPair>&, const std::vector<int>& rank);

// Both lists are sorted by the same ranks. from: of every pair in `now` its index in `before`, or -1. left: the indices of the pairs in `before` that
// `now` no longer contains.
void findAgain(const std::vector<NearPair>& now, const std::vector<NearPair>& before, std::vector<int32_t>& from, std::vector<int32_t>& left);

} // namespace cd
