// The hyperstatic problem that several tests solve.
#pragma once

#include "solver.hpp"

#include <cmath>
#include <random>

namespace tests {
using namespace cd;

// Disks of unit radius in a triangular lattice on a floor between two walls, under gravity: hyperstatic. Masses are drawn over `ratio`, or,
// for a pile, are `ratio` in the upper half.
inline ContactSystem lattice(int rows, double mu, double ratio = 1, bool pile = false)
{
	std::mt19937 random(4);
	std::uniform_real_distribution<double> unit(0, 1);
	ContactSystem s;
	const int n = rows * rows;
	s.bodies.resize(static_cast<std::size_t>(n) + 3); // then floor, left and right wall
	for (int i = 0; i < n; i++) {
		const double m = pile ? (i / rows >= rows / 2 ? ratio : 1) : std::pow(ratio, unit(random));
		BodyVelocity& b = s.bodies[static_cast<std::size_t>(i)];
		b.w[0] = b.w[1] = 1 / m;
		b.w[2] = 2 / m;
		b.v[1] = -0.01;
	}
	const auto add = [&](int a, int b, double nx, double ny) {
		ContactRow c {};
		c.a = a;
		c.b = b;
		c.nx = nx;
		c.ny = ny;
		c.at = 1;
		c.bt = -1;
		c.mu = mu;
		s.contacts.push_back(c);
	};
	const double height = std::sqrt(0.75);
	for (int j = 0; j < rows; j++)
		for (int i = 0; i < rows; i++) {
			const int here = j * rows + i, left = here + rows - 1 + j % 2;
			if (i + 1 < rows)
				add(here, here + 1, 1, 0);
			if (j + 1 < rows && i - 1 + j % 2 >= 0)
				add(here, left, -0.5, height);
			if (j + 1 < rows && i + j % 2 < rows)
				add(here, left + 1, 0.5, height);
			if (j == 0)
				add(n, here, 0, 1);
			if (i == 0 && j % 2 == 0)
				add(n + 1, here, 1, 0);
			if (i == rows - 1 && j % 2 == 1)
				add(n + 2, here, -1, 0);
		}
	s.assembleBlocks();
	return s;
}

inline SolverSettings to(double tolerance, int maxIterations = 20000)
{
	SolverSettings s;
	s.tolerance = tolerance;
	s.maxIterations = maxIterations;
	return s;
}

} // namespace tests
