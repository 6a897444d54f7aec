// Scenes of disks that several tests use, and what such scenes are made of.
#pragma once

#include "scene/scene.hpp"

#include <cstdlib>
#include <random>

namespace tests {
using namespace cd;

// A free disk.
inline Body diskAt(double x, double y, double radius, double mass = 1)
{
	Body b;
	b.x = x;
	b.y = y;
	b.radius = radius;
	b.inverseMass[0] = b.inverseMass[1] = 1 / mass;
	b.inverseMass[2] = 2 / (mass * radius * radius);
	return b;
}

// Returns the body's number.
inline int32_t add(World& w, const Body& body, const Shape& shape = {})
{
	w.bodies.push_back(body);
	w.shapes.push_back(shape);
	return static_cast<int32_t>(w.bodies.size()) - 1;
}

// Disks in a loose heap over a wall that may move up and down, thrown about; every disk is a pair with those around it, in the order of their
// squares.
inline World flow(int columns, int rows)
{
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(0, 1);
	World w;
	Shape floor;
	floor.kind = ShapeKind::wall;
	floor.axis = 1;
	add(w, {}, floor);
	w.bodies[0].inverseMass[1] = 1e-2;
	w.bodies[0].force[1] = 5. * columns;
	for (int i = 0; i < columns * rows; i++) {
		const double x = i % columns + 0.02 * unit(random), vx = unit(random) - 0.5, vy = unit(random) - 0.5;
		Body b = diskAt(x, 0.5 + i / columns, 0.495 + 0.02 * unit(random));
		b.v[0] = vx;
		b.v[1] = vy;
		b.force[1] = -9.81;
		add(w, b);
		if (i < columns)
			w.pairs.push_back({ 0, 1 + i, 0.5, 0.002 });
		for (const int other : { i - 1, i - columns - 1, i - columns, i - columns + 1 })
			if (other >= 0 && std::abs(other % columns - i % columns) <= 1)
				w.pairs.push_back({ 1 + other, 1 + i, 0.5 });
	}
	return w;
}

} // namespace tests
