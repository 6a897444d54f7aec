// Numbers the bodies so that bodies with near numbers are near in space. Data that a sweep reads together are then near in memory as well.
#pragma once

#include "scene/scene.hpp"

#include <vector>

namespace cd {

// Determines the order of the contacts. It belongs to the state of a simulation, because the order decides the last digits of a step.
struct SpaceOrder {
	std::vector<int>& rank; // of every body: its place along the curve; the largest int: a boundary. Empty: bodies keep their own numbers
	double& path; // length of the path through the disks in this order, when it was made [m]
};

// Makes the order anew if there is none for this number of bodies or, with `checks`, if the path through the disks is now twice as long: about two
// diameters from disk to disk. It depends only on the bodies and the order before, so a saved run continues as if it had not been saved. Scenes of
// few bodies keep their own numbers. Returns true if the order has changed. Costs about 100 ns a disk when made, 2 ns when only checked.
template <class Space> bool renewOrder(const WorldOf<Space>&, const SpaceOrder&, bool checks);

} // namespace cd
