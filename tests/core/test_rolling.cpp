// Contacts that resist rolling: the local law against its definition, and sweeps over them.
#include "kernels/kernels.hpp"
#include "solvers/solvers.hpp"
#include "sweeps/sweeps.hpp"
#include "systems.hpp"

#include <doctest/doctest.h>

using namespace cd;

namespace {

ContactRow<RollingPlane> rolling(const ContactRow<Plane>& planar, double length, double eta)
{
	ContactRow<RollingPlane> c;
	static_cast<ContactRow<Plane>&>(c) = planar;
	c.length = length;
	c.eta = eta;
	return c;
}

// tests::heap, each contact with rolling resistance, none or a share `eta` of its disk's radius.
ContactSystem<RollingPlane> heap(unsigned seed, int contacts, double mu, double eta, bool general, bool compliant = false)
{
	const ContactSystem<Plane> planar = tests::heap(seed, contacts, mu, general);
	ContactSystem<RollingPlane> s;
	s.bodies = planar.bodies;
	for (std::size_t i = 0; i < planar.contacts.size(); i++) {
		s.contacts.push_back(rolling(planar.contacts[i], std::abs(planar.contacts[i].bt), i % 4 == 0 ? 0 : eta));
		ContactRow<RollingPlane>& c = s.contacts.back();
		c.assembleBlock(s.bodies[c.a], s.bodies[c.b]);
		if (compliant) {
			c.cn = 0.2 * c.wnn;
			c.ct = 0.3 * c.wnn;
			c.slipBias = 0.01;
			c.cr = 0.4 * c.wnn;
			c.rollBias = -0.02;
		}
	}
	s.contacts.compliant = compliant;
	return s;
}

std::vector<double> velocitiesOf(const ContactSystem<RollingPlane>& s)
{
	std::vector<double> v;
	for (const BodyVelocity<Plane>& b : s.bodies)
		v.insert(v.end(), b.v, b.v + 3);
	return v;
}

} // namespace

TEST_CASE("the nearest point of the cone of friction and rolling is nearer than all others")
{
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(-1, 1);
	for (int i = 0; i < 2000; i++) {
		const RollingComponents<double> q { unit(random), 2 * unit(random), 2 * unit(random) };
		const RollingFriction<double> by { i % 5 == 0 ? 0 : std::abs(unit(random)), i % 7 == 0 ? 0 : std::abs(unit(random)) };
		const RollingComponents<double> p = projected(q, by);
		CHECK((p.n >= 0 && std::abs(p.t) <= by.mu * p.n && std::abs(p.r) <= by.eta * p.n));
		// p is nearest in a convex cone if q - p is orthogonal to p and makes no acute angle with any of the cone's edges.
		CHECK(dot(q - p, p) == doctest::Approx(0).epsilon(1e-14).scale(1));
		for (const double t : { -by.mu, by.mu })
			for (const double r : { -by.eta, by.eta })
				CHECK(dot(q - p, RollingComponents<double> { 1, t, r }) < 1e-14);
	}
}

TEST_CASE("a contact alone is solved exactly, whatever it couples, and with springs")
{
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(0, 1);
	int states[2][2] = {}; // whether it slides, and whether it rolls
	for (int i = 0; i < 6000; i++) {
		BodyVelocity<Plane> A {}, B = tests::disk(0.2 + unit(random));
		if (i % 3 != 0)
			A = tests::disk(0.2 + unit(random));
		ContactRow<Plane> planar = tests::contact(0, 1, 0.6, 0.8, i % 11 == 0 ? 0 : 0.6 * unit(random));
		if (i % 2 == 1) { // as of a free box: all three are coupled
			planar.an = 0.4 * (unit(random) - 0.5);
			planar.bn = 0.4 * (unit(random) - 0.5);
			B.w[1] *= 1.5;
		}
		ContactRow<RollingPlane> c = rolling(planar, 1, i % 13 == 0 ? 0 : 0.6 * unit(random));
		c.assembleBlock(A, B);
		if (i % 4 == 0) {
			c.cn = 0.1;
			c.ct = 0.2;
			c.cr = 0.3;
			c.slipBias = unit(random) - 0.5;
			c.rollBias = unit(random) - 0.5;
		}
		c.bias = unit(random) - 0.9;
		for (BodyVelocity<Plane>* of : { &A, &B })
			for (double& v : of->v)
				v = unit(random) - 0.5;
		const RollingComponents<double> start { unit(random), unit(random) - 0.5, unit(random) - 0.5 }; // it must not matter
		BodyVelocity<Plane> a = A, b = B;
		applyImpulse(c, a, b, start);
		const RollingComponents<double> p = solveContact(c, inLaw(c, relativeVelocity(c, a, b), start), start);
		applyImpulse(c, a, b, p - start);
		const RollingComponents<double> u = inLaw(c, relativeVelocity(c, a, b), p);
		CHECK(squaredMiss(p, u, frictionOf(c), c.nn()) < 1e-24);
		const auto yields = [&](double of, double most) { return std::abs(of) >= most * p.n * (1 - 1e-9); };
		if (p.n > 0 && c.mu > 0 && c.eta > 0)
			states[yields(p.t, c.mu)][yields(p.r, c.eta)]++;
	}
	for (const auto& slides : states)
		for (const int rolls : slides)
			CHECK(rolls > 30);
}

TEST_CASE("a moment between bodies of which none turns by itself opposes a driven rotation, and is zero without one")
{
	BodyVelocity<Plane> A {}, B = tests::disk(1, 0, -1);
	B.w[2] = 0;
	for (const double spin : { 0., 2., -2. }) {
		A.v[2] = spin;
		ContactRow<RollingPlane> c = rolling(tests::contact(0, 1, 0, 1, 0), 1, 0.1);
		c.assembleBlock(A, B);
		const RollingComponents<double> p = solveContact(c, inLaw(c, relativeVelocity(c, A, B), {}));
		CHECK(p.n == doctest::Approx(1));
		CHECK(p.r == doctest::Approx(spin == 0 ? 0 : spin > 0 ? 0.1 : -0.1)); // u_r = -spin
		CHECK_FALSE(c.groupable(false, false));
	}
}

TEST_CASE("sweeps over contacts with rolling resistance reach the law, by each method to the same velocities, by each kernel to the same bits")
{
	const GroupKernel<Plane>& used = groupKernel<Plane>();
	for (const bool general : { false, true })
		for (const bool compliant : { false, true }) {
			ContactSystem<RollingPlane> problem = heap(3, 400, 0.4, 0.2, general, compliant);
			const std::vector<double> free = velocitiesOf(problem);
			std::vector<double> first;
			int rolls = 0, holds = 0;
			for (const char* method : { "nsgs", "accelerated", "auto" }) {
				ContactSystem<RollingPlane> s = problem;
				const SolverReport report = findSolver<RollingPlane>(method)(s, tests::to(1e-12));
				CHECK(report.status == Status::converged);
				const Residual e = residual(s, free);
				CHECK(e.error() < 2e-12);
				const std::vector<double> v = velocitiesOf(s);
				for (std::size_t i = 0; i < v.size() && !first.empty(); i++)
					CHECK(v[i] == doctest::Approx(first[i]).epsilon(1e-8).scale(1));
				first = v;
				for (const ContactRow<RollingPlane>& c : s.contacts)
					if (c.pn > 0 && c.eta > 0)
						(std::abs(c.pr) < c.eta * c.pn * (1 - 1e-9) ? holds : rolls)++;
			}
			CHECK((rolls > 50 && holds > 50));
			std::vector<double> bits;
			for (const GroupKernel<Plane>& kernel : groupKernels<Plane>()) {
				useGroupKernel(kernel);
				ContactSystem<RollingPlane> s = problem;
				accelerated(s, tests::to(1e-9));
				CHECK((bits.empty() || bits == velocitiesOf(s)));
				bits = velocitiesOf(s);
			}
			useGroupKernel(used);
		}
	CHECK((findSolver<RollingPlane>("newton") == nullptr));
}
