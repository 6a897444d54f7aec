// Bodies in space, and what they carry from step to step: body.hpp and pair.hpp say what is the same in the plane.
#pragma once

#include "scene/body.hpp"
#include "scene/pair.hpp"
#include "scene/space3.hpp"

namespace cd {

struct SpaceBody {
	Vector3 at { 0, 0, 0 }; // position [m]
	Vector3 turn { 0, 0, 0 }; // rotation made in this step: its axis times its angle [rad]
	double v[Space3::freedoms] = {}; // [m/s], [rad/s]
	double inverseMass[Space3::freedoms] = {}; // along x, y, z [1/kg] and about them [1/(kg m^2)]; 0: blocked, its velocity is prescribed
	double force[Space3::freedoms] = {}; // external force [N] and torque [N m], gravity included
	double radius = 0; // of a sphere [m]; 0: the body is a boundary
	double friction = 0; // coefficient of friction of the surface
};
inline Vector3 centreOf(const SpaceBody& b) { return b.at; }
inline Vector3 velocityOf(const SpaceBody& b) { return vectorOf(b.v); }
inline Vector3 spinOf(const SpaceBody& b) { return vectorOf(b.v + 3); }
// Of the point of a body at this place from its centre.
inline Vector3 velocityAt(const SpaceBody& b, const Vector3& arm) { return velocityOf(b) + cross(spinOf(b), arm); }
inline bool turns(const SpaceBody& b) { return b.v[3] != 0 || b.v[4] != 0 || b.v[5] != 0; }
inline bool samePlace(const SpaceBody& b, const SpaceBody& c) { return b.at == c.at && b.radius == c.radius && b.friction == c.friction; }

struct alignas(32) SpacePlace {
	Vector3 at; // [m]
	double radius; // of a sphere [m]; 0: a boundary
};
static_assert(sizeof(SpacePlace) == 32);

inline SpacePlace placeAhead(const SpaceBody& b, double ahead) { return { b.at + ahead * velocityOf(b), b.radius }; }

// The motion of a body in a step, as in the plane.
struct alignas(64) SpaceMean {
	double v[Space3::freedoms];
	double speed; // [m/s]
};
static_assert(sizeof(SpaceMean) == 64);

// The force of a contact after the last step. Friction is a vector of the world.
struct SpaceCarried {
	Vector3 n { 0, 0, 0 }; // unit normal a -> b in that step
	Vector3 fn { 0, 0, 0 }, ft { 0, 0, 0 }; // normal and tangential force on b [N]
	long since = Carried::nothing; // step in which the contact became loaded

	bool any() const { return since != Carried::nothing; }
	bool same(const SpaceCarried& o) const { return any() == o.any() && n == o.n && fn == o.fn && ft == o.ft; }
	// The friction turns with the normal: by the smallest rotation, up to its length, which stays.
	Vector3 frictionAcross(const Vector3& now) const
	{
		if (now == n) // else a force that is stored and read again would change step by step
			return ft;
		const Vector3 left = ft - dot(now, ft) * now;
		const double before = dot(ft, ft), square = dot(left, left);
		return square > 0 ? std::sqrt(before / square) * left : Vector3 { 0, 0, 0 };
	}
	// Along the normal [N]; 0: springs pulled, or there is none.
	double normalForce() const
	{
		const double normal = dot(n, fn);
		return normal > 0 && std::isfinite(dot(ft, ft)) ? normal / dot(n, n) : 0;
	}
};

} // namespace cd
