// A problem given by its matrix and the same one in the bodies' velocities are one problem.
#include "delassus_system.hpp"
#include "residual.hpp"
#include "solver.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace cd;

namespace {

// Bodies in a chain with cross links, body 0 immobile; general arms couple n and t. One contact joins two bodies twice.
ContactSystem randomSystem(unsigned seed, int bodies, int contacts, double mu)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(0, 1);
	ContactSystem s;
	s.bodies.resize(bodies);
	for (int i = 1; i < bodies; i++) {
		BodyVelocity& b = s.bodies[i];
		b.w[0] = 0.5 + unit(random);
		b.w[1] = 0.5 + unit(random);
		b.w[2] = 2 + unit(random);
		for (double& v : b.v)
			v = unit(random) - 0.5;
	}
	for (int k = 0; k < contacts; k++) {
		ContactRow c {};
		c.b = 1 + k % (bodies - 1);
		c.a = std::max(0, c.b - 1 - k / (bodies - 1));
		const double angle = 6.28 * unit(random);
		c.nx = std::cos(angle);
		c.ny = std::sin(angle);
		c.an = 0.3 * unit(random);
		c.at = 0.5 + unit(random);
		c.bn = 0.3 * unit(random);
		c.bt = -0.5 - unit(random);
		c.mu = mu;
		c.bias = 0.1 * unit(random);
		s.contacts.push_back(c);
	}
	s.assembleBlocks();
	return s;
}

std::vector<double> freeVelocity(const ContactSystem& s)
{
	std::vector<double> v;
	for (const BodyVelocity& b : s.bodies)
		v.insert(v.end(), b.v, b.v + 3);
	return v;
}

} // namespace

TEST_CASE("W p + q is the relative velocity that the impulses give the bodies")
{
	ContactSystem s = randomSystem(1, 8, 20, 0.3);
	const DelassusSystem d = assembleDelassus(s);
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(-1, 1);
	std::vector<double> p;
	for (const ContactRow& c : s.contacts) {
		p.push_back(unit(random));
		p.push_back(unit(random));
		applyImpulse(c, s.bodies[c.a], s.bodies[c.b], p[p.size() - 2], p.back());
	}
	for (std::size_t i = 0; i < d.contacts(); i++) {
		double u[2] = { d.q[2 * i], d.q[2 * i + 1] };
		for (std::size_t k = d.start[i]; k < d.start[i + 1]; k++) {
			const double n = p[2 * d.column[k]], t = p[2 * d.column[k] + 1];
			u[0] += d.blocks[k].nn * n + d.blocks[k].nt * t;
			u[1] += d.blocks[k].tn * n + d.blocks[k].tt * t;
		}
		double un, ut;
		const ContactRow& c = s.contacts[i];
		relativeVelocity(c, s.bodies[c.a], s.bodies[c.b], un, ut);
		// Sums of some twenty terms of order one: 1e-13 is their round-off.
		CHECK(std::abs(u[0] - un - c.bias) < 1e-13);
		CHECK(std::abs(u[1] - ut) < 1e-13);
	}
}

TEST_CASE("W is symmetric to the last bit and holds each contact's own block on its diagonal")
{
	const ContactSystem s = randomSystem(3, 6, 15, 0.3);
	const DelassusSystem d = assembleDelassus(s);
	for (std::size_t i = 0; i < d.contacts(); i++) {
		const Block& own = d.blocks[d.diagonal[i]];
		CHECK(own.nn == doctest::Approx(s.contacts[i].wnn).epsilon(1e-14));
		CHECK(own.tt == doctest::Approx(s.contacts[i].wtt).epsilon(1e-14));
		CHECK(own.nt == doctest::Approx(s.contacts[i].wnt).epsilon(1e-13));
		for (std::size_t k = d.start[i]; k < d.start[i + 1]; k++) {
			CHECK((k == d.start[i] || d.column[k - 1] < d.column[k]));
			bool found = false;
			const int32_t j = d.column[k];
			for (std::size_t l = d.start[j]; l < d.start[j + 1]; l++)
				if (d.column[l] == static_cast<int32_t>(i)) {
					found = true;
					CHECK(d.blocks[l].nn == d.blocks[k].nn);
					CHECK(d.blocks[l].tn == d.blocks[k].nt);
					CHECK(d.blocks[l].tt == d.blocks[k].tt);
				}
			CHECK(found);
		}
	}
}

TEST_CASE("both forms of a problem have one error and, solved, one solution")
{
	for (const std::string& method : solverNames())
		for (const double mu : { 0., 0.4 }) {
			ContactSystem s = randomSystem(5, 9, 8, mu);
			const std::vector<double> free = freeVelocity(s);
			DelassusSystem d = assembleDelassus(s);
			SolverSettings settings;
			settings.tolerance = 1e-12;
			settings.maxIterations = 200000;
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

TEST_CASE("fixed iterations, order and status of the matrix form")
{
	SolverSettings settings;
	settings.fixedIterations = 7;
	settings.seed = 3;
	DelassusSystem a = assembleDelassus(randomSystem(7, 8, 20, 0.3)), b = a, c = a;
	CHECK(nsgs(a, settings).status == Status::fixed_iterations);
	CHECK(accelerated(b, settings).iterations == 7);
	CHECK(a.p == b.p); // plain sweeps whatever the method, the same order for the same seed
	settings.seed = 4;
	nsgs(c, settings);
	CHECK(a.p != c.p);
	c.q[3] = std::nan("");
	CHECK(nsgs(c, settings).status == Status::diverged);
}

TEST_CASE("contacts between two immobile bodies have no place in W; none at all is solved")
{
	ContactSystem s = randomSystem(9, 4, 3, 0.3);
	ContactRow still {};
	still.nx = 1;
	s.contacts.push_back(still);
	std::rotate(s.contacts.begin(), s.contacts.end() - 1, s.contacts.end());
	s.assembleBlocks();
	CHECK(solvableRows(s) == std::vector<int32_t> { 1, 2, 3 });
	CHECK(assembleDelassus(s).contacts() == 3);
	DelassusSystem none = assembleDelassus(ContactSystem());
	CHECK(accelerated(none, {}).status == Status::converged);
	CHECK(residual(none).norm == 0);
}
