// Bodies that fly fast, far from all others.
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

// Of the eight fastest disks those that nobody can touch in a step of dt. Such a one need not set how far contacts reach for everybody (cd::reach
// leaves out what Body::alone says): else one body that falls for ever makes every step dearer than the last. slow: ways [m] up to which a disk is
// none of these. Costs one look at all bodies for each of them that is alone, less for the others.
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
