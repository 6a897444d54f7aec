// One step of the scheme on two disks: what it asks of gaps and overlaps.
#include "step/time_step.hpp"
#include "worlds.hpp"

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
		Body b = tests::diskAt(side * (radius - 0.5 * overlap), 0, radius);
		b.v[0] = -0.5 * side * speed;
		tests::add(w, b);
	}
	w.pairs.push_back({ 0, 1 });
	return w;
}

StepSettings<Plane> settings()
{
	StepSettings<Plane> s;
	s.dt = h;
	s.solve = findSolver("nsgs");
	s.solver.tolerance = 1e-13;
	return s;
}

StepReport step(World& w, double gapCorrection, double restitution = 0, double allowedOverlap = 0)
{
	StepSettings<Plane> s = settings();
	s.restitution = restitution;
	s.gapCorrection = gapCorrection;
	s.allowedOverlap = allowedOverlap;
	TimeStep<Plane> t;
	t.sleepers.update(w);
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

TEST_CASE("an allowed overlap is not pushed out, and more than that only down to it")
{
	const double allowed = 1e-3;
	for (const double overlap : { 0.5 * allowed * radius, 3 * allowed * radius }) {
		World w = twoDisks(overlap, 0);
		step(w, 0.25, 0, allowed);
		CHECK(separation(w) == doctest::Approx(0.25 * std::max(0., overlap - allowed * radius) / h).epsilon(1e-11));
	}
}

TEST_CASE("a reference overlap is not pushed out")
{
	World w = twoDisks(1e-4, 0);
	w.pairs[0].reference = 1e-4;
	step(w, 1);
	CHECK(std::abs(separation(w)) < 1e-12); // 3e-17 m of round-off in the overlap, over h
}

TEST_CASE("overlapCorrection moves bodies by their masses and gives them no velocity")
{
	const double overlap = 1e-4, allowed = 2e-4;
	for (const double share : { 0.1, 1. })
		for (const double reference : { 0., overlap }) {
			CAPTURE(share);
			World w = twoDisks(overlap, 0);
			w.bodies[1].inverseMass[0] = 3;
			w.pairs[0].reference = reference;
			const World before = w;
			StepSettings<Plane> s = settings();
			s.overlapCorrection = share;
			s.allowedOverlap = allowed;
			TimeStep<Plane> t;
			t.sleepers.update(w);
			const StepReport report = t(w, s);
			const double moved = reference > 0 ? 0 : share * (overlap - allowed * radius);
			CHECK(w.bodies[0].x - before.bodies[0].x == doctest::Approx(-moved / 4).epsilon(1e-10));
			CHECK(w.bodies[1].x - before.bodies[1].x == doctest::Approx(3 * moved / 4).epsilon(1e-10));
			CHECK(separation(w) == 0);
			CHECK(report.dissipated == 0);
			CHECK(report.idle == false);
		}
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

namespace {

// A disk whose centre comes through walls x = `walls` by the velocity `speed` [m/s] in the first half of a step; the disk after it.
Body stopped(double speed, const std::vector<Shape>& shapes, const std::vector<double>& places, double inverseMassX)
{
	World w;
	for (const double x : places) {
		Body wall;
		wall.x = x;
		w.bodies.push_back(wall);
	}
	w.shapes = shapes;
	w.shapes.emplace_back();
	Body disk;
	disk.radius = radius;
	disk.v[0] = speed;
	disk.inverseMass[0] = inverseMassX;
	disk.inverseMass[1] = 1;
	const auto number = static_cast<int32_t>(places.size());
	w.bodies.push_back(disk);
	for (int32_t k = 0; k < number; k++)
		w.pairs.push_back({ k, number });
	step(w, 0);
	return w.bodies.back();
}

Shape wall(int sense)
{
	Shape s;
	s.kind = ShapeKind::wall;
	s.sense = sense;
	return s;
}

} // namespace

TEST_CASE("the way of a disk ends at the face that its centre would come through, and goes on if it is prescribed")
{
	const double speed = 1000, face = 0.2; // half a step: 0.5 m
	const Body free = stopped(speed, { wall(-1) }, { face }, 1);
	CHECK(free.v[0] == 0);
	CHECK(free.x == doctest::Approx(face - radius).epsilon(1e-14));
	const Body prescribed = stopped(speed, { wall(-1) }, { face }, 0);
	CHECK(prescribed.v[0] == speed);
	CHECK(prescribed.x == doctest::Approx(speed * h).epsilon(1e-14));
}

TEST_CASE("a disk between two faces that have passed each other has all its contacts at one place")
{
	World w;
	const double gap = 0.01; // narrower than the disk's radius
	w.bodies.resize(3);
	w.shapes = { wall(0), wall(-1), {} };
	w.bodies[0].x = -0.2;
	w.bodies[0].v[0] = 2 * (0.2 + 0.5 * gap) / h; // comes over the disk's centre in half a step
	w.bodies[1].x = gap;
	w.bodies[2].radius = radius;
	w.bodies[2].inverseMass[0] = w.bodies[2].inverseMass[1] = 1;
	w.pairs = { { 0, 2 }, { 1, 2 } };
	StepSettings<Plane> s;
	s.dt = h;
	s.solve = findSolver("nsgs");
	TimeStep<Plane> t;
	t.sleepers.update(w);
	t(w, s);
	REQUIRE(t.pairs().size() == 2);
	double centre[2];
	for (int i = 0; i < 2; i++)
		centre[i] = t.touchOf(w, i).cx + (radius - 0.5 * t.touchOf(w, i).overlap) * w.carried[i].nx;
	CHECK(centre[0] == doctest::Approx(centre[1]).epsilon(1e-13));
}

TEST_CASE("fixedIterations are so many sweeps, also where an impact goes on to a contact that was left out at first")
{
	World w = twoDisks(0, 0);
	w.bodies[0].v[0] = 10;
	Body third = w.bodies[1];
	third.x += 2 * radius + 2e-3 * radius;
	w.bodies.push_back(third);
	w.shapes.resize(3);
	w.pairs.push_back({ 1, 2 });
	StepSettings<Plane> s;
	s.dt = h;
	s.solve = findSolver("nsgs");
	s.solver.fixedIterations = 7;
	TimeStep<Plane> t;
	t.sleepers.update(w);
	const StepReport r = t(w, s);
	CHECK(r.contacts == 2);
	CHECK(r.solver.iterations == 7);
}

namespace {

// What a step asked of its solver, call by call.
struct Asked {
	std::vector<int> contacts, maxIterations;
	std::vector<double> lastGuess; // pn of the last contact [N s]
} asked;

// A solver that spends all its sweeps and satisfies the first contact only.
SolverReport stopFirst(ContactSystem<Plane>& system, const SolverSettings& settings)
{
	asked.lastGuess.push_back(system.contacts.back().pn);
	asked.contacts.push_back(static_cast<int>(system.contacts.size()));
	asked.maxIterations.push_back(settings.maxIterations);
	ContactRow<Plane>& c = system.contacts[0];
	c.pn = -relativeVelocity(c, system.bodies[c.a], system.bodies[c.b]).n / c.wnn;
	applyImpulse(c, system.bodies[c.a], system.bodies[c.b], { c.pn, 0 });
	SolverReport report;
	report.iterations = settings.maxIterations;
	report.status = Status::max_iterations;
	return report;
}

} // namespace

TEST_CASE("a contact that only the solution makes starts with the impulse that it needs by itself, and gets a tenth more sweeps")
{
	const double speed = 150, gap = 0.6 * radius; // a disk runs into one at rest; the next one is beyond what a step looks at before the solution
	World w = twoDisks(0, 0);
	w.bodies[0].v[0] = speed;
	w.bodies.push_back(w.bodies[1]);
	w.bodies[2].x += 2 * radius + gap;
	w.shapes.resize(3);
	w.pairs.push_back({ 1, 2 });
	StepSettings<Plane> s;
	s.dt = h;
	s.reduce = false;
	s.solve = stopFirst;
	s.solver.maxIterations = 100;
	asked = {};
	TimeStep<Plane> t;
	t.sleepers.update(w);
	const StepReport r = t(w, s);
	REQUIRE(asked.contacts == std::vector<int> { 1, 2 });
	// Two disks of 1 kg that run into each other at half the speed, of which closing the gap takes gap/h.
	CHECK(asked.lastGuess[1] == doctest::Approx(0.5 * (0.5 * speed - gap / h)).epsilon(1e-11));
	CHECK(asked.maxIterations == std::vector<int> { 100, 11 });
	CHECK(r.solver.iterations == 111);
	CHECK(r.solver.status == Status::max_iterations);
}
