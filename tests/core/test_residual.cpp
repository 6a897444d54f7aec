// The error e of one contact, worked out by hand for every state a contact can be in.
#include "error/residual.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <limits>

using namespace cd;

namespace {

// A unit mass above a floor: n = (0, 1), so u_n = v_y, u_t = -v_x; W is the identity.
struct OneContact {
	ContactSystem<Plane> system;
	std::vector<double> free = { 0, 0, 0, 0, 0, 0 };

	OneContact(double vx, double vy, double mu, double pn, double pt)
	{
		system.bodies.resize(2);
		system.bodies[1].w[0] = system.bodies[1].w[1] = 1;
		ContactRow<Plane> c {};
		c.b = 1;
		c.ny = 1;
		c.mu = mu;
		c.pn = pn;
		c.pt = pt;
		system.contacts.push_back(c);
		system.assembleBlocks();
		free[3] = vx;
		free[4] = vy;
	}
	double e() const { return residual(system, free).norm; }
};

} // namespace

TEST_CASE("a solved contact has no error")
{
	CHECK(OneContact(0, 1, 0.5, 0, 0).e() == 0); // open, parting
	CHECK(OneContact(0, 1, 0.0, 0, 0).e() == 0); // the same without friction
	CHECK(OneContact(0, -1, 0.5, 1, 0).e() == 0); // closed, at rest
	CHECK(OneContact(0.3, -1, 0.5, 1, 0.3).e() == 0); // sticking: t = (-1, 0), so +p_t acts along -x
	CHECK(OneContact(2, -1, 0.5, 1, 0.5).e() == 0); // sliding, exact Coulomb: u_n stays 0
	CHECK(OneContact(-2, -1, 0.5, 1, -0.5).e() == 0); // the other way
	CHECK(OneContact(2, -1, 0.0, 1, 0).e() == 0); // sliding without friction
}

TEST_CASE("every kind of violation counts")
{
	const double none = std::numeric_limits<double>::infinity();
	CHECK(OneContact(0, -1, 0.5, 0, 0).e() == none); // closing, no impulse at all
	CHECK(OneContact(0, -1, 0.5, 0.5, 0).e() == doctest::Approx(1)); // half of the impulse missing
	CHECK(OneContact(0, -1, 0.5, 2, 0).e() == doctest::Approx(0.5)); // pushed apart: half too much
	CHECK(OneContact(1, -1, 0.5, 1, 0).e() > 0.1); // slides without friction force
	CHECK(OneContact(0.1, -1, 0.5, 1, 0.5).e() > 0.1); // friction pushes along the motion
	CHECK(OneContact(2, -1, 0.0, 1, 0.5).e() > 0.1); // friction where there is none
	CHECK(OneContact(0, 0, 0.5, 1, 0.9).e() > 0.1); // outside the cone
}

TEST_CASE("an associated law's dilating solution is not taken for Coulomb's")
{
	// Sliding at u_t = -1.2 with u_n = mu |u_t| satisfies the associated law; with De Saxce's term it must not pass.
	const double pn = 1 + 0.5 * 1.2;
	CHECK(OneContact(2, -1, 0.5, pn, 0.5 * pn).e() > 0.1);
}

TEST_CASE("NaN is reported, not compared away")
{
	OneContact c(0, -1, 0.5, 1, 0);
	c.system.contacts[0].pt = std::nan("");
	CHECK(std::isnan(c.e()));
}

TEST_CASE("two immobile bodies ask for nothing")
{
	OneContact c(0, -1, 0.5, 0, 0);
	c.system.bodies[1].w[0] = c.system.bodies[1].w[1] = 0;
	c.system.assembleBlocks();
	CHECK(c.e() == 0);
}

TEST_CASE("what is below the round-off of the velocities is no error, what is above is")
{
	const double none = std::numeric_limits<double>::infinity();
	CHECK(OneContact(1, -1e-16, 0.0, 0, 0).e() == 0);
	CHECK(OneContact(1, -1e-14, 0.0, 0, 0).e() == none);
	CHECK(OneContact(0, -1e-30, 0.0, 0, 0).e() == none); // nothing else moves: this is the velocity itself
}

TEST_CASE("an island without impulses that misses its law is wrong by all of its velocity change, however much other islands bear")
{
	OneContact c(0, -1, 0.5, 1, 0);
	c.system.bodies.resize(3);
	c.system.bodies[2].w[0] = c.system.bodies[2].w[1] = 1;
	c.system.contacts.push_back(c.system.contacts[0]);
	c.system.contacts[1].b = 2;
	c.system.contacts[1].pn = 0;
	c.system.assembleBlocks();
	c.free.insert(c.free.end(), { 0, -1e-9, 0 });
	CHECK(residual(c.system, c.free).law() < 1e-8);
	CHECK(std::isinf(residual(c.system, c.free).bodies));
	c.free[7] = 1e-9; // it parts
	CHECK(residual(c.system, c.free).error() < 1e-15);
	c.free[7] = -1e-9;
	c.system.contacts[1].pn = 1e-9;
	CHECK(residual(c.system, c.free).error() < 1e-15);
}
