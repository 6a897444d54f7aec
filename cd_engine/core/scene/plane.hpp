// What the templates of the core need to know of the plane. Everything else that names a dimension is a specialization of them, written by hand:
// `template <> struct ContactRow<Plane>`. A description of space would have 6 freedoms and 3 components.
#pragma once

namespace cd {

struct Body;
struct Carried;
struct Mean;
struct Place;
struct Shape;
struct Touch;
struct Vector;
template <class N> struct Components; // law.inl
template <class N> struct Motion;
template <class N> struct RollingComponents; // law_rolling.inl

struct Plane {
	using Scene = Plane; // the description of its bodies and their shapes
	static constexpr int freedoms = 3; // of a body: x, y, and the rotation about z
	static constexpr int components = 2; // of a position or a force
	using Impulse = Components<double>; // or a relative velocity
	using Motion = cd::Motion<double>; // velocity and angular velocity of a body, or the inverses of its masses
	using Body = cd::Body;
	using Carried = cd::Carried;
	using Mean = cd::Mean;
	using Place = cd::Place;
	using Shape = cd::Shape;
	using Touch = cd::Touch;
	using Vector = cd::Vector;
};

// The plane, where contacts resist rolling: they have a third component, a moment (law_rolling.inl).
struct RollingPlane : Plane {
	using Impulse = RollingComponents<double>;
};

template <class Space> using ImpulseOf = typename Space::Impulse;
template <class Space> using MotionOf = typename Space::Motion;
template <class Space> using BodyOf = typename Space::Body;
template <class Space> using ShapeOf = typename Space::Shape;
template <class Space> using PlaceOf = typename Space::Place;
template <class Space> using TouchOf = typename Space::Touch;
template <class Space> using VectorOf = typename Space::Vector;

} // namespace cd
