// Finds disks that have left the scene.
#pragma once

#include "world.hpp"

#include <cstddef>
#include <vector>

namespace cd {

// The first of the bodies `some` that has left the scene: it is further from it than it is wide, moves away, and neither a force nor a Wall brings it
// back. -1: none. The scene is the boundaries, fixed disks among them, and the disks that do not leave these; without boundaries of finite size, all
// bodies but `some`. So a whole group that leaves is noticed. Looks at all bodies if `some` is not empty.
int leftBehind(const World&, const std::vector<std::size_t>& some);

} // namespace cd
