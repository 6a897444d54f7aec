// Finds disks that fly fast and far from all others. A "way" is the distance that a body goes in one step [m].
#pragma once

#include "world.hpp"

#include <utility>
#include <vector>

namespace cd {

// Half the sides of the box, parallel to the axes, around a body [m]; a Wall is endless along itself.
struct Half {
	double x, y;
};
Half halfSides(const Body&, const Shape&);

// Returns those of the eight fastest disks that can touch no other body in a step of dt. The fastest body sets how far apart two bodies may be and
// still be looked at as a possible contact. Disks that are alone do not count there (Body::alone, cd::reach): otherwise a single disk that falls out
// of the scene would make every step dearer than the last. Disks whose way is at most `slow` [m] are not examined. Costs one pass over all bodies for
// each disk that is alone, less for the others.
class FastAndAlone {
    public:
	const std::vector<int>& find(const World&, double dt, double slow);

    private:
	std::vector<std::pair<double, int>> fast; // by their ways [m]
	std::vector<int> alone, tried;
};

// The first of the bodies that are alone that has left the others behind, further than these are spread, and moves away, where nothing brings
// it back; -1: none.
int leftBehind(const World&, const std::vector<int>& alone);

} // namespace cd
