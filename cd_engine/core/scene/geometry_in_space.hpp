// Where two shapes touch in space.
#pragma once

#include "scene/contact_geometry.hpp"
#include "scene/shape_in_space.hpp"

namespace cd {

struct SpaceTouch {
	Vector3 n; // unit normal a -> b
	Vector3 c; // contact point, midway between the surfaces [m]
	double overlap; // geometric overlap [m], negative: apart
};

// The point of a boundary's surface nearest to a sphere's centre.
struct SpaceFoot {
	Vector3 n; // outward
	double distance; // of the centre from the surface, negative inside [m]
	bool feature; // the point is on an edge or a corner
};

// centre: that of the sphere, from the position of the boundary [m].
SpaceFoot footOnBoundary(const SpaceShape&, const Vector3& centre);

inline SpaceTouch touchAt(const Vector3& n, double gap, const SpacePlace& sphere) { return { n, sphere.at - (sphere.radius + 0.5 * gap) * n, -gap }; }

// `shape` is the shape of `a` as it stands at its place. It is read only if `a` is a boundary.
inline SpaceFoot locateFoot(const SpacePlace& a, const SpacePlace& b, const SpaceShape& shape)
{
	const Vector3 d = b.at - a.at;
	if (isBoundary(a))
		return footOnBoundary(shape, d);
	const double centres = length(d);
	return centres > 0 ? SpaceFoot { 1 / centres * d, centres - a.radius, false } : SpaceFoot { { 1, 0, 0 }, -a.radius, false };
}
inline SpaceTouch locateContact(const SpacePlace& a, const SpacePlace& b, const SpaceShape& shape)
{
	const SpaceFoot foot = locateFoot(a, b, shape);
	return touchAt(foot.n, foot.distance - b.radius, b);
}

// Of a facet whose point nearest to a sphere's centre lies on an edge, not at a corner: this point, and the foot on the facet's plane beyond the
// edge. Returns whether it is so. centre: as above.
bool footBeyondEdge(const SpaceShape& facet, const Vector3& centre, Vector3& nearest, SpaceFoot& foot);

// Whether the centre of a sphere came through a face on its way to where it is now, and if so, through which. before, now: the sphere from the
// boundary; was, shape: the boundary.
bool comesThrough(const SpaceShape& was, const Vector3& before, const SpaceShape& shape, const Vector3& now, SpaceFoot& face);

} // namespace cd
