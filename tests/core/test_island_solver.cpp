// Islands solved apart: what is parted, that nothing is lost by it, and what is gained.
#include "islands/island_solver.hpp"
#include "systems.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <doctest/doctest.h>
#include <random>

using namespace cd;
using tests::to;
using tests::velocitiesOf;

namespace {

constexpr double weight = 9.81e-3; // impulse of gravity on 1 kg in a step of 1 ms [N s]

// Body 0 is a fixed floor.
ContactSystem<Plane> floorOnly()
{
	ContactSystem<Plane> s;
	s.bodies.resize(1);
	return s;
}

int32_t addDisk(ContactSystem<Plane>& s, double mass, double vx = 0)
{
	s.bodies.push_back(tests::disk(mass, vx, -weight));
	return static_cast<int32_t>(s.bodies.size()) - 1;
}

void addContact(ContactSystem<Plane>& s, int32_t a, int32_t b, double mu, double angle = M_PI / 2)
{
	s.contacts.push_back(tests::contact(a, b, std::cos(angle), std::sin(angle), mu));
	s.assembleBlocks();
}

// Disks one on the other on the floor; the impulse between number i and i + 1 is the weight of what is above.
void addStack(ContactSystem<Plane>& s, int disks, double mass)
{
	int32_t below = 0;
	for (int i = 0; i < disks; i++) {
		const int32_t disk = addDisk(s, mass);
		addContact(s, below, disk, 0.5);
		below = disk;
	}
}

// A disk that slides over the floor, and one that flies free.
void addLoneDisks(ContactSystem<Plane>& s)
{
	addContact(s, 0, addDisk(s, 2, 1), 0.3);
	addDisk(s, 1);
}

double largestDifference(const std::vector<double>& a, const std::vector<double>& b)
{
	double largest = 0;
	for (std::size_t i = 0; i < a.size(); i++)
		largest = std::max(largest, std::abs(a[i] - b[i]));
	return largest;
}

// Heaps of disks, each standing on those before it, with as many contacts as a packing has.
ContactSystem<Plane> heaps(int count, int disks, unsigned seed)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(0, 1);
	ContactSystem<Plane> s = floorOnly();
	for (int k = 0; k < count; k++) {
		const int32_t first = static_cast<int32_t>(s.bodies.size());
		for (int i = 0; i < disks; i++) {
			const int32_t disk = addDisk(s, 0.5 + unit(random), unit(random) - 0.5);
			for (int j = 0; j < 2; j++)
				addContact(s, i < 3 ? 0 : first + static_cast<int32_t>(i * unit(random)), disk, 0.4, 1.2 + 0.7 * unit(random));
		}
	}
	return s;
}

} // namespace

TEST_CASE("islands are joined by bodies that can move, not by those that cannot")
{
	for (const bool wallMoves : { false, true }) {
		ContactSystem<Plane> s = floorOnly();
		addStack(s, 3, 1);
		addStack(s, 4, 1);
		addLoneDisks(s);
		s.bodies.push_back({});
		const int32_t wall = static_cast<int32_t>(s.bodies.size()) - 1;
		s.bodies[wall].w[0] = wallMoves ? 0.1 : 0; // one freedom
		s.bodies[wall].v[0] = 0.1; // whether it can move or has to
		for (const int32_t disk : { 1, 4 })
			addContact(s, wall, disk, 0, 0);
		IslandSolver<Plane> solve;
		Effort effort;
		solve(s, nsgs, to(1e-12), effort);
		CHECK(effort.islands == (wallMoves ? 2 : 3));
		CHECK(effort.unknowns == 8 * 3 + wallMoves); // the disk that flies has none
		CHECK(effort.resting == 0);
	}
}

// Every impulse is known: the weight of what is above. An error e of the equations is one of the impulses by the smallest eigenvalue of a stack of
// ten over W_nn, 1 - cos(pi/21) = 1/90.
TEST_CASE("stacks of masses far apart are each solved to the tolerance, apart or together")
{
	const auto build = [] {
		ContactSystem<Plane> s = floorOnly();
		addStack(s, 10, 1e-5);
		addStack(s, 10, 1);
		addLoneDisks(s);
		return s;
	};
	const auto sandError = [](const ContactSystem<Plane>& s) {
		double difference = 0, square = 0;
		for (int i = 0; i < 10; i++) {
			const double exact = 1e-5 * weight * (10 - i);
			difference += (s.contacts[i].pn - exact) * (s.contacts[i].pn - exact);
			square += exact * exact;
		}
		return std::sqrt(difference / square);
	};
	for (const Solver<Plane> method : { Solver<Plane>(nsgs), Solver<Plane>(accelerated) }) {
		ContactSystem<Plane> parted = build(), whole = build();
		// The small stack comes first in the sweeps and last in the error: given no time, it does not get any.
		for (int i = 10; i < 20; i++)
			for (ContactSystem<Plane>* s : { &parted, &whole })
				s->contacts[i].pn = weight * (20 - i);
		IslandSolver<Plane> solve;
		Effort effort;
		const SolverReport report = solve(parted, method, to(1e-4), effort);
		CHECK(report.status == Status::converged);
		CHECK(report.error <= 1e-4);
		CHECK(effort.islands == 3);
		CHECK(effort.resting == 1); // the big stack had its solution
		CHECK(sandError(parted) < 90 * 1e-4);
		const SolverReport before = solveWhole(whole, method, to(1e-4), effort);
		CHECK(before.status == Status::converged);
		CHECK(sandError(whole) < 90 * 1e-4); // by the error of the bodies; e of the whole does not see it
		CHECK(before.residual < 1e-8);
	}
}

TEST_CASE("one island gets the bits of the solver, with lone contacts that carry nothing and bodies that touch nothing as without")
{
	for (const Solver<Plane> method : { Solver<Plane>(nsgs), Solver<Plane>(accelerated) })
		for (const bool others : { false, true }) {
			ContactSystem<Plane> direct = heaps(1, 60, 3);
			if (others) {
				addLoneDisks(direct);
				direct.contacts.back().bias = 1; // not reached in the step
			}
			ContactSystem<Plane> parted = direct;
			const SolverReport expected = method(direct, to(1e-8));
			IslandSolver<Plane> solve;
			Effort effort;
			const SolverReport report = solve(parted, method, to(1e-8), effort);
			CHECK(effort.islands == 1 + others);
			CHECK(report.iterations == expected.iterations);
			CHECK(report.residual == expected.residual);
			CHECK(std::memcmp(parted.bodies.data(), direct.bodies.data(), sizeof(BodyVelocity<Plane>) * direct.bodies.size()) == 0);
			for (std::size_t i = 0; i < direct.contacts.size(); i++)
				CHECK(std::memcmp(&parted.contacts[i].pn, &direct.contacts[i].pn, 2 * sizeof(double)) == 0);
		}
}

// Where friction leaves impulses open, velocities are not; they are compared. The factor is the heaps' conditioning: errors of 1e-10 of impulses of
// 0.1 N s on 1 kg.
TEST_CASE("many islands move as the whole moves, by an error no larger")
{
	for (const Solver<Plane> method : { Solver<Plane>(nsgs), Solver<Plane>(accelerated) }) {
		ContactSystem<Plane> whole = heaps(12, 15, 5), parted = whole;
		addLoneDisks(whole);
		addLoneDisks(parted);
		const std::vector<double> free = velocitiesOf(parted);
		const SolverSettings settings = to(1e-10, 100000);
		IslandSolver<Plane> solve;
		Effort effort;
		const SolverReport report = solve(parted, method, settings, effort);
		CHECK(effort.islands >= 12);
		CHECK(report.status == Status::converged);
		CHECK(report.residual <= 1e-10);
		CHECK(report.residual == doctest::Approx(residual(parted, free).norm).epsilon(1e-3)); // round-off of differences of 1e-16 over 1e-12
		CHECK(report.residualMax == doctest::Approx(residual(parted, free).maximum).epsilon(1e-3));
		solveWhole(whole, method, settings, effort);
		CHECK(largestDifference(velocitiesOf(whole), velocitiesOf(parted)) < 1e-7);
	}
}

TEST_CASE("what is at rest already is left as it is, without a sweep and without a memory of how it got there")
{
	ContactSystem<Plane> s = heaps(1, 40, 7);
	addStack(s, 5, 1);
	addLoneDisks(s);
	const std::vector<double> free = velocitiesOf(s);
	IslandSolver<Plane> solve, fresh;
	Effort effort;
	solve(s, nsgs, to(1e-6), effort);
	CHECK(effort.resting == 0);
	const int islands = effort.islands;
	const auto again = [&] {
		for (std::size_t i = 0; i < s.bodies.size(); i++)
			std::copy_n(&free[3 * i], 3, s.bodies[i].v);
	};
	again();
	ContactSystem<Plane> other = s;
	const SolverReport report = solve(s, nsgs, to(1e-6), effort);
	CHECK(report.iterations == 0);
	CHECK(effort.resting == islands);
	fresh(other, nsgs, to(1e-6), effort);
	CHECK(std::memcmp(s.bodies.data(), other.bodies.data(), sizeof(BodyVelocity<Plane>) * s.bodies.size()) == 0);
	// Only the one that is disturbed is solved anew.
	again();
	s.bodies[s.contacts.back().b].v[0] = 2; // the lone disk slides faster; that changes no impulse
	s.bodies[s.bodies.size() - 4].v[1] -= 1; // the top of the stack
	solve(s, nsgs, to(1e-6), effort);
	CHECK(effort.resting == islands - 1);
}

TEST_CASE("what could not be solved says so, and what was asked for as a whole is not parted")
{
	ContactSystem<Plane> s = heaps(3, 20, 9);
	IslandSolver<Plane> solve;
	Effort effort;
	SolverSettings settings = to(1e-12, 3);
	ContactSystem<Plane> hasty = s;
	CHECK(solve(hasty, nsgs, settings, effort).status == Status::max_iterations);
	settings.fixedIterations = 4;
	ContactSystem<Plane> fixed = s, direct = s;
	CHECK(solve(fixed, nsgs, settings, effort).iterations == 4);
	CHECK(effort.islands == 1);
	nsgs(direct, settings);
	CHECK(std::memcmp(fixed.bodies.data(), direct.bodies.data(), sizeof(BodyVelocity<Plane>) * direct.bodies.size()) == 0);
	ContactSystem<Plane> broken = s;
	broken.bodies[30].v[0] = std::nan("");
	CHECK(solve(broken, nsgs, to(1e-6), effort).status == Status::diverged);
	ContactSystem<Plane> empty = floorOnly();
	addDisk(empty, 1);
	const SolverReport report = solve(empty, nsgs, to(1e-6), effort);
	CHECK(report.status == Status::converged);
	CHECK(report.error == 0);
	CHECK(effort.islands == 0);
	CHECK(effort.unknowns == 0);
	CHECK(empty.bodies[1].v[1] == -weight);
}
