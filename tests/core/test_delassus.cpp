// A problem given by its matrix and the same one in the bodies' velocities are one problem.
#include "error/residual.hpp"
#include "systems.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace cd;

TEST_CASE("both forms of a problem have one error and, solved, one solution")
{
	for (const std::string& method : solverNames())
		for (const double mu : { 0., 0.4 }) {
			ContactSystem<Plane> s = tests::column(5, 9, 8, mu, true);
			const std::vector<double> free = tests::velocitiesOf(s);
			DelassusSystem d = tests::matrixOf(s);
			const SolverSettings settings = tests::to(1e-12, 200000);
			CAPTURE(method);
			CAPTURE(mu);
			REQUIRE(findSolver(method)(s, settings).status == Status::converged);
			const SolverReport r = findDelassusSolver(method)(d, settings);
			REQUIRE(r.status == Status::converged);
			CHECK(residual(d).norm == r.residual);
			// One contact a body: a tree of contacts, whose impulses are determined.
			for (std::size_t i = 0; i < d.contacts(); i++) {
				CHECK(std::abs(d.p[2 * i] - s.contacts[i].pn) < 1e-9);
				CHECK(std::abs(d.p[2 * i + 1] - s.contacts[i].pt) < 1e-9);
				s.contacts[i].pn = d.p[2 * i];
				s.contacts[i].pt = d.p[2 * i + 1];
			}
			CHECK(residual(s, free).norm < 1e-11);
			// Away from the solution, too.
			for (std::size_t i = 0; i < d.contacts(); i++)
				s.contacts[i].pn = d.p[2 * i] += 0.1 * static_cast<double>(i);
			CHECK(residual(d).norm == doctest::Approx(residual(s, free).norm).epsilon(1e-12));
			CHECK(residual(d).energy == doctest::Approx(residual(s, free).energy).epsilon(1e-12));
			CHECK(residual(d).maximum == doctest::Approx(residual(s, free).maximum).epsilon(1e-12));
		}
}

TEST_CASE("a matrix problem with a number that is not finite diverges")
{
	DelassusSystem a = tests::matrixOf(tests::column(7, 8, 20, 0.3, true));
	a.q[3] = std::nan("");
	CHECK(nsgs(a, {}).status == Status::diverged);
}

TEST_CASE("a matrix without contacts is solved")
{
	DelassusSystem none = tests::matrixOf({});
	CHECK(accelerated(none, {}).status == Status::converged);
	CHECK(residual(none).norm == 0);
}
