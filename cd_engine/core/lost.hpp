// Finds disks that have left the scene.
#pragma once

#include "world.hpp"

#include <cstddef>
#include <vector>

namespace cd {

// The first of the bodies `some` that has left all bodies but `some` behind: it is further from them than they are spread, moves away, and no force
// brings it back. -1: none. Looks at all bodies if `some` is not empty.
int leftBehind(const World&, const std::vector<std::size_t>& some);

} // namespace cd
