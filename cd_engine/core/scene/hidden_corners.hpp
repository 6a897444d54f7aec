// Corners of boxes that a disk cannot reach, because they lie on or behind the face of another boundary that the disk is over: those at the joints of
// a floor of several boxes, or inside a wall. A contact is the plane through the nearest point, so such a corner would act as an obstacle before the
// disk is above it: a disk would hop and lose speed at every joint. The face keeps the disk in front of all points behind it. Only corners of
// boundaries that no force moves are hidden, because where other boundaries are at the end of a step is known only when it is solved.
#pragma once

#include "scene/contact_geometry.hpp"
#include "scene/world.hpp"

#include <vector>

namespace cd {

class HiddenCorners {
    public:
	// Finds the disks that are near boundaries, if the list of pairs is not that of the last call.
	void list(const World&);
	// Whether the corner of box pair.a that is nearest to disk pair.b is hidden during a step dt [s]. False over a face. places: of the bodies,
	// half a step ahead; the contact law holds at those a whole step later.
	bool isHidden(const World&, const std::vector<Place>& places, const Pair&, double dt) const;

    private:
	struct Near {
		int32_t disk, boundary;
	};
	std::vector<Near> near; // sorted by the disks
	long listing = 0; // World::listing of the last call
	std::size_t pairs = 0;
};

} // namespace cd
