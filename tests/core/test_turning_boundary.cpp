// Boxes that turn: a paddle that meets, pushes and throws disks, against the motion on a turning face in closed form.
#include "step/time_step.hpp"
#include "worlds.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace cd;

namespace {

// A box with prescribed velocities, then disks of 1 kg; nothing else acts, no friction.
struct Scene {
	World world;
	double tolerance = 1e-13, restitution = 0;

	explicit Scene(double ex, double ey, double spin, double angle = 0)
	{
		Body box;
		box.v[2] = spin;
		tests::add(world, box, { ShapeKind::box, ex, ey, std::cos(angle), std::sin(angle) });
	}

	void disk(double x, double y, double radius, double vx = 0, double vy = 0)
	{
		Body b = tests::diskAt(x, y, radius);
		b.v[0] = vx;
		b.v[1] = vy;
		world.pairs.push_back({ 0, tests::add(world, b) });
	}

	// One step, and the box turned by it, as the plug-in does.
	StepReport step(double h)
	{
		StepSettings<Plane> s;
		s.dt = h;
		s.restitution = restitution;
		s.solve = findSolver("nsgs");
		s.solver.tolerance = tolerance;
		TimeStep<Plane> t;
		t.sleepers.update(world);
		const StepReport report = t(world, s);
		Shape& shape = world.shapes[0];
		const double c = std::cos(world.bodies[0].turn), sine = std::sin(world.bodies[0].turn), before = shape.cosine;
		shape.cosine = before * c - shape.sine * sine;
		shape.sine = shape.sine * c + before * sine;
		return report;
	}

	// Place of a disk in the axes of the box.
	double along(size_t disk) const
	{
		const Body &a = world.bodies[0], &b = world.bodies[disk];
		return world.shapes[0].cosine * (b.x - a.x) + world.shapes[0].sine * (b.y - a.y);
	}
	double across(size_t disk) const
	{
		const Body &a = world.bodies[0], &b = world.bodies[disk];
		return -world.shapes[0].sine * (b.x - a.x) + world.shapes[0].cosine * (b.y - a.y);
	}
};

} // namespace

// A step's mid-configurations do not overlap. The step itself ends half a step off the last one: a turning face is there nearer by at most what
// half a step's angle w h/2 makes of the way between, (w h)^2/8 of the distance.
TEST_CASE("a paddle meets every disk in its way from its front, however far its tip goes in a step")
{
	const double radius = 0.011, half = 0.5e-3, spin = 60;
	for (const double h : { 1e-4, 1e-3, 4e-3 }) // the tip goes 0.27, 2.7 and 11 radii a step
		for (double angle = 0.05; angle < 1.5; angle += 0.05) {
			CAPTURE(h);
			CAPTURE(angle);
			const double distance = 0.45;
			Scene s(0.5, half, spin);
			s.disk(distance * std::cos(angle), distance * std::sin(angle), radius);
			if (distance * std::sin(angle) < radius + half + spin * h / 2 * distance)
				continue; // met in the first half step, before contact is looked at
			const int steps = static_cast<int>((angle + 0.2) / (spin * h)) + 1;
			for (int k = 0; k < steps; k++) {
				s.step(h);
				if (s.along(1) > 0.5)
					break; // it has left over the tip
				REQUIRE(s.across(1) > (half + radius) * (1 - 1e-9) - distance * spin * h * spin * h / 8);
			}
			CHECK(std::hypot(s.world.bodies[1].v[0], s.world.bodies[1].v[1]) > 0.9 * spin * 0.45); // thrown
		}
}

// Without friction a disk on the face of a paddle is thrown along it: x'' = w^2 x in the paddle's axes, pressed on if 2 w x' > w^2 y0. Hit at rest
// it starts with x' = w y0, since the normal takes only the velocity across the face.
TEST_CASE("a disk slides along a turning paddle as in closed form, to second order in the step")
{
	const double radius = 0.01, half = 0.01, spin = 5, x0 = 0.1, time = 0.4;
	double previous = 0;
	for (const int steps : { 50, 100, 200, 400 }) {
		CAPTURE(steps);
		Scene s(2, half, spin);
		const double y0 = half + radius;
		s.disk(x0, y0, radius, 0, spin * x0);
		double deepest = 0;
		for (int k = 0; k < steps; k++)
			deepest = std::max(deepest, s.step(time / steps).maxPenetration);
		const double along = s.along(1) - x0 * std::cosh(spin * time) - y0 * std::sinh(spin * time), across = s.across(1) - y0;
		const double error = std::hypot(along, across);
		if (previous > 0)
			CHECK(previous / error == doctest::Approx(4).epsilon(0.02)); // twice the steps, a quarter of the error
		CHECK(deepest < 1e-3 * radius);
		previous = error;
	}
}

// A turning box and one that moves with the same velocity where they meet the disk leave it with the same velocity, along the normal at that time.
TEST_CASE("a disk hit by a paddle leaves with the paddle's velocity there, or with restitution")
{
	const double radius = 0.01, half = 0.01, spin = 2, x0 = 1, h = 1e-4;
	for (const double e : { 0., 0.5, 1. }) {
		CAPTURE(e);
		Scene s(1.5, half, spin, -0.1);
		s.restitution = e;
		s.disk(x0, half + radius, radius); // met when the paddle lies along x
		for (int k = 0; k < 520; k++) // 0.05 s to it, and 20 steps more
			s.step(h);
		// 20 steps on the face turn the velocity by w t; met up to a step too soon, which is w h.
		CHECK(std::hypot(s.world.bodies[1].v[0], s.world.bodies[1].v[1]) == doctest::Approx((1 + e) * spin * x0).epsilon(2 * spin * 21 * h));
	}
}

// Velocities that somebody gives a disk in front of a box take it to the middle of the step before contact is looked at.
TEST_CASE("a disk that its first half step would take through a thin box is stopped at it, and bounces with restitution")
{
	const double radius = 0.1, half = 1e-3, h = 1e-3;
	for (const double e : { 0., 0.5 })
		for (const double gap : { 0.05, 0.2, 0.4 }) // of the way of a step
			for (const double side : { -1., 1. }) {
				CAPTURE(e);
				CAPTURE(gap);
				const double speed = 3000;
				Scene s(5, half, 0);
				s.restitution = e;
				s.disk(0.3, side * (half + radius + gap * speed * h), radius, 0, -side * speed);
				for (int k = 0; k < 4; k++)
					s.step(h);
				CHECK(side * s.world.bodies[1].v[1] == doctest::Approx(e * speed).epsilon(1e-12));
				CHECK(side * s.across(1) == doctest::Approx(half + radius + 3.5 * h * e * speed).epsilon(1e-12));
			}
}

TEST_CASE("a disk that leaves a thin box as fast is let go, one that flies past its end is not touched")
{
	Scene s(5, 1e-3, 0);
	s.disk(0.3, 0.101, 0.1, 0, 3000);
	s.disk(5.2, 0.5, 0.1, 0, -3000);
	s.step(1e-3);
	s.step(1e-3);
	CHECK(s.across(1) == doctest::Approx(6.101));
	CHECK(s.world.bodies[2].v[1] == -3000);
}
