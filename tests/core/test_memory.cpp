// A step asks for no memory once it has had what its contacts need.
#include "allocations.hpp"
#include "step/time_step.hpp"
#include "worlds.hpp"

#include <algorithm>
#include <doctest/doctest.h>

using namespace cd;

TEST_CASE("a time step asks for no memory once its sizes have settled, be it solved as a whole or by islands")
{
	for (const Solver<Plane> method : { Solver<Plane>(nsgs), Solver<Plane>(accelerated) })
		for (const bool reduce : { false, true }) {
			World w = tests::flow(20, 5);
			w.bodies[0].inverseMass[1] = 0; // a floor, which parts islands
			TimeStep<Plane> step;
			StepSettings<Plane> settings;
			settings.dt = 1e-3;
			settings.solve = method;
			settings.reduce = reduce;
			settings.solver.maxIterations = 50;
			int most = 0, islands = 0, without = 0; // without: steps in a row that asked for no memory
			// Disks roll on for long, and now and then there are more contacts than ever before.
			for (int i = 0; i < 2000 && without < 100; i++) {
				step.sleepers.update(w);
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
