// What Newton's method is made of: the factorization of block matrices, and one problem of the proximal-point method.
#include "newton/block_matrix.hpp"
#include "newton/proximal_problem.hpp"
#include "systems.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace cd;
using tests::lattice;
using tests::to;

namespace {

template <int B> void checkFactors(int rows)
{
	std::mt19937 random(7);
	std::uniform_real_distribution<double> unit(-1, 1);
	std::vector<std::pair<int32_t, int32_t>> pairs;
	for (int i = 0; i < rows; i++)
		for (const int j : { i + 1, i + 5 })
			if (j < rows) {
				pairs.emplace_back(i, j);
				pairs.emplace_back(j, i); // a repeat
			}
	BlockMatrix<B> lu;
	lu.plan(static_cast<std::size_t>(rows), pairs);
	for (int repeat = 0; repeat < 2; repeat++) { // the second time with the plan of the first
		lu.clear();
		const std::size_t n = static_cast<std::size_t>(B * rows);
		std::vector<double> dense(n * n), x(n), b(n, 0.);
		const auto fill = [&](int i, int j) {
			auto& block = lu.at(i, j);
			for (int k = 0; k < B; k++)
				for (int l = 0; l < B; l++) {
					// Dominant diagonals, as they are in proximal problems.
					const double value = unit(random) + (i == j && k == l ? 6 * B : 0);
					block[static_cast<std::size_t>(B * k + l)] = value;
					dense[static_cast<std::size_t>(B * i + k) * n + static_cast<std::size_t>(B * j + l)] = value;
				}
		};
		for (int i = 0; i < rows; i++)
			fill(i, i);
		for (const auto& [i, j] : pairs)
			fill(i, j);
		for (double& value : x)
			value = unit(random);
		for (std::size_t r = 0; r < n; r++)
			for (std::size_t c = 0; c < n; c++)
				b[r] += dense[r * n + c] * x[c];
		REQUIRE(lu.factorize());
		lu.solve(b);
		// A well conditioned matrix: some round-offs of numbers of order one.
		for (std::size_t r = 0; r < n; r++)
			CHECK(std::abs(b[r] - x[r]) < 1e-13);
	}
}

} // namespace

TEST_CASE("a block matrix solves unsymmetric systems, again and again with one plan, and refuses singular ones")
{
	for (const int rows : { 1, 2, 30 }) {
		checkFactors<2>(rows);
		checkFactors<3>(rows);
	}
	BlockMatrix<2> lu;
	lu.plan(2, {});
	lu.clear();
	lu.at(0, 0) = { 1, 2, 2, 4 };
	lu.at(1, 1) = { 1, 0, 0, 1 };
	CHECK_FALSE(lu.factorize());
	lu.clear();
	lu.at(0, 0) = lu.at(1, 1) = { 1, 0, 0, std::nan("") };
	CHECK_FALSE(lu.factorize());
	// The pivots of the first matrix are 1e-9 and 0 in the next two.
	for (const double first : { 1., 1e-9, 0. }) {
		lu.clear();
		lu.at(0, 0) = { first, 1, -1, first };
		lu.at(1, 1) = { 1, 0, 0, 1 };
		REQUIRE(lu.factorize());
		std::vector<double> x { first + 2, 2 * first - 1, 3, 4 };
		lu.solve(x);
		for (std::size_t k = 0; k < 4; k++)
			CHECK(std::abs(x[k] - std::vector<double> { 1, 2, 3, 4 }[k]) < 1e-14); // some round-offs of 4
	}
}

TEST_CASE("a proximal problem about one centre is solved to round-off as sigma falls")
{
	ContactSystem<Plane> given = lattice(8, 0.5);
	ContactSystem<Plane> rough = given;
	accelerated(rough, to(1e-2));
	rough.bodies = given.bodies;
	NewtonSystem<ContactSystem<Plane>> form(rough);
	ProximalProblem<NewtonSystem<ContactSystem<Plane>>> problem(form, 1000, 1e12);
	std::vector<double> centre, u;
	form.load(centre);
	problem.centre(centre);
	double sigma = 1e-2;
	REQUIRE(problem.solve(sigma));
	for (int k = 0; k < 15; k++) {
		const std::vector<double> p = problem.impulses();
		form.velocities(p, u);
		double worst = 0, largest = 0;
		for (std::size_t i = 0; i < form.size(); i++) {
			const double* d = &form.diagonal()[2 * i];
			const Impulse law = cutKeeping(
			    { centre[2 * i] - u[2 * i] / (sigma * d[0]), centre[2 * i + 1] - u[2 * i + 1] / (sigma * d[1]) }, form.friction(i));
			worst = std::max({ worst, sigma * std::abs(p[2 * i] - law.n), sigma * std::abs(p[2 * i + 1] - law.t) });
			largest = std::max(largest, p[2 * i]);
		}
		// p = pk - u/(sigma D): the round-off of u in p is 1/sigma times as large. Here some ten of it.
		CHECK(worst < 1e-15 / sigma * largest);
		sigma *= 0.5;
		REQUIRE(problem.resume(sigma));
	}
}
