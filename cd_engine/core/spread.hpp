// An order of pairs in which neighbours share no body.
#pragma once

#include "world.hpp"

namespace cd {

// Reorders `pairs` by taking, from a window sliding over the given order, the next pair whose bodies were not used just before:
// a sweep then waits less on the velocities it has itself just written, and keeps the locality of the given order.
// Deterministic; about 100 ns a pair, so for use when the list of pairs changes and not at every step.
// Returns the new order as indices into the old one.
std::vector<int32_t> spreadOrder(const std::vector<Pair>& pairs, std::size_t bodies);

} // namespace cd
