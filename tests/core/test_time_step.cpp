// One step of the scheme on two disks: what it asks of gaps and overlaps.
#include "time_step.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace cd;

namespace {

constexpr double h = 1e-3, radius = 0.1;

// Two disks of 1 kg on the x axis, overlapping by `overlap` [m], approaching at `speed` [m/s].
World twoDisks(double overlap, double speed)
{
	World w;
	for (const double side : { -1., 1. }) {
		Body b;
		b.x = side * (radius - 0.5 * overlap);
		b.v[0] = -0.5 * side * speed;
		b.inverseMass[0] = b.inverseMass[1] = 1;
		b.inverseMass[2] = 2 / (radius * radius);
		b.radius = radius;
		w.bodies.push_back(b);
	}
	w.shapes.resize(2);
	w.pairs.push_back({ 0, 1 });
	return w;
}

StepReport step(World& w, double gapCorrection, double restitution = 0)
{
	StepSettings s;
	s.dt = h;
	s.restitution = restitution;
	s.gapCorrection = gapCorrection;
	s.solve = findSolver("nsgs");
	s.solver.tolerance = 1e-13;
	TimeStep t;
	t.sleepers.look(w);
	return t(w, s);
}

double overlapOf(const World& w) { return 2 * radius - (w.bodies[1].x - w.bodies[0].x); }
double separation(const World& w) { return w.bodies[1].v[0] - w.bodies[0].v[0]; }

} // namespace

// Tolerances: lengths of 0.2 m are known to 3e-17, velocities to that over the step, 3e-14.
TEST_CASE("an overlap is kept without gapCorrection, and shrinks by its share a step with it")
{
	const double overlap = 1e-4;
	for (const double share : { 0., 0.25, 1. }) {
		CAPTURE(share);
		World w = twoDisks(overlap, 0);
		const StepReport report = step(w, share);
		CHECK(separation(w) == doctest::Approx(share * overlap / h).epsilon(1e-11));
		// The new velocity moves the bodies for the second half of the step only; it is the mid-configurations that are a step apart.
		CHECK(overlapOf(w) + h * -0.5 * separation(w) == doctest::Approx((1 - share) * overlap).epsilon(1e-11));
		// Reduced mass 1/2: the energy of pushing out is a loss with a minus sign.
		CHECK(report.dissipated == doctest::Approx(-0.25 * separation(w) * separation(w)).epsilon(1e-11));
		if (share == 0)
			CHECK(w.bodies[1].x == radius - 0.5 * overlap); // not even by round-off
	}
}

TEST_CASE("a reference overlap is not pushed out")
{
	World w = twoDisks(1e-4, 0);
	w.pairs[0].reference = 1e-4;
	step(w, 1);
	CHECK(std::abs(separation(w)) < 1e-12); // 3e-17 m of round-off in the overlap, over h
}

TEST_CASE("gapCorrection changes no bit where nothing overlaps")
{
	for (const double restitution : { 0., 0.5 })
		for (const double gap : { 6e-4, 1e-3, 5e-3 }) { // not crossed by h/2 x 1 m/s
			World without = twoDisks(-gap, 1), with = without;
			step(without, 0, restitution);
			step(with, 1, restitution);
			CHECK(without.bodies[0].x == with.bodies[0].x);
			CHECK(without.bodies[1].v[0] == with.bodies[1].v[0]);
		}
}

TEST_CASE("with restitution a closing contact takes the larger of rebound and correction")
{
	// At the mid-configuration the disks overlap by h/2 x 1 m/s more.
	const double overlap = 1e-4, asked = overlap / h + 0.5;
	for (const double e : { 0.2, 1. }) {
		World w = twoDisks(overlap, 1);
		step(w, 1, e);
		CHECK(separation(w) == doctest::Approx(std::max(e, asked)).epsilon(1e-11));
	}
}
