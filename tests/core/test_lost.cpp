// Which disks have left the scene.
#include "lost.hpp"

#include <doctest/doctest.h>

using namespace cd;

TEST_CASE("left behind is the scene by who is further away than it is wide, and goes on")
{
	World w;
	w.bodies.resize(6);
	w.shapes.resize(7);
	w.shapes[0].kind = ShapeKind::box; // 2 m wide
	w.shapes[0].ex = 1;
	w.shapes[0].ey = 0.01;
	for (int i = 1; i < 6; i++)
		w.bodies[i] = { 0.1 * i, 0.02, 0, { 0, 0, 0 }, { 1, 1, 1 }, { 0, 0, 0 }, 0.01 };
	w.bodies.push_back({ 0.3, -1.5, 0, { 0, -10, 0 }, { 1, 1, 1 }, { 0, 0, 0 }, 0.01 });
	Body& lost = w.bodies.back();
	CHECK(leftBehind(w, {}) == -1);
	CHECK(leftBehind(w, { 6 }) == -1);
	lost.y = -2.5;
	CHECK(leftBehind(w, { 6 }) == 6);
	lost.force[1] = 1; // brings it back
	CHECK(leftBehind(w, { 6 }) == -1);
	lost.force[1] = -1;
	CHECK(leftBehind(w, { 6 }) == 6);
	lost.v[1] = 10;
	CHECK(leftBehind(w, { 6 }) == -1);
	lost.v[1] = -10;
	lost.radius = 0.05; // 50 radii are more than the way to the scene
	CHECK(leftBehind(w, { 6 }) == -1);
}
