// What every body must be, in the plane and in space. Refuses what it cannot be.
#pragma once

#include "kind.hpp"
#include "scene_link.hpp"

#include <cmath>
#include <optional>

namespace cd_engine {

// Whether both refer to the same body. A new body may get the address of an old one, but not its reference count, which exists as long as the
// old body is remembered here.
inline bool isSame(const boost::weak_ptr<yade::Body>& known, const Shared<yade::Body>& now)
{
	return !known.owner_before(now) && !now.owner_before(known);
}

inline void mustBeFinite(int id, const char* what, const Vector3r& v)
{
	if (!((v[0] * 0 + v[1] * 0 + v[2] * 0) == 0)) // one test: a product with 0 is 0 unless a factor is infinite or NaN
		refuseBody(id, text("has ", what, " that is not a number"), "Look for what set O.bodies[#] to it, or for a failed step before");
}

inline void mustBeFinite(int id, const Vector3r& position, const Vector3r& velocity, const Vector3r& spin)
{
	mustBeFinite(id, "a position", position);
	mustBeFinite(id, "a velocity", velocity);
	mustBeFinite(id, "an angular velocity", spin);
}

inline double radiusOf(int id, void* shape)
{
	const double radius = sphere_radius(shape);
	if (!(radius > 0 && std::isfinite(radius)))
		refuseBody(id, text("has the radius ", radius, " m"), "Set O.bodies[#].shape.radius to a positive number");
	return radius;
}
inline const Vector3r& extentsOf(int id, void* shape)
{
	const Vector3r& extents = box_extents(shape);
	if (!extents.allFinite() || extents[0] < 0 || extents[1] < 0 || extents[2] < 0)
		refuseBody(id, text("is a box with the extents ", extents[0], ", ", extents[1], ", ", extents[2], " m"),
		    "Set O.bodies[#].shape.extents, the halves of its edges, to numbers that are not negative");
	return extents;
}
inline int senseOf(int id, void* shape)
{
	const int sense = wall_sense(shape);
	if (sense < -1 || sense > 1)
		refuseBody(id, text("is a wall with the sense ", sense), "Set O.bodies[#].shape.sense to -1, 0 or 1");
	return sense;
}
inline void mustMove(int id, double mass)
{
	if (!(mass > 0 && std::isfinite(mass)))
		refuseBody(id, text("is free to move but has the mass ", mass, " kg"),
		    "Set O.bodies[#].state.mass, or block its degrees of freedom (state.blockedDOFs)");
}
inline void mustTurn(int id, double inertia, char about, char blocks)
{
	if (!(inertia > 0 && std::isfinite(inertia)))
		refuseBody(id, text("is free to turn but has the moment of inertia ", inertia, " kg m^2 about ", about),
		    text("Set O.bodies[#].state.inertia, or block '", blocks, "'"));
}

// What acts on a body before the next step. O.forces still holds what the last step left, its contact forces included; a ForceResetter clears
// that. Without permanent forces YADE reads past the end of its list.
inline void readPermanentForce(int id, Vector3r& force, Vector3r& torque)
{
	const py::object lasting = py::import("yade").attr("O").attr("forces");
	const bool any = py::extract<bool>(lasting.attr("getPermForceUsed")());
	force = any ? py::extract<Vector3r>(lasting.attr("permF")(id))() : Vector3r::Zero();
	torque = any ? py::extract<Vector3r>(lasting.attr("permT")(id))() : Vector3r::Zero();
}

// None if a shape is none of these. The address of a shape identifies nothing, because a new shape may get the address of an old one.
inline std::optional<cd::ShapeKind> kindOf(const void* shape)
{
	static Kind isSphere { "Sphere", Kind::exactly }, isBox { "Box", Kind::exactly }, isWall { "Wall", Kind::exactly },
	    isFacet { "Facet", Kind::exactly };
	if (isSphere(shape))
		return cd::ShapeKind::disk;
	if (isBox(shape))
		return cd::ShapeKind::box;
	if (isWall(shape))
		return cd::ShapeKind::wall;
	return isFacet(shape) ? std::optional(cd::ShapeKind::facet) : std::nullopt;
}

[[noreturn]] inline void refuseShape(int id, const void* shape)
{
	// A clump is a body itself. Its id comes after those of its members, which need no test of their own for this.
	const std::string name = className(shape);
	if (name == "Clump")
		refuseBody(id, "is a clump", releaseClump);
	refuseBody(id, "has the shape " + name,
	    "Only Sphere, Box, Wall and Facet are known. Replace it, a fixed one by Facets as geom.facetCylinder or ymport.stl make them, or erase "
	    "it");
}

} // namespace cd_engine
