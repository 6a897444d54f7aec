// The matrix of a problem of spheres against what impulses do to the bodies.
#include "problem/problem.hpp"
#include "solvers/solver.hpp"

#include <doctest/doctest.h>
#include <random>

namespace {
using namespace cd;

// Spheres between a still boundary and a plate that moves along z only; every contact couples several others. The last body is held, and the last
// contact, between it and the boundary, can move along no normal.
ContactSystem<Space3> spheres(bool compliant, unsigned seed)
{
	std::mt19937 draw(seed);
	std::uniform_real_distribution<double> around(-1, 1), size(0.5, 2);
	constexpr int count = 12, boundary = count, plate = count + 1, held = count + 2;
	ContactSystem<Space3> s;
	s.bodies.resize(count + 3);
	for (int i = 0; i < count; i++) {
		const double w = size(draw);
		for (int k = 0; k < 6; k++) {
			s.bodies[i].w[k] = k < 3 ? w : 2.5 * w;
			s.bodies[i].v[k] = around(draw);
		}
	}
	s.bodies[plate].w[2] = 0.3;
	s.bodies[plate].v[2] = -1;
	const auto add = [&](int a, int b, const Vector3& way) {
		ContactRow<Space3> c;
		const Vector3 n = 1 / length(way) * way;
		c.a = a;
		c.b = b;
		c.nx = n.x;
		c.ny = n.y;
		c.nz = n.z;
		c.at = a < count ? size(draw) : 0;
		c.bt = b < count ? size(draw) : 0;
		c.mu = 0.5;
		c.bias = 0.1 * size(draw);
		if (compliant) {
			c.cn = 0.2;
			c.ct = 0.3;
			const Vector3 slip = cross(n, { around(draw), around(draw), around(draw) });
			c.slipX = slip.x;
			c.slipY = slip.y;
			c.slipZ = slip.z;
		}
		s.contacts.push_back(c);
	};
	for (int i = 0; i < count; i++)
		for (int j = i + 1; j < count; j += 3)
			add(i, j, { around(draw), around(draw), around(draw) });
	for (int i = 0; i < count; i += 2) {
		add(boundary, i, { around(draw), around(draw), 1 });
		add(plate, i, { 0, 0, -1 });
	}
	add(boundary, held, { 1, 0, 0 });
	s.assembleBlocks();
	s.contacts.compliant = compliant;
	return s;
}

double across(const SpatialComponents<double>& u) { return std::sqrt(tangentialSquare(u)); }

} // namespace

TEST_CASE("the matrix of spheres gives the velocities that their impulses cause")
{
	for (const bool compliant : { false, true }) {
		ContactSystem<Space3> s = spheres(compliant, 1);
		std::mt19937 draw(2);
		std::uniform_real_distribution<double> around(-1, 1);
		for (ContactRow<Space3>& c : s.contacts) {
			const Vector3 p = cross({ c.nx, c.ny, c.nz }, { around(draw), around(draw), around(draw) });
			setImpulse(c, { around(draw), p.x, p.y, p.z });
		}
		const ConeOfSpheres cone(s);
		CHECK(cone.matrix.contacts() == s.contacts.size() - 1);
		CHECK(cone.matrix.blocks.size() == ConeOfSpheres::blocksOf(s) - 1); // none between two bodies twice
		ContactSystem<Space3> moved = s;
		for (const ContactRow<Space3>& c : s.contacts)
			if (c.wnn > 0)
				applyImpulse(c, moved.bodies[c.a], moved.bodies[c.b], impulseOf(c));
		for (std::size_t i = 0; i < cone.matrix.contacts(); i++) {
			const ContactRow<Space3>& c = s.contacts[i];
			const SpatialComponents<double> p = impulseOf(c), u = inLaw(c, relativeVelocity(c, moved.bodies[c.a], moved.bodies[c.b]), p);
			const Triple by = cone.matrix.velocity(i, cone.matrix.p);
			// Sums of some twenty terms of size 1 to 10.
			CHECK(std::abs(by[0] - u.n) < 1e-13);
			CHECK(std::abs(tangential(by) - across(u)) < 1e-13);
			CHECK(cone.matrix.own(i)[0] == doctest::Approx(c.nn()).epsilon(1e-14));
		}
		ContactSystem<Space3> back = spheres(compliant, 1);
		cone.giveBack(back);
		for (std::size_t i = 0; i + 1 < s.contacts.size(); i++)
			CHECK(length(impulseOf(back.contacts[i]) - impulseOf(s.contacts[i])) < 1e-15 * 10);
	}
}
