// What counts as solved, and what is named as having no solution, of every method and in both forms of a problem.
#include "error/residual.hpp"
#include "systems.hpp"
#include "solvability/solvability.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

using namespace cd;
using tests::squeezed;
using tests::velocitiesOf;

TEST_CASE("what two walls press together has no solution, whatever the tolerance; the contact is named")
{
	for (const std::string& method : solverNames())
		for (const double tolerance : { 1e-2, 1e-6, 1e-10 })
			for (const int disks : { 1, 2, 10 })
				for (const double mu : { 0., 0.5 }) {
					const auto settings = tests::to(tolerance);
					ContactSystem<Plane> s = squeezed(disks, mu);
					const SolverReport report = findSolver(method)(s, settings);
					CAPTURE(method);
					CAPTURE(tolerance);
					CAPTURE(disks);
					CHECK(name(report.status) == std::string("no_solution"));
					CHECK(report.contact >= 0);
					CHECK(report.contact <= disks);
					CHECK(report.iterations <= settings.maxIterations);
					DelassusSystem d = tests::matrixOf(squeezed(disks, mu));
					const SolverReport ofMatrix = findDelassusSolver(method)(d, settings);
					CHECK(name(ofMatrix.status) == std::string("no_solution"));
					CHECK(ofMatrix.contact >= 0);
				}
}

TEST_CASE("boundaries close in by their velocities and by biases that push, not by the second order of turning faces")
{
	const ContactSystem<Plane> given = squeezed(1, 0);
	const double walls = closingOfBoundaries(given, velocitiesOf(given));
	CHECK(walls > 0);
	ContactSystem<Plane> s = given;
	s.contacts.pushing = false;
	CHECK(closingOfBoundaries(s, velocitiesOf(s)) == walls);
	s = given;
	for (BodyVelocity<Plane>& b : s.bodies)
		std::fill_n(b.v, 3, 0.);
	for (ContactRow<Plane>& c : s.contacts)
		c.bias = -1e-4;
	CHECK(closingOfBoundaries(s, velocitiesOf(s)) == doctest::Approx(1e-4));
	s.contacts.pushing = false;
	CHECK(closingOfBoundaries(s, velocitiesOf(s)) == 0);
}

TEST_CASE("walls that move without squeezing, and heavy loads on light disks, are solved as before")
{
	for (const std::string& method : solverNames()) {
		ContactSystem<Plane> s = squeezed(4, 0.5);
		for (const std::size_t wall : { std::size_t(0), s.bodies.size() - 1 })
			s.bodies[wall].v[0] = 1; // both push to the right
		CHECK(findSolver(method)(s, tests::to(1e-8)).status == Status::converged);
		for (std::size_t i = 1; i + 1 < s.bodies.size(); i++)
			CHECK(s.bodies[i].v[0] == doctest::Approx(1).epsilon(1e-6)); // a hundred times the tolerance, over five contacts
		DelassusSystem pile = tests::matrixOf(tests::lattice(4, 0.3, 1e4, true));
		CHECK(findDelassusSolver("auto")(pile, tests::to(1e-6)).status == Status::converged);
	}
}

TEST_CASE("a self-stress that was there and has nothing to carry is no sign against a solution")
{
	ContactSystem<Plane> s = squeezed(3, 0);
	s.bodies.front().v[0] = 1e-17; // round-off of a step before
	s.bodies.back().v[0] = 1e-17;
	for (ContactRow<Plane>& c : s.contacts)
		c.pn = 1;
	for (const std::string& method : solverNames()) {
		ContactSystem<Plane> again = s;
		CHECK(findSolver(method)(again, tests::to(1e-8)).status == Status::converged);
		CHECK(again.contacts[1].pn == 1);
	}
}

TEST_CASE("a nearly straight column that a boundary presses gives way to the side: its contacts close by ten tolerances at most")
{
	// Impulses a hundred times those of the push keep the column straight, and an error that is small beside them is large beside the push.
	for (const std::string method : { "accelerated", "auto" })
		for (const double tolerance : { 1e-3, 1e-4, 1e-5 }) {
			ContactSystem<Plane> s;
			s.bodies.assign(5, tests::disk(1, 0, -0.01)); // floor, three disks of mass 1, and what presses
			s.bodies[0] = { { 0.3, 0, 0 }, 0, {}, 0 };
			s.bodies[4] = { { 0, -0.18, 0 }, 0, {}, 0 };
			const double tilt[] = { 0, -0.0073, 0.0013, 0.00033 };
			for (int i = 0; i < 4; i++)
				s.contacts.push_back(tests::contact(i, i + 1, tilt[i], std::sqrt(1 - tilt[i] * tilt[i]), 0.3));
			s.assembleBlocks();
			CAPTURE(method);
			CAPTURE(tolerance);
			const SolverReport r = findSolver(method)(s, tests::to(tolerance));
			REQUIRE(name(r.status) == std::string("converged"));
			double closing = 0;
			for (const ContactRow<Plane>& c : s.contacts) {
				const double *a = s.bodies[c.a].v, *b = s.bodies[c.b].v;
				closing = std::max(closing, (a[0] - b[0]) * c.nx + (a[1] - b[1]) * c.ny);
			}
			CHECK(closing <= 10 * tolerance * 0.18);
		}
}

TEST_CASE("an observer who moves along with all boundaries sees the same: as many sweeps, and the same press")
{
	const auto moved = [](ContactSystem<Plane> s, std::vector<std::array<double, 2>> boundaries, double x, double y) {
		s.places.assign(s.bodies.size() - boundaries.size(), { 0, 0 }); // those of bodies that move do not matter
		s.places.insert(s.places.end(), boundaries.begin(), boundaries.end());
		for (BodyVelocity<Plane>& b : s.bodies) {
			b.v[0] += x;
			b.v[1] += y;
		}
		return s;
	};
	for (const std::string& method : solverNames()) {
		CAPTURE(method);
		ContactSystem<Plane> rests = tests::lattice(8, 0.5, 1, true);
		const SolverReport one = findSolver(method)(rests, tests::to(1e-4));
		CHECK(one.status == Status::converged);
		for (const double speed : { 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1. }) { // at one, its power is that of the errors
			CAPTURE(speed);
			ContactSystem<Plane> moves = moved(tests::lattice(8, 0.5, 1, true), { { 8, -1 }, { -1, 8 }, { 17, 8 } }, speed, -speed);
			const SolverReport other = findSolver(method)(moves, tests::to(1e-4));
			CHECK(other.status == Status::converged);
			CHECK(other.iterations == one.iterations);
		}
		ContactSystem<Plane> press = moved(squeezed(4, 0.5), { { 9, 0 } }, 0, 50);
		CHECK(name(findSolver(method)(press, tests::to(1e-6)).status) == std::string("no_solution"));
	}
}

TEST_CASE("the fastest closing of a contact, the growth of the impulses, and numbers that are none")
{
	ContactSystem<Plane> s = squeezed(2, 0);
	const std::vector<double> free = velocitiesOf(s);
	for (ContactRow<Plane>& c : s.contacts)
		c.pn = 1e3;
	const Resolution grown = resolution(s, free);
	CHECK(grown.miss == doctest::Approx(1).epsilon(1e-11));
	CHECK(grown.free == 1);
	CHECK(grown.yields);
	CHECK(grown.growth == doctest::Approx(1e3 * std::sqrt(4. / 2)).epsilon(1e-12)); // W_nn = 1, 2, 1; alone 1 N s at each wall
	s.contacts[1].pn = std::numeric_limits<double>::quiet_NaN();
	CHECK(!resolution(s, free).finite);
	CHECK(resolution(s, free).contact == 1);
	s.contacts[1].pn = 1e200;
	CHECK(!resolution(s, free).finite); // its square is none
}

TEST_CASE("a contact that is free along its normal by round-off alone is not solved, and does not spoil the others")
{
	ContactSystem<Plane> s = squeezed(1, 0.3);
	s.bodies[0].v[0] = 0;
	s.bodies[2].v[0] = 0;
	s.bodies[1].v[0] = -1;
	s.bodies.push_back(s.bodies[1]); // blocked along x
	s.bodies.back().w[0] = s.bodies.back().w[2] = 0;
	ContactRow<Plane> c = s.contacts[0];
	c.b = 3;
	c.ny = std::cos(std::acos(-1) / 2);
	s.contacts.push_back(c);
	s.assembleBlocks();
	CHECK(s.contacts.back().wnn == 0);
	const std::vector<double> free = velocitiesOf(s);
	for (const std::string& method : solverNames()) {
		ContactSystem<Plane> solved = s;
		CHECK(findSolver(method)(solved, tests::to(1e-10)).status == Status::converged);
		CHECK(solved.contacts[0].pn == doctest::Approx(1));
		CHECK(solved.contacts.back().pn == 0);
		CHECK(residual(solved, free).norm <= 1e-10);
	}
}

TEST_CASE("no more sweeps and factorizations than asked for, in any method and form")
{
	for (const std::string& method : solverNames())
		for (const int most : { 1, 2, 3, 7, 12, 50, 101, 130, 600, 1500 }) {
			CAPTURE(method);
			CAPTURE(most);
			for (ContactSystem<Plane> s : { tests::lattice(5, 0.5, 1e6), squeezed(3, 0.3) }) {
				DelassusSystem d = tests::matrixOf(s);
				CHECK(findSolver(method)(s, tests::to(1e-14, most)).iterations <= most);
				CHECK(findDelassusSolver(method)(d, tests::to(1e-14, most)).iterations <= most);
			}
		}
}
