// Finds disks that have left the scene.
#pragma once

#include "world.hpp"

#include <cstddef>
#include <vector>

namespace cd {

// The first of `some` bodies that has left all others but these behind, further than those are spread, and moves away, where nothing brings it
// back; -1: none. Costs a look at all bodies if there are any.
int leftBehind(const World&, const std::vector<std::size_t>& some);

} // namespace cd
