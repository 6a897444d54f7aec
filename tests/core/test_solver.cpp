// nsgs against problems solved by hand and against its own independent error.
#include "systems.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace cd;
using tests::column;
using tests::contact;
using tests::disk;
using tests::to;

TEST_CASE("solutions satisfy the laws, contact by contact")
{
	for (const bool arms : { false, true })
		for (const double mu : { 0., 0.3, 0.8 })
			for (unsigned seed = 1; seed <= 10; seed++) {
				ContactSystem<Plane> s = column(seed, 8, 12, mu, arms);
				const SolverReport r = nsgs(s, to(1e-11, 200000));
				CAPTURE(seed);
				CAPTURE(mu);
				CAPTURE(arms);
				REQUIRE(r.status == Status::converged);
				for (const ContactRow<Plane>& c : s.contacts) {
					auto [un, ut] = relativeVelocity(c, s.bodies[c.a], s.bodies[c.b]);
					un += c.bias;
					CHECK(c.pn >= 0);
					CHECK(un >= -1e-8);
					CHECK(std::abs(c.pn * un) < 1e-8);
					CHECK(std::abs(c.pt) <= c.mu * c.pn * (1 + 1e-9));
					if (std::abs(ut) > 1e-6 && c.pn > 1e-6)
						CHECK(c.pt == doctest::Approx(-std::copysign(c.mu * c.pn, ut)).epsilon(1e-5));
				}
			}
}

TEST_CASE("a first guess is swept once if a contact has an impulse that its own law would take, however small")
{
	// A disk rests on a floor, and parts from a wall that still pushes it with a ten millionth of its weight; or it touches a wall that does not.
	for (const Solver<Plane> method : std::initializer_list<Solver<Plane>> { nsgs, accelerated, automatic })
		for (const double speed : { 1e-3, 0. }) {
			ContactSystem<Plane> s;
			s.bodies = { BodyVelocity<Plane> {}, disk(1, speed, -1) };
			s.contacts.push_back(contact(0, 1, 0, 1, 0));
			s.contacts.push_back(contact(0, 1, 1, 0, 0));
			s.assembleBlocks();
			s.contacts[0].pn = 1;
			s.contacts[1].pn = speed > 0 ? 1e-7 : 0;
			const SolverReport r = method(s, to(1e-6));
			CHECK(r.status == Status::converged);
			CHECK(r.iterations == (speed > 0));
			CHECK(s.contacts[1].pn == 0);
			CHECK(s.bodies[1].v[0] == doctest::Approx(speed).epsilon(1e-12));
		}
}

TEST_CASE("one contact is solved in one sweep, with any arms")
{
	for (unsigned seed = 1; seed <= 50; seed++) {
		ContactSystem<Plane> s = column(seed, 2, 1, 0.4, true);
		s.contacts[0].bias = 0;
		SolverSettings settings;
		settings.fixedIterations = 1;
		const SolverReport r = nsgs(s, settings);
		CHECK(r.iterations == 1);
		CHECK((r.residual < 1e-12 || s.contacts[0].pn == 0));
	}
}

TEST_CASE("the order of sweeps changes the way, not the solution of a determinate problem")
{
	SolverSettings settings = to(1e-12, 200000);
	ContactSystem<Plane> a = column(3, 6, 5, 0.3, false), b = a;
	nsgs(a, settings);
	settings.seed = 42;
	nsgs(b, settings);
	for (size_t i = 0; i < a.contacts.size(); i++)
		CHECK(a.contacts[i].pn == doctest::Approx(b.contacts[i].pn).epsilon(1e-8));
}

TEST_CASE("status tells how it ended")
{
	SolverSettings settings = to(1e-14, 3);
	ContactSystem<Plane> s = column(5, 8, 12, 0.3, false);
	CHECK(nsgs(s, settings).status == Status::max_iterations);
	settings.fixedIterations = 5;
	CHECK(nsgs(s, settings).status == Status::fixed_iterations);
	CHECK(nsgs(s, settings).iterations == 5);
	s.bodies[2].v[0] = std::nan("");
	settings.fixedIterations = 0;
	CHECK(nsgs(s, settings).status == Status::diverged);
}

TEST_CASE("velocities returned belong to the impulses returned")
{
	ContactSystem<Plane> s = column(7, 8, 12, 0.5, true);
	const auto start = s.bodies;
	nsgs(s, {});
	auto expected = start;
	for (const ContactRow<Plane>& c : s.contacts)
		applyImpulse(c, expected[c.a], expected[c.b], impulseOf(c));
	for (size_t i = 0; i < expected.size(); i++)
		for (int k = 0; k < 3; k++)
			CHECK(s.bodies[i].v[k] == doctest::Approx(expected[i].v[k]).epsilon(1e-13));
}

TEST_CASE("impulses that stopped bodies in the step before do not throw them back when there is nothing left to carry")
{
	for (const char* method : { "nsgs", "accelerated", "auto" })
		for (const double guess : { 8.33, 1e6 }) {
			ContactSystem<Plane> s;
			s.bodies.resize(1);
			for (int i = 0; i < 2; i++) {
				s.bodies.push_back(disk(1, 0, -1.8e-15 * (i + 1))); // what the stop left of 8 m/s
				ContactRow<Plane> c = contact(i, i + 1, 0, 1, 0.3);
				c.pn = guess * (2 - i);
				c.pt = 0.1 * guess;
				s.contacts.push_back(c);
			}
			s.assembleBlocks();
			const SolverReport report = findSolver(method)(s, {});
			CAPTURE(method);
			CHECK(report.status == Status::converged);
			for (const BodyVelocity<Plane>& b : s.bodies)
				CHECK(std::abs(b.v[1]) <= 4e-15); // of the order of the velocities given, not of the guess
		}
}

namespace {

// Disks on a floor, each an island of its own: the first is pressed on it, nothing acts on the others. v: their velocities; p: the first guess of
// all.
ContactSystem<Plane> besideALoad(std::initializer_list<double> v, double p)
{
	ContactSystem<Plane> s;
	s.bodies = { {}, disk(1, 0, -1) };
	s.bodies[1].pushed = 1;
	for (const double vy : v)
		s.bodies.push_back(disk(1, 0, vy));
	for (std::size_t i = 1; i < s.bodies.size(); i++) {
		s.contacts.push_back(contact(0, static_cast<int>(i), 0, 1, 0.3));
		s.contacts.back().pn = p;
	}
	s.assembleBlocks();
	return s;
}

} // namespace

TEST_CASE("a disk on which nothing acts is stopped by a floor, too, whatever other islands bear")
{
	for (const char* method : { "nsgs", "accelerated", "newton", "auto" })
		for (const double guess : { 0., 1., 8.33 })
			for (const double v : { -1e-3, -1e-9, -1e-12, -1e-17, -1e-30 }) {
				ContactSystem<Plane> s = besideALoad({ v, -v, 3 * v }, guess);
				CAPTURE(method);
				CAPTURE(guess);
				CAPTURE(v);
				const SolverReport report = findSolver(method)(s, to(1e-2));
				CHECK(report.status == Status::converged);
				CHECK(report.iterations < 100);
				CHECK(std::abs(s.bodies[2].v[1]) <= 1e-2 * std::abs(v));
				CHECK(std::abs(s.bodies[3].v[1] + v) <= 1e-2 * std::abs(v));
				CHECK(std::abs(s.bodies[4].v[1]) <= 3e-2 * std::abs(v));
			}
}

TEST_CASE("momentum past zero impulses does not end in them")
{
	for (const char* method : { "accelerated", "newton", "auto" }) {
		// A light disk creeps into the floor. It carried a heavier one that now leaves.
		ContactSystem<Plane> s = besideALoad({ -1e-9, 0.3 }, 1);
		for (int k = 0; k < 3; k++) {
			s.bodies[2].w[k] *= 40;
			s.bodies[3].w[k] *= 1.4;
		}
		s.contacts[1].pn = 0.0045;
		ContactRow<Plane>& between = s.contacts[2];
		between.a = 3;
		between.b = 2;
		between.nx = 0.6;
		between.ny = -0.8;
		between.pn = 0.1;
		for (ContactRow<Plane>& c : s.contacts)
			c.bt = c.mu = 0;
		s.assembleBlocks();
		const SolverReport report = findSolver(method)(s, to(1e-6));
		CAPTURE(method);
		CHECK(report.status == Status::converged);
		CHECK(report.iterations < 100);
		CHECK(std::abs(s.bodies[2].v[1]) <= 1e-14);
		CHECK(std::abs(s.bodies[3].v[1] - 0.3) <= 1e-14);
	}
}
