// Newton's method and the automatic choice: exact solutions, plain sweeps as the second way, and problems at which sweeps stagnate.
#include "error/residual.hpp"
#include "systems.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace cd;
using tests::contact;
using tests::disk;
using tests::lattice;
using tests::matrixOf;
using tests::to;

namespace {

const Solver<Plane> solvers[] = { newton, automatic };

double errorOf(const ContactSystem<Plane>& solved, const ContactSystem<Plane>& given) { return residual(solved, tests::velocitiesOf(given)).error(); }

// A disk of unit mass and radius on an immobile floor, at free velocity (vx, vy, 0).
ContactSystem<Plane> diskOnFloor(double mu, double vx, double vy)
{
	ContactSystem<Plane> s;
	s.bodies = { {}, disk(1, vx, vy) };
	s.contacts.push_back(contact(0, 1, 0, 1, mu));
	s.assembleBlocks();
	return s;
}

} // namespace

TEST_CASE("newton, auto: one disk on a floor in each of its states")
{
	for (const Solver<Plane> solver : solvers) {
		// 1e-12: the tolerance asked for.
		ContactSystem<Plane> s = diskOnFloor(0.3, 1, 0.5); // leaves
		CHECK(solver(s, to(1e-12)).status == Status::converged);
		CHECK(s.contacts[0].pn == 0);
		s = diskOnFloor(0.3, 0.6, -1); // p_t = -v_x/W_tt = -0.2 would stop it: rolls
		CHECK(solver(s, to(1e-12)).status == Status::converged);
		CHECK(std::abs(s.contacts[0].pn - 1) < 1e-12);
		CHECK(std::abs(s.contacts[0].pt) == doctest::Approx(0.2).epsilon(1e-12));
		CHECK(std::abs(s.bodies[1].v[0] - 0.4) < 1e-12);
		s = diskOnFloor(0.3, 3, -1); // slides: |p_t| = mu p_n
		CHECK(solver(s, to(1e-12)).status == Status::converged);
		CHECK(std::abs(s.contacts[0].pt) == doctest::Approx(0.3).epsilon(1e-12));
		CHECK(std::abs(s.bodies[1].v[0] - 2.7) < 1e-12);
	}
}

TEST_CASE("newton: a determinate column is solved by factorizations, as by plain sweeps")
{
	// A column of ten disks, each carrying those above: p_n = (10 - i) m g h. Sweeps need hundreds.
	ContactSystem<Plane> s;
	s.bodies.resize(1);
	for (int i = 0; i < 10; i++) {
		s.bodies.push_back(disk(1, 0, -0.01));
		s.contacts.push_back(contact(i, i + 1, 0, 1, 0.3));
	}
	s.assembleBlocks();
	DelassusSystem d = matrixOf(s);
	const SolverReport r = newton(s, to(1e-11)), rd = newton(d, to(1e-11));
	REQUIRE(r.status == Status::converged);
	REQUIRE(rd.status == Status::converged);
	// e = 1e-11 in a column of ten: errors of forces are up to N^2 = 100 times as large.
	for (std::size_t i = 0; i < 10; i++) {
		CHECK(std::abs(s.contacts[i].pn - 0.01 * static_cast<double>(10 - i)) < 1e-9);
		CHECK(std::abs(d.p[2 * i] - 0.01 * static_cast<double>(10 - i)) < 1e-9);
	}
}

TEST_CASE("newton: velocities are those of plain sweeps to 1e-10, at which impulses may differ")
{
	for (const double mu : { 0., 0.1, 0.5 }) {
		const ContactSystem<Plane> given = lattice(6, mu);
		ContactSystem<Plane> a = given, b = given;
		DelassusSystem d = matrixOf(given);
		REQUIRE(newton(a, to(1e-10)).status == Status::converged);
		REQUIRE(newton(d, to(1e-10)).status == Status::converged);
		REQUIRE(nsgs(b, to(1e-10, 200000)).status == Status::converged);
		CHECK(errorOf(a, given) <= 1e-10);
		CHECK(residual(d).error() <= 1e-10);
		// Nothing moves in a lattice at rest. Velocities are impulses over masses, of order 0.1: 1e-8 is a hundred times the error asked for.
		for (std::size_t i = 0; i < a.bodies.size(); i++)
			for (int k = 0; k < 3; k++)
				CHECK(std::abs(a.bodies[i].v[k] - b.bodies[i].v[k]) < 1e-8);
	}
}

TEST_CASE("newton solves where sweeps stagnate: a heavy load on light disks; auto finds that out")
{
	for (const double mu : { 0.3, 0.5 }) {
		const ContactSystem<Plane> given = lattice(10, mu, 1e5, true);
		ContactSystem<Plane> a = given, n = given, both = given;
		CAPTURE(mu);
		const SolverReport ra = accelerated(a, to(1e-8, 5000));
		REQUIRE(ra.status != Status::converged);
		const SolverReport rn = newton(n, to(1e-8, 5500));
		CHECK(rn.status == Status::converged);
		CHECK(rn.factorizations > 0);
		CHECK(errorOf(n, given) <= 1e-8);
		const SolverReport rb = automatic(both, to(1e-8, 5500));
		CHECK(rb.status == Status::converged);
		CHECK(solvedBy("auto", rb) == "newton");
		CHECK(errorOf(both, given) <= 1e-8);
		CHECK(rb.iterations <= 5500);
	}
}

TEST_CASE("auto: where Newton's method ends by its limit of operations, plain sweeps use the iterations that it leaves")
{
	ContactSystem<Plane> s = lattice(20, 0.3, 1e6, true); // Newton's method gets through some 400 of its 3000 steps
	const SolverReport report = findSolver("auto")(s, to(1e-12));
	CHECK(report.factorizations > 0);
	CHECK(report.factorizations < 3000);
	CHECK(report.status == Status::max_iterations);
	CHECK(report.iterations == to(1e-12).maxIterations);
}

TEST_CASE("newton, auto: the same bits each time; the error is never larger than that of sweeps alone")
{
	for (const ContactSystem<Plane>& given : { lattice(8, 0.5, 1e6), lattice(8, 0.8, 1e6), lattice(8, 0.5, 1e6, true) }) {
		for (const Solver<Plane> solver : solvers) {
			ContactSystem<Plane> a = given, b = given;
			const SolverReport ra = solver(a, to(1e-9, 3000)), rb = solver(b, to(1e-9, 3000));
			CHECK(ra.factorizations > 0);
			CHECK(ra.iterations == rb.iterations);
			for (std::size_t i = 0; i < a.contacts.size(); i++) {
				CHECK(a.contacts[i].pn == b.contacts[i].pn);
				CHECK(a.contacts[i].pt == b.contacts[i].pt);
			}
		}
		ContactSystem<Plane> sweeps = given, both = given;
		CHECK(automatic(both, to(1e-9, 3000)).error < accelerated(sweeps, to(1e-9, 2500)).error); // 2500: what auto leaves to sweeps
	}
}

TEST_CASE("newton solves lattices with gaps from forces out of balance, as sweeps do")
{
	// The second is not solved without following paths; without a centre that stays, either.
	const struct {
		int rows;
		double mu;
		unsigned seed;
	} cases[] = { { 6, 0.5, 1 }, { 6, 0.5, 2 }, { 10, 0.5, 1 }, { 8, 0.5, 2 } };
	for (const auto& made : cases) {
		ContactSystem<Plane> given = lattice(made.rows, made.mu);
		std::mt19937 random(made.seed);
		std::uniform_real_distribution<double> unit(0, 1);
		for (ContactRow<Plane>& c : given.contacts) {
			if (unit(random) < 0.15)
				c.bias = 0.002 * unit(random);
			c.pn = 0.01 * made.rows * unit(random);
			c.pt = c.mu * c.pn * (2 * unit(random) - 1);
		}
		ContactSystem<Plane> s = given, sweeps = given, both = given;
		CAPTURE(made.rows);
		CAPTURE(made.seed);
		CHECK(newton(s, to(1e-9, 3000)).status == Status::converged);
		CHECK(errorOf(s, given) <= 1e-9);
		CHECK(accelerated(sweeps, to(1e-9, 30000)).status == Status::converged);
		CHECK(errorOf(sweeps, given) <= 1e-9);
		CHECK(automatic(both, to(1e-9, 10000)).status == Status::converged);
		CHECK(errorOf(both, given) <= 1e-9);
	}
}

TEST_CASE("auto: what sweeps solve is theirs to the last bit; fixed sweeps are plain")
{
	ContactSystem<Plane> a = lattice(6, 0.3), b = a, c = a;
	const SolverReport ra = accelerated(a, to(1e-8)), rb = automatic(b, to(1e-8));
	CHECK(ra.iterations == rb.iterations);
	CHECK(solvedBy("auto", rb) == "accelerated");
	for (std::size_t i = 0; i < a.contacts.size(); i++)
		CHECK(a.contacts[i].pn == b.contacts[i].pn);
	SolverSettings fixed;
	fixed.fixedIterations = 7;
	ContactSystem<Plane> d = c;
	for (const Solver<Plane> solver : solvers) {
		c = d;
		CHECK(solver(c, fixed).status == Status::fixed_iterations);
		CHECK(solver(c, fixed).iterations == 7);
	}
}

TEST_CASE("newton, auto: out of iterations, the best iterate is kept, with its velocities")
{
	const ContactSystem<Plane> given = lattice(10, 0.5, 1e6);
	for (const int most : { 2, 50, 505, 520, 600 })
		for (const Solver<Plane> solver : solvers) {
			ContactSystem<Plane> a = given, s = given;
			CAPTURE(most);
			const SolverReport sweeps = accelerated(a, to(1e-12, most));
			const SolverReport r = solver(s, to(1e-12, most));
			CHECK(r.status == Status::max_iterations);
			CHECK(r.iterations <= most);
			CHECK(solvedBy("newton", r) == "none");
			CHECK(errorOf(s, given) == doctest::Approx(r.error).epsilon(1e-12)); // sums in another order
			if (most > 500 && solver == solvers[0]) {
				ContactSystem<Plane> start = given;
				CHECK(r.error <= accelerated(start, to(1e-3, 500)).error);
			}
			if (r.factorizations == 0)
				CHECK(r.iterations <= sweeps.iterations);
			std::vector<BodyVelocity<Plane>> expected = given.bodies;
			for (const ContactRow<Plane>& c : s.contacts)
				applyImpulse(c, expected[static_cast<std::size_t>(c.a)], expected[static_cast<std::size_t>(c.b)], impulseOf(c));
			for (std::size_t i = 0; i < expected.size(); i++)
				CHECK(s.bodies[i].v[1] == doctest::Approx(expected[i].v[1]).epsilon(1e-12));
		}
}

TEST_CASE("newton, auto: nothing to solve, nothing solvable, numbers that are none")
{
	for (const std::string name : { "newton", "auto" }) {
		const Solver<Plane> solver = name == "newton" ? solvers[0] : solvers[1];
		ContactSystem<Plane> none;
		CHECK(solver(none, to(1e-8)).status == Status::converged);
		none = lattice(3, 0.3); // all open
		for (BodyVelocity<Plane>& b : none.bodies)
			b.v[1] = 0;
		for (ContactRow<Plane>& c : none.contacts)
			c.bias = 1;
		CHECK(solver(none, to(1e-8)).status == Status::converged);
		CHECK(std::all_of(none.contacts.begin(), none.contacts.end(), [](const ContactRow<Plane>& c) { return c.pn == 0 && c.pt == 0; }));
		ContactSystem<Plane> still = lattice(3, 0.3); // two immobile bodies pressed together beside it
		ContactRow<Plane> pressed = contact(9, 10, 1, 0, 0);
		pressed.bias = -1;
		still.contacts.push_back(pressed);
		std::rotate(still.contacts.begin(), still.contacts.end() - 1, still.contacts.end());
		still.assembleBlocks();
		CHECK(solver(still, to(1e-8)).status == Status::converged);
		ContactSystem<Plane> broken = lattice(3, 0.3);
		broken.bodies[4].v[0] = std::nan("");
		CHECK(solver(broken, to(1e-8)).status == Status::diverged);
		ContactSystem<Plane> jammed = tests::squeezed(1, 0.3);
		// The method alone may be content with impulses that have grown until its error, relative to them, is small.
		CHECK(findSolver(name)(jammed, to(1e-8)).status == Status::no_solution);
	}
	DelassusSystem none = matrixOf({});
	CHECK(newton(none, to(1e-8)).status == Status::converged);
	CHECK(automatic(none, to(1e-8)).status == Status::converged);
}
