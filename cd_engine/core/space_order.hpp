// Numbers the bodies so that near numbers are near in space, which keeps what a sweep reads near in memory as well.
#pragma once

#include "world.hpp"

#include <vector>

namespace cd {

// What the order of the contacts is made from. It belongs to the state of a simulation: the order decides the last digits of a step.
struct SpaceOrder {
	std::vector<int>& rank; // of every body along the curve; the largest int: a boundary. Empty: the bodies' own numbers
	double& path; // length of the way through the disks in this order when it was made [m]
};

// Makes the order anew if there is none for so many bodies or, with `look`, if the way through the disks has become twice as long: about two
// diameters from disk to disk. A function of the bodies and of the order before, so a run goes on after it was saved as if it had not been.
// Scenes of few disks keep their own numbers. True if the order is another one now. About 100 ns a disk when made, 2 when looked at.
bool renewOrder(const World&, const SpaceOrder&, bool look);

} // namespace cd
