// The bodies of a plane scene and the pairs that may touch: what a time step reads and moves. Knows neither YADE nor Python.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cd {

enum class ShapeKind : uint8_t { disk, box, wall };

struct Shape {
	ShapeKind kind = ShapeKind::disk;
	double radius = 0; // disk [m]
	double ex = 0, ey = 0; // box: half lengths along its own axes [m]
	double cosine = 1, sine = 0; // box: its orientation in the plane
	int axis = 0; // wall: the axis it is perpendicular to, 0 = x, 1 = y
	int sense = 0; // wall: the side it acts on, -1, +1, or 0 for both
};

struct Body {
	double x = 0, y = 0, turn = 0; // position [m]; rotation made in this step [rad]
	double v[3] = { 0, 0, 0 }; // v_x, v_y [m/s], angular velocity [rad/s]
	double inverseMass[3] = { 0, 0, 0 }; // along x, y [1/kg] and about z [1/(kg m^2)]; 0: that freedom is blocked, its velocity prescribed
	double force[3] = { 0, 0, 0 }; // external force [N] and torque [N m], gravity included
	Shape shape;
};

// Two bodies near each other. `a` is the boundary where one is a boundary; two boundaries never touch.
struct Pair {
	int32_t a, b;
	double mu = 0; // friction coefficient
	double reference = 0; // overlap [m] that counts as touching (left behind by springs); forgotten once the bodies are apart
	double pn = 0, pt = 0; // impulse on b [N s]: first guess before the step, solution after it
	// Filled by the step, at its mid-configuration:
	double gap = 0; // distance of the surfaces plus `reference` [m]
	double nx = 0, ny = 0; // unit normal a -> b
	double cx = 0, cy = 0; // contact point, midway between the surfaces [m]
	double overlap = 0; // geometric overlap [m], negative: apart
};

struct World {
	std::vector<Body> bodies;
	std::vector<Pair> pairs;
};

// Where a body is for the purpose of contacts: small, so that the places of many bodies stay in the nearest cache.
struct Place {
	double x, y; // [m]
	double turned; // rotation beyond the orientation stored in its shape [rad]
	double radius; // of a disk [m]; 0: a boundary
};

// The place of a body after `ahead` [s] at its present velocities.
inline Place placeAhead(const Body& b, double ahead)
{
	return { b.x + ahead * b.v[0], b.y + ahead * b.v[1], ahead * b.v[2], b.shape.kind == ShapeKind::disk ? b.shape.radius : 0 };
}

// Fills gap, normal, contact point and overlap of a pair at the given places; `shape` is that of pair.a, read if it is a boundary.
void locateContact(Pair&, const Place& a, const Place& b, const Shape& shape);

} // namespace cd
