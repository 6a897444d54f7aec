// The plane in which a scene lies, and how vectors of space stand in it; and the same for a scene in space, which is nothing.
#pragma once

#include "layout.hpp"
#include "scene_error.hpp"
#include "scene/scene.hpp"

namespace cd_engine {

// The core sees two axes of space as its x and y, and the rotation from x to y as positive. In x-z this is the negative rotation about y, so there
// `turn` is -1: a scene in x-z is the mirror image, not the rotated image, of one in x-y, and moves as that does to the last bit.
struct ScenePlane {
	int x = 0, y = 1, normal = 2;
	double turn = 1;

	static ScenePlane across(int normal)
	{
		static constexpr int axes[3][2] = { { 1, 2 }, { 0, 2 }, { 0, 1 } };
		return { axes[normal][0], axes[normal][1], normal, normal == 1 ? -1. : 1. };
	}
	// The plane in which the blocked freedoms keep the bodies; `before`, if they leave a choice. gravity: if they leave one still, a plane that
	// it lies in.
	static ScenePlane of(yade::BodyContainer& bodies, const ScenePlane& before, const Vector3r& gravity)
	{
		unsigned possible = 7;
		const int count = static_cast<int>(bodies.size());
		for (int id = 0; id < count && (possible & (possible - 1)) != 0; id++) {
			const Shared<yade::Body>& body = bodies[id];
			if (!body || !body_state(body))
				continue;
			unsigned here = 0;
			for (int axis = 0; axis < 3; axis++)
				here |= unsigned(across(axis).keeps(state_blockedDOFs(body_state(body)))) << axis;
			if ((here & (here - 1)) == 0 && here != 0)
				possible = here; // this body leaves no choice; another that contradicts it will be refused
			else if ((here & possible) != 0)
				possible &= here;
		}
		const auto fits = [&](int axis) { return possible >> axis & 1; };
		if (fits(before.normal) && (gravity[before.normal] == 0 || (possible & (possible - 1)) == 0))
			return before;
		for (int axis = 2; axis >= 0; axis--)
			if (fits(axis) && gravity[axis] == 0)
				return across(axis);
		return fits(before.normal) ? before : across(fits(2) ? 2 : fits(1) ? 1 : 0);
	}

	// The bit of a freedom of the plane, 0 to 2, in State.blockedDOFs.
	unsigned dof(int k) const { return k == 0 ? 1u << x : k == 1 ? 1u << y : 8u << normal; }
	unsigned outside() const { return ~(dof(0) | dof(1) | dof(2)) & 63; }
	bool keeps(unsigned blockedDOFs) const { return (blockedDOFs & outside()) == outside(); }

	double velocity(void* state, int k) const { return k < 2 ? state_vel(state)[k == 0 ? x : y] : turn * state_angVel(state)[normal]; }
	void setVelocity(void* state, int k, double v) const
	{
		(k < 2 ? state_vel(state)[k == 0 ? x : y] : state_angVel(state)[normal]) = k < 2 ? v : turn * v;
	}

	Vector3r toCore(const Vector3r& v) const { return { v[x], v[y], v[normal] }; }
	Vector3r toSpace(double alongX, double alongY, double out = 0) const
	{
		Vector3r v;
		v[x] = alongX;
		v[y] = alongY;
		v[normal] = out;
		return v;
	}
	Vector3r torque(double about) const { return toSpace(0, 0, turn * about); }

	const char* name() const { return normal == 2 ? "x-y" : normal == 1 ? "x-z" : "y-z"; }
	char letter(int axis) const { return "xyz"[axis]; }
	// What a disk blocks that is kept in this plane.
	const char* blocks() const { return normal == 2 ? "zXY" : normal == 1 ? "yXZ" : "xYZ"; }
};

// Whether the freedoms of a body let it leave every plane.
inline bool keepsNoPlane(unsigned blockedDOFs)
{
	return !ScenePlane::across(0).keeps(blockedDOFs) && !ScenePlane::across(1).keeps(blockedDOFs) && !ScenePlane::across(2).keeps(blockedDOFs);
}

// A body can leave the plane in which the scene was solved until now: it is to be solved in space.
struct LeavesPlane {
	std::string what, remedy;

	static LeavesPlane of(int id, bool isFacet)
	{
		if (isFacet)
			return { text("body #", id, " is a Facet, which is known in space only, so the scene is solved in space"),
				"Use Box or Wall to keep it in the plane." };
		return { text("body #", id, " is free to leave the plane of the scene, so the scene is solved in space"),
			text("To keep it in the plane, set O.bodies[", id, "].state.blockedDOFs to 'zXY' (x-y), 'yXZ' (x-z) or 'xYZ' (y-z).") };
	}
};

struct SceneSpace {
	unsigned dof(int k) const { return 1u << k; }
	double velocity(void* state, int k) const { return k < 3 ? state_vel(state)[k] : state_angVel(state)[k - 3]; }
	void setVelocity(void* state, int k, double v) const { (k < 3 ? state_vel(state)[k] : state_angVel(state)[k - 3]) = v; }
	Vector3r toCore(const Vector3r& v) const { return v; }
	char letter(int axis) const { return "xyz"[axis]; }
};

template <class Space> struct FrameOf;
template <> struct FrameOf<cd::Plane> {
	using Type = ScenePlane;
};
template <> struct FrameOf<cd::Space3> {
	using Type = SceneSpace;
};

} // namespace cd_engine
