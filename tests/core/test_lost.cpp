// Which disks have left the scene.
#include "search/pair_search.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace cd;

TEST_CASE("left behind is the scene by who is further away than it is wide, and goes on")
{
	World w;
	w.bodies.resize(6);
	w.shapes.resize(7);
	w.masks.assign(7, 1);
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

TEST_CASE("a group that leaves the boundaries is noticed, a cloud around a small boundary is not")
{
	World w;
	w.shapes.resize(21);
	w.masks.assign(21, 1);
	w.shapes[0].kind = ShapeKind::box;
	w.shapes[0].ex = 0.1;
	w.shapes[0].ey = 0.1;
	w.bodies.resize(1);
	for (int i = 1; i <= 20; i++)
		w.bodies.push_back({ 0.03 * i, -3, 0, { 0, -10, 0 }, { 1, 1, 1 }, { 0, -1, 0 }, 0.01 });
	CHECK(leftBehind(w, {}) == -1);
	CHECK(leftBehind(w, { 3, 5 }) == 3);
	w.masks[0] = 0; // the boundary is erased, so all that is left moves together
	CHECK(leftBehind(w, { 3, 5 }) == -1);
	w.masks[0] = 1;
	// Disks in a ring far around the boundary that fly in all directions: those that come in show how far the scene reaches.
	for (int i = 1; i <= 20; i++) {
		Body& b = w.bodies[i];
		b.x = 2 * std::cos(0.1 * 3.14159 * i);
		b.y = 2 * std::sin(0.1 * 3.14159 * i);
		b.v[0] = i % 2 == 0 ? b.x : -b.x;
		b.v[1] = i % 2 == 0 ? b.y : -b.y;
		b.force[0] = b.force[1] = 0;
	}
	CHECK(leftBehind(w, { 2, 4 }) == -1);
	w.bodies[2].x *= 5;
	w.bodies[2].y *= 5;
	CHECK(leftBehind(w, { 2, 4 }) == 2);
	// The same where fixed disks are the boundary.
	w.shapes[0].kind = ShapeKind::disk;
	w.bodies[0].radius = 0.1;
	CHECK(leftBehind(w, { 2, 4 }) == 2);
}

TEST_CASE("nobody is lost who comes to a Wall, by its force or, without one, by its velocity")
{
	World w;
	w.bodies.resize(3);
	w.shapes.resize(3);
	w.masks.assign(3, 1);
	w.shapes[0].kind = ShapeKind::box;
	w.shapes[0].ex = w.shapes[0].ey = 0.1;
	w.shapes[1].kind = ShapeKind::wall;
	w.shapes[1].axis = 1;
	w.bodies[1].y = -9;
	Body& disk = w.bodies[2] = { 5, -3, 0, { 8, 0, 0 }, { 1, 1, 1 }, { 0, -1, 0 }, 0.01 };
	CHECK(leftBehind(w, { 2 }) == -1);
	w.masks[1] = 0;
	CHECK(leftBehind(w, { 2 }) == 2);
	w.masks[1] = 1;
	disk.force[1] = 0;
	CHECK(leftBehind(w, { 2 }) == 2);
	disk.v[1] = -1;
	CHECK(leftBehind(w, { 2 }) == -1);
	w.bodies[1].y = 9; // behind it
	CHECK(leftBehind(w, { 2 }) == 2);
}
