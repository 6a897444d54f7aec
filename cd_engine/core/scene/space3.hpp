// What the templates of the core need to know of space. Everything else that names its dimension is a specialization of them.
#pragma once

namespace cd {

struct SpaceBody;
struct SpaceCarried;
struct SpaceMean;
struct SpacePlace;
struct SpaceShape;
struct SpaceTouch;
struct Vector3;
template <class N> struct SpatialComponents; // law_in_space.inl
template <class N> struct SpatialMotion;

struct Space3 {
	using Scene = Space3;
	static constexpr int freedoms = 6; // of a body: x, y, z, and the rotations about them
	static constexpr int components = 3; // of a position or a force
	using Impulse = SpatialComponents<double>; // or a relative velocity
	using Motion = SpatialMotion<double>; // velocity and angular velocity of a body, or the inverses of its masses
	using Body = SpaceBody;
	using Carried = SpaceCarried;
	using Mean = SpaceMean;
	using Place = SpacePlace;
	using Shape = SpaceShape;
	using Touch = SpaceTouch;
	using Vector = Vector3;
};

} // namespace cd
