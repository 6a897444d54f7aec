// Contact problems that several tests solve, and what such problems are made of.
#pragma once

#include "problem/delassus_system.hpp"
#include "solvers/solver.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace tests {
using namespace cd;

inline SolverSettings to(double tolerance, int maxIterations = 20000)
{
	SolverSettings s;
	s.tolerance = tolerance;
	s.maxIterations = maxIterations;
	return s;
}

// Three numbers a body.
inline std::vector<double> velocitiesOf(const ContactSystem<Plane>& s)
{
	std::vector<double> v;
	for (const BodyVelocity<Plane>& b : s.bodies)
		v.insert(v.end(), b.v, b.v + 3);
	return v;
}

// A disk of radius 1 m.
inline BodyVelocity<Plane> disk(double mass, double vx = 0, double vy = 0) { return { { vx, vy, 0 }, 0, { 1 / mass, 1 / mass, 2 / mass }, 0 }; }

// The contact of two such disks.
inline ContactRow<Plane> contact(int a, int b, double nx, double ny, double mu)
{
	ContactRow<Plane> c;
	c.a = a;
	c.b = b;
	c.nx = nx;
	c.ny = ny;
	c.at = 1;
	c.bt = -1;
	c.mu = mu;
	return c;
}

// The same problem given by its matrix. Row by row: W is symmetric, and unit impulses on a contact cause the velocities of its column.
inline DelassusSystem matrixOf(const ContactSystem<Plane>& system)
{
	std::vector<ContactRow<Plane>> rows;
	for (const ContactRow<Plane>& c : system.contacts)
		if (c.wnn > 0)
			rows.push_back(c);
	std::vector<BodyVelocity<Plane>> bodies = system.bodies;
	for (BodyVelocity<Plane>& b : bodies)
		std::fill_n(b.v, 3, 0.);
	const std::vector<BodyVelocity<Plane>> still = bodies;
	DelassusSystem d;
	d.start.push_back(0);
	for (std::size_t i = 0; i < rows.size(); i++) {
		const ContactRow<Plane>& own = rows[i];
		std::vector<Block> row(rows.size());
		for (const int k : { 0, 1 }) {
			applyImpulse(own, bodies[own.a], bodies[own.b], { 1. - k, 1. * k });
			for (std::size_t j = 0; j < rows.size(); j++) {
				Block& w = row[j];
				const auto [un, ut] = relativeVelocity(rows[j], bodies[rows[j].a], bodies[rows[j].b]);
				(k == 0 ? w.nn : w.tn) = un;
				(k == 0 ? w.nt : w.tt) = ut;
			}
			bodies[own.a] = still[own.a];
			bodies[own.b] = still[own.b];
		}
		for (std::size_t j = 0; j < rows.size(); j++) {
			if (row[j].nn == 0 && row[j].nt == 0 && row[j].tn == 0 && row[j].tt == 0)
				continue;
			if (j == i)
				d.diagonal.push_back(d.blocks.size());
			d.column.push_back(static_cast<int32_t>(j));
			d.blocks.push_back(row[j]);
		}
		d.start.push_back(d.blocks.size());
		const auto [un, ut] = relativeVelocity(own, system.bodies[own.a], system.bodies[own.b]);
		d.q.insert(d.q.end(), { un + own.bias, ut });
		d.mu.push_back(own.mu);
		d.p.insert(d.p.end(), { own.pn, own.pt });
	}
	return d;
}

// Disks of unit radius in a triangular lattice on a floor between two walls, under gravity: hyperstatic. Masses are drawn over `ratio`, or,
// for a pile, are `ratio` in the upper half.
inline ContactSystem<Plane> lattice(int rows, double mu, double ratio = 1, bool pile = false)
{
	std::mt19937 random(4);
	std::uniform_real_distribution<double> unit(0, 1);
	ContactSystem<Plane> s;
	const int n = rows * rows;
	for (int i = 0; i < n; i++)
		s.bodies.push_back(disk(pile ? (i / rows >= rows / 2 ? ratio : 1) : std::pow(ratio, unit(random)), 0, -0.01));
	s.bodies.resize(static_cast<std::size_t>(n) + 3); // floor, left and right wall
	const auto add = [&](int a, int b, double nx, double ny) { s.contacts.push_back(contact(a, b, nx, ny, mu)); };
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

// Disks of mass 1 in a row between two walls that close in on them at 1 m/s each; the first and last body are the walls.
inline ContactSystem<Plane> squeezed(int disks, double mu)
{
	ContactSystem<Plane> s;
	s.bodies.assign(static_cast<std::size_t>(disks) + 2, disk(1));
	s.bodies.front() = { { 1, 0, 0 }, 0, {}, 0 };
	s.bodies.back() = { { -1, 0, 0 }, 0, {}, 0 };
	for (int i = 0; i <= disks; i++)
		s.contacts.push_back(contact(i, i + 1, 1, 0, mu));
	s.assembleBlocks();
	return s;
}

// A column or random heap of bodies in contact by random directions; body 0 is immobile. general: bodies whose contacts couple the two directions.
inline ContactSystem<Plane> column(unsigned seed, int bodies, int contacts, double mu, bool general)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(0, 1);
	ContactSystem<Plane> s;
	s.bodies.resize(bodies);
	for (int i = 1; i < bodies; i++) {
		BodyVelocity<Plane>& b = s.bodies[i];
		b.w[0] = b.w[1] = 0.5 + unit(random);
		b.w[2] = 2 + unit(random);
		b.v[0] = unit(random) - 0.5;
		b.v[1] = -unit(random);
	}
	for (int k = 0; k < contacts; k++) {
		const int b = 1 + k % (bodies - 1), a = std::max(0, b - 1 - k / (bodies - 1) % b);
		const double angle = 1.57 + 1.2 * (unit(random) - 0.5);
		ContactRow<Plane> c = contact(a, b, std::cos(angle), std::sin(angle), mu);
		if (general) {
			c.an = unit(random) - 0.5;
			c.bn = unit(random) - 0.5;
		}
		c.bias = 0.1 * unit(random);
		s.contacts.push_back(c);
	}
	s.assembleBlocks();
	return s;
}

// Disks of spread masses on a floor, each in contact with some before it; a loaded wall with one freedom, and where `general` bodies
// whose contacts couple the two directions. Body 0 is immobile, body 1 the wall.
inline ContactSystem<Plane> heap(unsigned seed, int contacts, double mu, bool general)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(0, 1);
	ContactSystem<Plane> s;
	const int bodies = 3 + contacts / 2;
	s.bodies.resize(bodies);
	s.bodies[1].w[0] = 0.3;
	s.bodies[1].v[0] = 0.2;
	std::vector<double> radius(bodies);
	for (int i = 2; i < bodies; i++) {
		BodyVelocity<Plane>& b = s.bodies[i];
		radius[i] = 0.3 + unit(random);
		const double mass = 3 * radius[i] * radius[i];
		b.w[0] = b.w[1] = 1 / mass;
		b.w[2] = 2 / (mass * radius[i] * radius[i]);
		b.v[0] = unit(random) - 0.5;
		b.v[1] = -unit(random);
	}
	for (int k = 0; k < contacts; k++) {
		const int b = 2 + k % (bodies - 2), a = std::max(0, b - 1 - static_cast<int>(6 * unit(random)));
		const double angle = a == 1 ? 0 : 1.57 + 2 * (unit(random) - 0.5);
		ContactRow<Plane> c = contact(a, b, std::cos(angle), std::sin(angle), mu);
		c.at = radius[a];
		c.bt = -radius[b];
		if (general && k % 5 == 0)
			c.bn = 0.3 * unit(random);
		c.bias = 0.1 * unit(random);
		s.contacts.push_back(c);
	}
	s.assembleBlocks();
	return s;
}

} // namespace tests
