// Contacts with a stiffness: the backward Euler step against closed forms, and its limits.
#include "step/step.hpp"
#include "worlds.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <doctest/doctest.h>

using namespace cd;

namespace {

StepSettings<Plane> settingsOf(double dt, double tolerance = 1e-13)
{
	StepSettings<Plane> s;
	s.dt = dt;
	s.solve = findSolver("auto");
	s.solver.tolerance = s.restTolerance = tolerance;
	return s;
}

StepReport make(TimeStep<Plane>& t, World& w, const StepSettings<Plane>& s)
{
	t.sleepers.update(w);
	const StepReport report = t(w, s);
	CHECK(report.solver.status == Status::converged);
	return report;
}

int32_t addWall(World& w, int axis, double x, double y)
{
	Shape shape;
	shape.kind = ShapeKind::wall;
	shape.axis = axis;
	Body b;
	b.x = x;
	b.y = y;
	return tests::add(w, b, shape);
}

// A column of disks of radius 0.1 m and 1 kg over a wall, which just touch.
World column(int disks, double kn)
{
	World w;
	addWall(w, 1, 0, 0);
	for (int i = 0; i < disks; i++) {
		w.bodies[tests::add(w, tests::diskAt(0, 0.1 + 0.2 * i, 0.1))].force[1] = -10;
		w.pairs.push_back({ i, i + 1, 0.5 });
	}
	w.springs = true;
	w.stiffnesses.assign(w.pairs.size(), { kn, 0.5 * kn });
	return w;
}

double kinetic(const World& w)
{
	double sum = 0;
	for (const Body& b : w.bodies)
		for (int k = 0; k < 3; k++)
			if (b.inverseMass[k] > 0)
				sum += 0.5 * b.v[k] * b.v[k] / b.inverseMass[k];
	return sum;
}

} // namespace

TEST_CASE("an impact of one contact follows the recursion of backward Euler, dashpot included")
{
	const double kn = 1e4, h = 1e-3;
	for (const double ratio : { 0., 0.3 }) {
		World w = column(1, kn);
		w.bodies[1].force[1] = 0;
		w.bodies[1].v[1] = -1;
		StepSettings<Plane> s = settingsOf(h);
		s.dampingRatio = ratio;
		TimeStep<Plane> t;
		const double c = 2 * ratio * std::sqrt(kn);
		double x = 0, v = -1; // of the disk over its place of contact
		for (int i = 0; i < 60; i++) {
			make(t, w, s);
			const double next = (v - h * kn * x) / (1 + h * h * kn + h * c);
			v = -kn * (x + h * next) - c * next > 0 ? next : v;
			x += h * v;
			CHECK(w.bodies[1].v[1] == doctest::Approx(v).epsilon(1e-12));
		}
		CHECK(v > 0);
		if (ratio == 0)
			CHECK(v == doctest::Approx(0.8559).epsilon(1e-4)); // omega h = 0.1
	}
}

TEST_CASE("steps that are long beside a contact's period lead to the static state, whatever the stiffness")
{
	for (const double kn : { 1e5, 1e8, 1e13 }) {
		World w = column(50, kn);
		TimeStep<Plane> t;
		for (int i = 0; i < 20; i++) // the slowest motion keeps 0.3 of itself in each
			make(t, w, settingsOf(100 / std::sqrt(kn), 1e-12));
		for (int i = 0; i < 50; i++) {
			const double distance = w.bodies[i + 1].y - w.bodies[i].y, force = 10 * (50 - i);
			CHECK(w.carried[i].fn[1] == doctest::Approx(force).epsilon(1e-6).scale(500));
			CHECK((i == 0 ? 0.1 : 0.2) - distance == doctest::Approx(force / kn).epsilon(1e-6).scale(std::max(500 / kn, 1e-8)));
		}
	}
}

TEST_CASE("the tangential spring is elastic, slides at mu p_n and keeps its memory where the motion turns back")
{
	const double kn = 1e5, kt = 4e4, h = 1e-3, mu = 0.5, load = 20;
	World w = column(1, kn);
	w.stiffnesses[0].kt = kt;
	Body& disk = w.bodies[1];
	disk.inverseMass[0] = disk.inverseMass[2] = 0; // driven along the wall
	disk.force[1] = -load;
	disk.y -= load / kn;
	TimeStep<Plane> t;
	double force = 0;
	for (int i = 0; i < 200; i++) {
		disk.v[0] = 0.2 * std::cos(0.07 * i);
		make(t, w, settingsOf(h));
		force = std::max(-mu * load, std::min(mu * load, force - kt * h * disk.v[0]));
		CHECK(w.carried[0].ft[0] == doctest::Approx(force).epsilon(1e-9).scale(1));
	}
}

TEST_CASE("two walls that close in on a disk, a step without a solution for rigid grains")
{
	const double kn = 1e6, h = 1e-3;
	World w = column(1, kn);
	addWall(w, 1, 0, 0.2);
	w.bodies[2].v[1] = -0.1;
	w.bodies[1].force[1] = 0;
	w.pairs.push_back({ 2, 1, 0.5 });
	w.stiffnesses.push_back({ kn, kn });
	TimeStep<Plane> t;
	for (int i = 1; i <= 500; i++)
		make(t, w, settingsOf(h));
	CHECK(w.carried[0].fn[1] == doctest::Approx(0.5 * kn * 0.1 * 0.5).epsilon(1e-3)); // both contacts share what the walls have moved
	// Forces that grow evenly are what the first guess expects.
	for (int i = 0; i < 10; i++)
		CHECK(make(t, w, settingsOf(h, 1e-9)).solver.iterations == 0);
}

TEST_CASE("k -> infinity is the rigid step, with an error of first order in 1/k")
{
	const auto velocities = [](double kn) {
		World w = column(10, kn);
		if (kn == 0) {
			w.springs = false;
			w.stiffnesses.clear();
		}
		w.bodies[5].force[0] = 3;
		w.bodies[7].force[1] = 40; // lifts the upper ones
		TimeStep<Plane> t;
		make(t, w, settingsOf(1e-3));
		std::vector<double> v;
		for (const Body& b : w.bodies)
			v.insert(v.end(), b.v, b.v + 3);
		return v;
	};
	const std::vector<double> rigid = velocities(0);
	double before = 1;
	for (const double kn : { 1e10, 1e11, 1e12 }) {
		double most = 0;
		const std::vector<double> soft = velocities(kn);
		for (std::size_t i = 0; i < rigid.size(); i++)
			most = std::max(most, std::abs(soft[i] - rigid[i]));
		CHECK(most < 0.11 * before);
		before = most;
	}
	CHECK(before < 3e-7);
}

TEST_CASE("work = kinetic + stored energy + friction + dashpots + damping by the scheme, and every method, kernel and number of threads agrees")
{
	World begin = tests::flow(12, 10);
	for (Pair& pair : begin.pairs)
		pair.reference = 0;
	begin.springs = true;
	begin.stiffnesses.assign(begin.pairs.size(), { 2e4, 1e4 });
	std::vector<World> ends;
	const GroupKernel<Plane>& usual = groupKernel<Plane>();
	const auto run = [&](const char* method, int threads) {
		World w = begin;
		TimeStep<Plane> t;
		StepSettings<Plane> s = settingsOf(2e-3, 1e-11);
		s.solve = findSolver(method);
		s.dampingRatio = 0.05;
		s.threads = threads;
		const double held = kinetic(w);
		double work = 0, lost = 0, friction = 0;
		for (int i = 0; i < 40; i++) {
			const World last = w;
			const StepReport r = make(t, w, s);
			for (std::size_t k = 0; k < w.bodies.size(); k++)
				work += last.bodies[k].force[0] * (w.bodies[k].x - last.bodies[k].x)
				    + last.bodies[k].force[1] * (w.bodies[k].y - last.bodies[k].y);
			friction += r.dissipated;
			lost += r.dissipated + r.damped + r.absorbed; // what springs absorb is stored, or lost in dashpots or by the scheme
			CHECK(r.dissipated > -1e-9);
			CHECK(r.dashpots >= 0);
			CHECK(kinetic(w) + lost == doctest::Approx(held + work).epsilon(1e-9).scale(1));
		}
		CHECK(friction > 0);
		ends.push_back(w);
	};
	for (const GroupKernel<Plane>& kernel : groupKernels<Plane>()) {
		useGroupKernel(kernel);
		run("auto", 1);
	}
	useGroupKernel(usual);
	run("auto", 2);
	for (std::size_t k = 1; k < ends.size(); k++)
		for (std::size_t i = 0; i < ends[0].bodies.size(); i++)
			CHECK(std::memcmp(ends[0].bodies[i].v, ends[k].bodies[i].v, sizeof ends[0].bodies[i].v) == 0);
	run("newton", 1);
	run("nsgs", 1);
	for (std::size_t k = ends.size() - 2; k < ends.size(); k++)
		for (std::size_t i = 0; i < ends[0].bodies.size(); i++)
			CHECK(ends[k].bodies[i].x == doctest::Approx(ends[0].bodies[i].x).epsilon(1e-6).scale(1));
}

// McNamara et al. 2008: Cundall and Strack's law leaves k_t depth angle at the end of a closed path: the arms are shorter on the way there than back.
TEST_CASE("a closed path of two disks leaves the force of the incremental law")
{
	constexpr double depth = 1e-3, angle = 0.1, kt = 1e3;
	constexpr int leg = 400;
	World w;
	tests::add(w, tests::diskAt(0, 0, 0.1));
	for (double& inverse : w.bodies[0].inverseMass)
		inverse = 0;
	tests::add(w, tests::diskAt(0.19, 0, 0.1, 1e15)); // so heavy that it goes as it is led
	w.pairs.push_back({ 0, 1, 10 });
	w.springs = true;
	w.stiffnesses.push_back({ 1e5, kt });
	TimeStep<Plane> t;
	for (int i = 0; i < 4 * leg; i++) {
		const double part = (i % leg + 1.) / leg, in[4] = { part, 1, 1 - part, 0 }, turned[4] = { 0, part, 1, 1 - part };
		const double distance = 0.19 - depth * in[i / leg], theta = angle * turned[i / leg];
		Body& b = w.bodies[1];
		b.v[0] = (distance * std::cos(theta) - b.x) / 1e-3;
		b.v[1] = (distance * std::sin(theta) - b.y) / 1e-3;
		make(t, w, settingsOf(1e-3));
	}
	CHECK(std::abs(w.carried[0].ft[1]) == doctest::Approx(kt * depth * angle).epsilon(0.01));
}
