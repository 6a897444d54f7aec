// Which bodies are fast and far from all others.
#include "alone.hpp"

#include <doctest/doctest.h>

using namespace cd;

namespace {

constexpr double dt = 1e-3, slow = 1e-3;

std::vector<int> fastAndAlone(const World& w, double dt, double slow) { return FastAndAlone().find(w, dt, slow); }

// Disks of radius 0.01 m at rest, a tenth of a metre apart, on a box.
World bed(int disks)
{
	World w;
	w.bodies.resize(1 + disks);
	w.shapes.resize(w.bodies.size());
	w.shapes[0].kind = ShapeKind::box;
	w.shapes[0].ex = 1;
	w.shapes[0].ey = 0.01;
	for (int i = 1; i <= disks; i++)
		w.bodies[i] = { 0.1 * i, 0.02, 0, { 0, 0, 0 }, { 1, 1, 1 }, { 0, 0, 0 }, 0.01 };
	return w;
}

int add(World& w, double x, double y, double vx, double vy)
{
	w.bodies.push_back({ x, y, 0, { vx, vy, 0 }, { 1, 1, 1 }, { 0, 0, 0 }, 0.01 });
	w.shapes.emplace_back();
	return static_cast<int>(w.bodies.size()) - 1;
}

} // namespace

TEST_CASE("a disk is alone until it may touch somebody in a step")
{
	World w = bed(5);
	const int id = add(w, 0.3, 1, 0, -10); // 0.01 m a step
	CHECK(fastAndAlone(w, dt, slow) == std::vector<int> { id });
	w.bodies[id].y = 0.03 + 4 * 0.01 + 0.02 + 1e-6; // four ways and a diameter from the surface of another
	CHECK(fastAndAlone(w, dt, slow) == std::vector<int> { id });
	w.bodies[id].y -= 2e-6;
	CHECK(fastAndAlone(w, dt, slow).empty());
}

TEST_CASE("forces that make it fast within the step count")
{
	World w = bed(5);
	const int id = add(w, 0.3, 1, 0, 0);
	CHECK(fastAndAlone(w, dt, slow).empty()); // slow
	w.bodies[id].force[1] = -1e5; // 0.1 m in the step
	CHECK(fastAndAlone(w, dt, slow) == std::vector<int> { id });
	w.bodies[id].y = 0.4;
	CHECK(fastAndAlone(w, dt, slow).empty());
}

TEST_CASE("two that may meet are not alone, two that go side by side are")
{
	World w = bed(5);
	const int first = add(w, 5, 1, 10, 0), second = add(w, 5.08, 1, -9, 0);
	CHECK(fastAndAlone(w, dt, slow).empty());
	for (const int id : { first, second }) {
		w.bodies[id].v[0] = 0;
		w.bodies[id].v[1] = -10 - id;
	}
	CHECK(fastAndAlone(w, dt, slow) == std::vector<int> { second, first }); // the fastest first
}

TEST_CASE("a wall is endless, and a fast one makes nobody alone")
{
	World w = bed(5);
	const int id = add(w, 0.3, 5, 0, 10);
	Body wall;
	Shape shape;
	shape.kind = ShapeKind::wall;
	shape.axis = 0;
	w.bodies.push_back(wall);
	w.shapes.push_back(shape);
	CHECK(fastAndAlone(w, dt, slow) == std::vector<int> { id }); // it flies along the wall, 0.3 m away
	w.bodies[id].x = 0.02;
	CHECK(fastAndAlone(w, dt, slow).empty());
	w.bodies[id].x = 0.3;
	w.bodies.back().v[0] = 100;
	CHECK(fastAndAlone(w, dt, slow).empty());
}

TEST_CASE("left behind is the scene by who is further away than it is wide, and goes on")
{
	World w = bed(5); // 2 m wide
	const int id = add(w, 0.3, -1.5, 0, -10);
	w.bodies[id].alone = true;
	CHECK(leftBehind(w, { id }) == -1);
	w.bodies[id].y = -2.5;
	CHECK(leftBehind(w, { id }) == id);
	w.bodies[id].force[1] = 1; // brings it back
	CHECK(leftBehind(w, { id }) == -1);
	w.bodies[id].force[1] = -1;
	CHECK(leftBehind(w, { id }) == id);
	w.bodies[id].v[1] = 10;
	CHECK(leftBehind(w, { id }) == -1);
}
