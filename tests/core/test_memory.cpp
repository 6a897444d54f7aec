// A step asks for no memory once it has had what its contacts need.
#include "allocations.hpp"
#include "time_step.hpp"

#include <algorithm>
#include <doctest/doctest.h>
#include <random>

using namespace cd;

namespace {

// A loose heap of columns of disks over a floor; every disk is a pair with those around it.
World heap(int columns, int rows)
{
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(0, 1);
	World w;
	w.bodies.resize(1 + columns * rows);
	w.shapes.resize(w.bodies.size());
	w.shapes[0].kind = ShapeKind::wall;
	w.shapes[0].axis = 1;
	for (int i = 0; i < columns * rows; i++) {
		Body& b = w.bodies[1 + i];
		b.x = i % columns + 0.05 * unit(random);
		b.y = 0.5 + i / columns;
		b.radius = 0.45 + 0.05 * unit(random);
		b.inverseMass[0] = b.inverseMass[1] = 1;
		b.inverseMass[2] = 2 / (b.radius * b.radius);
		b.force[1] = -9.81;
		if (i < columns)
			w.pairs.push_back({ 0, 1 + i, 0.5 });
		for (const int left : { i - 1, i - columns - 1, i - columns, i - columns + 1 })
			if (left >= 0 && std::abs(left % columns - i % columns) <= 1)
				w.pairs.push_back({ 1 + left, 1 + i, 0.5 });
	}
	return w;
}

} // namespace

TEST_CASE("a time step asks for no memory once its sizes have settled, be it solved as a whole or by islands")
{
	for (const Solver method : { Solver(nsgs), Solver(accelerated) })
		for (const bool reduce : { false, true }) {
			World w = heap(20, 5);
			TimeStep step;
			StepSettings settings;
			settings.dt = 1e-3;
			settings.solve = method;
			settings.reduce = reduce;
			settings.solver.maxIterations = 50;
			int most = 0, islands = 0, without = 0; // without: steps in a row that asked for no memory
			// Disks roll on for long, and now and then there are more contacts than ever before.
			for (int i = 0; i < 2000 && without < 100; i++) {
				step.sleepers.look(w);
				const std::size_t before = allocations();
				const StepReport report = step(w, settings);
				without = allocations() == before ? without + 1 : 0;
				most = std::max(most, report.contacts);
				islands = std::max(islands, report.effort.islands);
			}
			CHECK(most > 100);
			CHECK((islands > 1) == reduce);
			CHECK(without == 100);
		}
}
