// Which contacts of a sphere with boundaries are none, because another boundary covers them: edges and corners inside a mesh or a floor of several
// boxes, and faces that lie in each other.
//
// A sphere touches an edge or a corner only if the direction to its centre lies in the normal cone of this feature in the mesh, which is the
// intersection of its normal cones in all boundaries that meet there: if and only if the point is the nearest one of each of them. So a contact is
// covered if its point lies on or behind another boundary that is nearer to the sphere. Flat and concave edges give no contact in this way, faces
// come first, and what several boundaries share counts once. No neighbours are looked up, so corners may be given twice, and may lie on edges.
// A sphere over one face meets the next one around a concave edge before the foot of its centre falls on it: there the plane of this facet goes on,
// below the face under the sphere. Else a sphere that moves by more than R (tan t - tan(t/2)) in a step, about half its radius times the angle t
// between the faces, would pass this place unseen and sink in.
// Only boundaries that no force moves take part, because where others are at the end of a step is known only when it is solved.
#pragma once

#include "scene/geometry_in_space.hpp"
#include "scene/world.hpp"

#include <algorithm>
#include <vector>

namespace cd {

// Where a sphere meets another body; nothing is known of the features of pairs of spheres.
struct SpaceMeeting {
	Vector3 n; // unit normal a -> b
	double overlap; // [m]
};

class HiddenFeatures {
    public:
	// Where the bodies are, half a step ahead, with their shapes as they stand there.
	struct Standing {
		const WorldOf<Space3>& world;
		const std::vector<SpacePlace>& places;
		const std::vector<SpaceShape>& shapes;
		const std::vector<SpaceMeeting>& meetings; // of the pairs
	};
	// Finds the spheres that are near boundaries, if the list of pairs is not that of the last call.
	void list(const WorldOf<Space3>&);
	// Whether the contact of a pair is covered during a step dt [s].
	bool isHidden(const Standing&, std::size_t pair, double dt) const;
	// Of a pair that is covered: whether its facet lies next, around a concave edge, to a face that covers it. Then `ahead` is how the sphere
	// meets the plane of the facet.
	bool meetsAhead(const Standing&, std::size_t pair, double dt, SpaceMeeting& ahead) const;
	// Calls visit(other) for each other pair of the same sphere and a boundary, until it returns true. Returns whether it did.
	template <class Visit> bool anyBeside(const WorldOf<Space3>& world, std::size_t pair, const Visit& visit) const
	{
		const int32_t sphere = world.pairs[pair].b;
		auto other = std::lower_bound(near.begin(), near.end(), sphere, [](const Near& n, int32_t b) { return n.sphere < b; });
		for (; other != near.end() && other->sphere == sphere; other++)
			if (static_cast<std::size_t>(other->pair) != pair && visit(static_cast<std::size_t>(other->pair)))
				return true;
		return false;
	}

    private:
	struct Near {
		int32_t sphere, pair;
	};
	bool covers(const Standing&, std::size_t other, std::size_t pair, double dt) const;
	// As anyBeside, for those that cover this one.
	template <class Visit> bool anyCovering(const Standing&, std::size_t pair, double dt, const Visit& visit) const;

	std::vector<Near> near; // sorted by the spheres
	long listing = 0; // World::listing of the last call
	std::size_t pairs = 0;
};

} // namespace cd
