// What sleeps on is not looked at, and nothing of it shows: steps that look at everything are the same to the last bit.
#include "step/time_step.hpp"
#include "worlds.hpp"

#include <algorithm>
#include <doctest/doctest.h>
#include <functional>
#include <random>

using namespace cd;

namespace {

constexpr double radius = 0.01, gravity = 9.81, h = 1e-3;

// A floor; columns of disks on it, the last between two fixed disks and under a press; a disk that flies. Everything is a pair with everything.
struct Scene {
	World world;
	int columns, fixed, press, flyer;

	explicit Scene(int columns, int height = 3)
	    : columns(columns)
	{
		boundary(ShapeKind::wall);
		for (int i = 0; i < columns; i++)
			for (int k = 0; k < height; k++)
				disk(0.05 * i, (2 * k + 1) * radius);
		fixed = disk(0.05 * columns - 0.05 - 2 * radius, radius);
		std::fill_n(world.bodies[fixed].inverseMass, 3, 0.);
		world.bodies[fixed].force[1] = 0;
		press = boundary(ShapeKind::box);
		world.bodies[press].x = 0.05 * (columns - 1);
		world.bodies[press].y = 2 * radius * height + radius;
		world.bodies[press].inverseMass[1] = 1;
		world.bodies[press].force[1] = -100;
		flyer = disk(-1, 1);
		for (Body& b : world.bodies)
			b.friction = 0.5;
		for (int a = 0; a < static_cast<int>(world.bodies.size()); a++)
			for (int b = 0; b < static_cast<int>(world.bodies.size()); b++)
				if (world.bodies[b].radius > 0 && (world.bodies[a].radius == 0 || a < b))
					world.pairs.push_back({ a, b, 0.5 });
	}

	int boundary(ShapeKind kind)
	{
		Shape shape { kind, radius, radius };
		shape.axis = 1;
		return tests::add(world, {}, shape);
	}

	int disk(double x, double y)
	{
		Body b = tests::diskAt(x, y, radius);
		b.force[1] = -gravity;
		return tests::add(world, b);
	}
};

struct Run {
	World world;
	bool looksAtAll; // in every step
	TimeStep<Plane> step;
	StepSettings<Plane> settings;
	StepReport report;

	Run(const World& w, bool looksAtAll)
	    : world(w)
	    , looksAtAll(looksAtAll)
	{
		settings.dt = h;
		settings.solve = findSolver("auto");
		settings.solver.tolerance = 1e-6;
	}

	void go()
	{
		if (looksAtAll)
			step.sleepers.wakeAll(world);
		else
			step.sleepers.update(world);
		for (Pair& pair : world.pairs)
			pair.mu = std::min(world.bodies[pair.a].friction, world.bodies[pair.b].friction);
		step.rest.trialAt = step.rest.steps; // a trial in every step
		step.rest.pause = 400;
		report = step(world, settings);
		step.rest.loadsBefore = step.rest.loads;
	}

	// What a user sees of a step.
	std::vector<double> seen()
	{
		std::vector<double> all;
		for (std::size_t i = 0; i < world.bodies.size(); i++) {
			const Body& b = world.bodies[i];
			all.insert(all.end(), { b.x, b.y, b.turn, b.v[0], b.v[1], b.v[2] });
			const std::array<double, 3>& impulse = step.impulsesOn(world)[i];
			all.insert(all.end(), impulse.begin(), impulse.end());
		}
		for (const Carried& of : world.carried)
			all.insert(all.end(), { of.fn[0], of.fn[1], of.ft[0], of.ft[1] });
		const Effort& e = report.effort;
		for (const int count : { report.contacts, report.loadedContacts, report.slidingContacts, report.solver.iterations, e.unknowns,
			 e.islands, e.resting, e.sleeping, e.provenAtRest, e.notAtRest })
			all.push_back(count);
		all.insert(
		    all.end(), { report.solver.residual, report.solver.residualMax, report.solver.error, report.maxPenetration, report.dissipated });
		return all;
	}

	std::size_t pairsLookedAt() const { return world.awake.size(); }
};

} // namespace

TEST_CASE("what sleeps on is not looked at, and what touches it wakes it")
{
	Scene scene(5);
	std::fill_n(scene.world.bodies[scene.flyer].inverseMass, 3, 0.);
	Run run(scene.world, false);
	for (int i = 0; i < 50; i++)
		run.go();
	CHECK(run.report.effort.sleeping == 5);
	CHECK(run.report.effort.islands == 5);
	CHECK(run.report.contacts == 5 * 3 + 3); // the fixed disk touches a disk and the floor, the press a disk
	CHECK(run.report.effort.unknowns == 5 * 3 * 3 + 1);
	CHECK(run.pairsLookedAt() == 3); // of the floor, the fixed disk and the flyer
	Body& faller = run.world.bodies[scene.flyer];
	faller = run.world.bodies[1];
	faller.x = 0.05;
	faller.y = 0.1;
	int steps = 0, awake = 5;
	for (; awake == 5 && steps < 1000; steps++) {
		run.go();
		awake = run.report.effort.sleeping;
	}
	CHECK(awake == 4);
	CHECK(steps * h == doctest::Approx(std::sqrt(2 * (0.1 - 7 * radius) / gravity)).epsilon(0.03));
}

TEST_CASE("what has been woken for one look is left alone again after it")
{
	Run run(Scene(10).world, false);
	for (int i = 0; i < 50; i++)
		run.go();
	const std::size_t before = run.pairsLookedAt();
	run.step.sleepers.wakeAll(run.world);
	run.go();
	CHECK(run.pairsLookedAt() == run.world.pairs.size());
	run.go();
	CHECK(run.pairsLookedAt() == before);
}

TEST_CASE("changes of every kind wake what they concern")
{
	Scene scene(4);
	const auto looksAgain = [&](const std::function<void(Run&)>& change) {
		Run run(scene.world, false);
		std::fill_n(run.world.bodies[scene.flyer].inverseMass, 3, 0.);
		for (int i = 0; i < 50; i++)
			run.go();
		REQUIRE(run.report.effort.sleeping == 4);
		const std::size_t before = run.pairsLookedAt();
		change(run);
		run.go();
		return run.pairsLookedAt() > before + 10;
	};
	CHECK(!looksAgain([](Run&) {}));
	CHECK(looksAgain([](Run& r) { r.world.bodies[1].v[0] = 1e-3; }));
	CHECK(looksAgain([](Run& r) { r.world.bodies[2].y += 1e-2; }));
	CHECK(looksAgain([](Run& r) { r.world.bodies[3].force[0] = 1; }));
	CHECK(looksAgain([](Run& r) { r.world.bodies[3].friction = 0.4; }));
	CHECK(!looksAgain([](Run& r) { r.world.bodies[0].force[0] = 1; })); // which cannot move
	CHECK(looksAgain([](Run& r) { r.world.bodies[3].inverseMass[1] *= 0.5; }));
	CHECK(looksAgain([](Run& r) { r.world.bodies[3].radius *= 1.1; }));
	CHECK(looksAgain([&](Run& r) { r.world.bodies[scene.press].force[1] = -200; }));
	CHECK(looksAgain([&](Run& r) { r.world.bodies[scene.fixed].y = -1; }));
	CHECK(looksAgain([](Run& r) { r.world.bodies[0].y -= 1e-3; }));
	CHECK(looksAgain([](Run& r) { r.world.bodies[0].v[1] = -1; }));
	CHECK(looksAgain([](Run& r) { r.world.shapes[0].axis = 0; }));
}

TEST_CASE("a body beside a sleeping one, that nothing holds any more, falls")
{
	// Both can only fall; along the normal of their contact neither can move, so it carries nothing.
	Scene scene(0);
	World& world = scene.world;
	const int held = scene.disk(2, 1), beside = scene.disk(2 + 2 * radius, 1);
	for (const int body : { held, beside })
		world.bodies[body].inverseMass[0] = world.bodies[body].inverseMass[2] = 0;
	const int below = scene.disk(2, 1 - 2 * radius), support = scene.disk(2 + 2 * radius, 1 - 2 * radius);
	for (const int body : { below, support, scene.flyer, scene.press })
		std::fill_n(world.bodies[body].inverseMass, 3, 0.);
	world.pairs = { { held, beside, 0.5 }, { held, below, 0.5 }, { beside, support, 0.5 } };
	Run run(world, false);
	for (int i = 0; i < 20; i++)
		run.go();
	REQUIRE(run.report.effort.sleeping == 2);
	run.world.bodies[support].y = 0;
	for (int i = 0; i < 20; i++)
		run.go();
	CHECK(run.world.bodies[beside].v[1] == doctest::Approx(-20 * h * gravity));
}

TEST_CASE("a contact that cannot push wakes nothing, and is counted whatever its bodies do")
{
	// A disk that moves along the side of the press, which can move up and down only. The disk stops and goes on.
	Scene scene(2);
	Body& flyer = scene.world.bodies[scene.flyer];
	std::fill_n(flyer.inverseMass, 3, 0.);
	flyer.x = scene.world.bodies[scene.press].x + 2 * radius;
	flyer.y = scene.world.bodies[scene.press].y;
	Run all(scene.world, true), some(scene.world, false);
	std::size_t woken = 0;
	for (int i = 0; i < 200; i++) {
		CAPTURE(i);
		for (Run* run : { &all, &some }) {
			run->world.bodies[scene.flyer].v[1] = i >= 50 && i / 25 % 2 ? 1e-2 : 0;
			run->go();
		}
		REQUIRE(all.seen() == some.seen());
		woken += some.step.sleepers.woken().what != nullptr;
		some.step.sleepers.forgetWoken();
	}
	CHECK(some.report.effort.sleeping == 2);
	CHECK(some.report.contacts == 2 * 3 + 4); // the fixed disk touches a disk and the floor, the press a disk and the flyer
	CHECK(woken == 0);
}

TEST_CASE("nothing shows of what is not looked at, whatever happens")
{
	std::size_t looked = 0, slept = 0, steps = 0;
	for (unsigned seed = 0; seed < 12; seed++) {
		CAPTURE(seed);
		std::mt19937 random(seed);
		const auto draw = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
		Scene scene(6);
		Run all(scene.world, true), some(scene.world, false);
		for (Run* run : { &all, &some })
			run->settings.restitution = seed % 4 == 3 ? 0.3 : 0;
		for (int i = 0; i < 1500; i++) {
			CAPTURE(i);
			const bool happens = draw(40) == 0;
			const int kind = draw(8), body = 1 + draw(18);
			const double size = std::pow(10., -draw(9));
			for (Run* run : { &all, &some }) {
				World& w = run->world;
				if (w.bodies[0].v[1] != 0) // the floor moves for one step at a time
					w.bodies[0].v[1] = 0;
				if (!happens)
					continue;
				switch (kind) {
				case 0:
					w.bodies[body].v[0] += size;
					break;
				case 1:
					w.bodies[body].force[0] += size;
					break;
				case 2:
					w.bodies[scene.press].force[1] -= size;
					break;
				case 3:
					w.bodies[0].v[1] = -1e-2 * size;
					break;
				case 4:
					w.bodies[body].friction = body % 2 ? 0.4 : 0.6;
					break;
				case 5:
					w.bodies[scene.flyer].x = 0.01 * body;
					w.bodies[scene.flyer].y = 0.2;
					w.bodies[scene.flyer].v[1] = 10 * size;
					break;
				case 6:
					w.bodies[scene.fixed].x += 1e-2 * size;
					break;
				default:
					w.bodies[0].y -= 1e-4 * size;
				}
			}
			all.go();
			some.go();
			looked += some.pairsLookedAt();
			steps++;
			slept += static_cast<std::size_t>(some.report.effort.sleeping);
			REQUIRE(all.seen() == some.seen());
		}
	}
	CHECK(slept > steps); // of six islands
	CHECK(looked < 0.9 * steps * Scene(6).world.pairs.size());
}
