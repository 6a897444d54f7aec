// Restitution in impacts of many contacts: it never adds energy, and where e = 1 and nothing rubs it loses none.
#include "step/time_step.hpp"
#include "worlds.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace cd;

namespace {

constexpr double h = 1e-3, radius = 0.1;

struct Scene {
	World world;
	double mu = 0, restitution = 1, tolerance = 1e-12;

	int wall() { return tests::add(world, {}, { ShapeKind::wall }); }
	void disk(double x, double y, double vx, double vy, double spin = 0, double mass = 1)
	{
		Body b = tests::diskAt(x, y, radius, mass);
		b.v[0] = vx;
		b.v[1] = vy;
		b.v[2] = spin;
		tests::add(world, b);
	}
	// A triangular lattice of side x side disks that touch and spin, with masses from 1/spread to spread, thrown as a whole at a wall.
	void cluster(int side, double spread, std::mt19937& random)
	{
		std::uniform_real_distribution<double> unit(-1, 1);
		wall();
		for (int i = 0; i < side; i++)
			for (int j = 0; j < side; j++) {
				const double vy = 0.5 * unit(random), spin = 10 * unit(random);
				disk(0.5 * h + radius * (1 + std::sqrt(3.) * i), radius * (2 * j + i % 2), -1, vy, spin,
				    std::pow(spread, unit(random)));
			}
		pairUp();
	}
	// All pairs but those of two boundaries.
	void pairUp()
	{
		for (size_t i = 0; i < world.bodies.size(); i++)
			for (size_t j = i + 1; j < world.bodies.size(); j++)
				if (world.bodies[j].radius > 0)
					world.pairs.push_back({ static_cast<int32_t>(i), static_cast<int32_t>(j), mu });
	}
	double energy() const
	{
		double sum = 0;
		for (const Body& b : world.bodies)
			for (int k = 0; k < 3; k++)
				sum += b.inverseMass[k] > 0 ? 0.5 * b.v[k] * b.v[k] / b.inverseMass[k] : 0;
		return sum;
	}
	StepReport step(TimeStep<Plane>& t)
	{
		StepSettings<Plane> s;
		s.dt = h;
		s.restitution = restitution;
		s.solve = findSolver("auto");
		s.solver = { tolerance, 200000 };
		t.sleepers.update(world);
		return t(world, s);
	}
	// No step that is solved adds more than this share of the energy.
	void checkEnergy(int steps, double share)
	{
		TimeStep<Plane> t;
		double last = energy();
		for (int k = 0; k < steps; k++) {
			if (step(t).solver.status == Status::converged)
				CHECK(energy() <= last * (1 + share));
			last = energy();
		}
	}
};

} // namespace

TEST_CASE("disks in a row that touch each other and a wall, hit by another: no energy is made, none is lost at e = 1")
{
	for (const double e : { 0.5, 0.8, 0.9, 0.95, 1. })
		for (const double spread : { 0., 1e-12, 0.3 * h }) { // gaps: none, round-off, closed within the step
			CAPTURE(e);
			CAPTURE(spread);
			Scene s;
			s.restitution = e;
			s.wall();
			for (int k = 0; k < 5; k++)
				s.disk((2 * k + 1) * radius + (k + 1) * spread, 0, 0, 0);
			s.disk(11 * radius + 6 * spread + 0.5 * h, 0, -1, 0);
			s.pairUp();
			const double start = s.energy();
			double last = start;
			TimeStep<Plane> t;
			for (int k = 0; k < 400; k++) {
				s.step(t);
				CHECK(s.energy() <= last * (1 + 1e-9)); // the tolerance, over a step's contacts
				last = s.energy();
			}
			if (e == 1)
				CHECK(last == doctest::Approx(start).epsilon(1e-8));
			for (size_t k = 1; k < s.world.bodies.size(); k++)
				CHECK(s.world.bodies[k].x - s.world.bodies[k - 1].x > (k == 1 ? 1 : 2) * radius - 3 * h); // a step's way or two
		}
}

TEST_CASE("clusters of rubbing, spinning disks of unequal mass that hit a wall: no step makes energy")
{
	std::mt19937 random(5);
	for (const double e : { 0.5, 0.9, 1. })
		for (const double mu : { 0., 0.2, 0.5, 1. })
			for (int trial = 0; trial < 6; trial++) {
				CAPTURE(e);
				CAPTURE(mu);
				CAPTURE(trial);
				Scene s;
				s.restitution = e;
				s.mu = mu;
				s.cluster(3, 10, random);
				s.checkEnergy(60, 1e-9);
			}
}

TEST_CASE("a loose tolerance leaves no rebounds that make energy")
{
	std::mt19937 random(7);
	for (const double tolerance : { 1e-1, 1e-2, 1e-3 })
		for (const double mu : { 0., 0.5 })
			for (int trial = 0; trial < 10; trial++) {
				CAPTURE(tolerance);
				CAPTURE(mu);
				CAPTURE(trial);
				Scene s;
				s.mu = mu;
				s.tolerance = tolerance;
				s.cluster(4, 1, random);
				s.checkEnergy(40, 50 * Rebounds<Plane>::mostGain(1)); // held against W_nn p^2, here up to 50 times the energy
			}
}

// Where friction couples two impacts energy is made by the law itself (Kane and Levinson 1985), so e is lowered there, and only there.
TEST_CASE("a spinning disk thrown into a groove rebounds without gain; one that hits a floor beside it keeps its e")
{
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(-1, 1);
	for (const double mu : { 0., 0.1, 0.3, 0.5, 1., 2. })
		for (int trial = 0; trial < 120; trial++) {
			CAPTURE(mu);
			CAPTURE(trial);
			Scene s;
			s.mu = mu;
			s.restitution = trial < 60 ? 1 : 0.5;
			// Slopes steeper than 1/mu wedge the disk: no velocities part from both sides as fast as it has hit them.
			const double slope = 1.2 * (0.6 + 0.4 * unit(random));
			for (const double side : { -1., 1. }) {
				const int wall = s.wall();
				Shape& shape = s.world.shapes[wall];
				shape.kind = ShapeKind::box;
				shape.ex = 5 * radius;
				shape.ey = 0.5 * radius;
				shape.cosine = std::cos(side * slope);
				shape.sine = std::sin(side * slope);
				s.world.bodies[wall].x = side * 1.5 * radius * std::sin(slope);
				s.world.bodies[wall].y = -1.5 * radius * std::cos(slope);
			}
			s.disk(0, 1e-6 * radius, 0.5 * unit(random), -1, 3 * unit(random) / radius);
			s.world.pairs = { { 0, 2, mu }, { 1, 2, mu } };
			const int floor = s.wall();
			s.world.shapes[floor].axis = 1;
			s.world.bodies[floor].y = -10;
			s.disk(10, -10 + radius + 0.5 * h, 0, -1);
			s.world.pairs.push_back({ floor, 4, mu });
			double last = s.energy();
			TimeStep<Plane> t;
			for (int k = 0; k < 6; k++) {
				CHECK(s.step(t).solver.status == Status::converged);
				CHECK(s.energy() <= last * (1 + 1e-9));
				last = s.energy();
			}
			CHECK(s.world.bodies[4].v[1] == doctest::Approx(s.restitution).epsilon(1e-12));
		}
}
