// The packed sweep: what may be in a group, and that neither the processor nor the packing shows in the result.
#include "allocations.hpp"
#include "graph/grouping.hpp"
#include "error/residual.hpp"
#include "sweeps/sweep.hpp"
#include "systems.hpp"
#include "base/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <doctest/doctest.h>
#include <functional>
#include <random>
#include <set>

using namespace cd;
using tests::heap;

namespace {

bool sameBits(const ContactSystem<Plane>& a, const ContactSystem<Plane>& b)
{
	for (std::size_t i = 0; i < a.contacts.size(); i++)
		if (std::memcmp(&a.contacts[i].pn, &b.contacts[i].pn, 2 * sizeof(double)) != 0)
			return false;
	for (std::size_t i = 0; i < a.bodies.size(); i++)
		if (std::memcmp(a.bodies[i].v, b.bodies[i].v, 3 * sizeof(double)) != 0)
			return false;
	return true;
}

} // namespace

TEST_CASE("every processor gives the same bits, with any number of contacts, and memory left by another problem does not show")
{
	const GroupKernel<Plane>& usual = groupKernel<Plane>();
	Workspace memory;
	for (const int contacts : { 0, 1, 7, 8, 9, 64, 1000 })
		for (const double mu : { 0., 0.5 })
			for (const bool general : { false, true })
				for (const unsigned seed : { 0u, 3u })
					for (const auto method : { "nsgs", "accelerated" })
						for (const int fixed : { 0, 5 }) {
							CAPTURE(contacts);
							CAPTURE(method);
							const ContactSystem<Plane> start = heap(1, contacts, mu, general);
							SolverSettings settings;
							settings.seed = seed;
							settings.fixedIterations = fixed;
							settings.maxIterations = 60;
							useGroupKernel(*groupKernels<Plane>().begin());
							ContactSystem<Plane> first = start;
							const SolverReport expected = findSolver(method)(first, settings);
							for (const GroupKernel<Plane>& kernel : groupKernels<Plane>()) {
								CAPTURE(kernel.name);
								useGroupKernel(kernel);
								ContactSystem<Plane> other = start;
								other.memory = &memory;
								const SolverReport report = findSolver(method)(other, settings);
								CHECK(sameBits(first, other));
								CHECK(report.iterations == expected.iterations);
								CHECK(std::memcmp(&report.residual, &expected.residual, sizeof(double)) == 0);
							}
						}
	useGroupKernel(usual);
}

// The groups are kept while the contacts stay the same; whatever else changes must reach the packing, and whatever the groups depend on must
// end their reuse.
TEST_CASE("a step after another with its memory gives the bits it gives without")
{
	using Change = std::function<void(ContactSystem<Plane>&)>;
	const std::vector<std::pair<const char*, Change>> changes = {
		{ "values only",
		    [](ContactSystem<Plane>& s) {
			    for (ContactRow<Plane>& c : s.contacts) {
				    c.bias *= 0.9;
				    c.mu *= 0.8;
				    std::swap(c.nx, c.ny);
				    c.pn = 1e-3;
			    }
		    } },
		{ "masses and inertias",
		    [](ContactSystem<Plane>& s) {
			    for (BodyVelocity<Plane>& b : s.bodies) {
				    b.w[0] *= 2;
				    b.w[1] *= 2;
				    b.w[2] *= 3;
			    }
		    } },
		{ "a body held", [](ContactSystem<Plane>& s) { std::fill_n(s.bodies[20].w, 3, 0.); } },
		{ "a rotation held", [](ContactSystem<Plane>& s) { s.bodies[20].w[2] = 0; } },
		{ "a body with one freedom", [](ContactSystem<Plane>& s) { s.bodies[20].w[1] = s.bodies[20].w[2] = 0; } },
		{ "two contacts exchanged", [](ContactSystem<Plane>& s) { std::swap(s.contacts[30], s.contacts[90]); } },
		{ "a contact gone", [](ContactSystem<Plane>& s) { s.contacts.resize(s.contacts.size() - 1); } },
		{ "a contact more", [](ContactSystem<Plane>& s) { s.contacts.push_back(s.contacts[7]); } },
		{ "a contact between others", [](ContactSystem<Plane>& s) { s.contacts[40].a = 0; } },
		{ "a contact that couples n and t", [](ContactSystem<Plane>& s) { s.contacts[41].bn = 0.2; } },
		{ "a contact of two immobile bodies", [](ContactSystem<Plane>& s) { s.contacts[42].a = s.contacts[42].b = 0; } },
		{ "a body more", [](ContactSystem<Plane>& s) { s.bodies.push_back(s.bodies.back()); } },
	};
	for (const auto& [what, change] : changes)
		for (const auto method : { "nsgs", "accelerated" }) {
			CAPTURE(what);
			CAPTURE(method);
			SolverSettings settings;
			settings.maxIterations = 40;
			ContactSystem<Plane> first = heap(6, 200, 0.4, false), changed = first;
			change(changed);
			changed.assembleBlocks();
			ContactSystem<Plane> fresh = changed, back = first, freshFirst = first;
			Workspace memory;
			first.memory = changed.memory = back.memory = &memory;
			findSolver(method)(fresh, settings);
			findSolver(method)(freshFirst, settings);
			findSolver(method)(first, settings);
			findSolver(method)(changed, settings);
			findSolver(method)(back, settings);
			CHECK(sameBits(changed, fresh));
			CHECK(sameBits(back, freshFirst));
		}
}

TEST_CASE("a solver asks for no memory where it has solved a problem of that size with the same Workspace, be it judged or surely solvable")
{
	const SolverSettings limits[]
	    = { tests::to(1e-6, 50), tests::to(0, 50), tests::to(1e-4, 5000) }; // 0: to the limit, returning the best iterate
	for (const auto method : { "nsgs", "accelerated" })
		for (const unsigned seed : { 0u, 3u })
			for (const double speed : { 0., 1. }) // 1: a floor that moves: the bodies no longer tell that there is a solution
				for (SolverSettings settings : limits) {
					CAPTURE(method);
					CAPTURE(seed);
					CAPTURE(speed);
					CAPTURE(settings.tolerance);
					settings.seed = seed;
					ContactSystem<Plane> s = heap(8, 300, 0.5, true);
					for (BodyVelocity<Plane>& b : s.bodies)
						b.v[0] += speed;
					DelassusSystem d = tests::matrixOf(s);
					Workspace memory;
					s.memory = d.memory = &memory;
					ContactSystem<Plane> again = s;
					DelassusSystem anew = d;
					findSolver(method)(s, settings);
					findDelassusSolver(method)(d, settings);
					for (ContactRow<Plane>& c : again.contacts)
						c.bias *= 0.5;
					const std::size_t before = allocations();
					const SolverReport report = findSolver(method)(again, settings);
					findDelassusSolver(method)(anew, settings);
					CHECK(allocations() == before);
					CHECK((report.status == Status::converged) == (settings.tolerance == 1e-4));
				}
}

// A disk held between two walls by a self-stress of 1, pushed on one of them by an impulse of 1/2, and both walls a little further apart than the
// disk is wide. Each plain sweep lets 2 gap of the self-stress go, its velocities and its error unchanged, so 1/(2 gap) are needed.
TEST_CASE("momentum brings a drift along a self-stress to its end")
{
	const double gap = 1e-5; // over h, of velocities of order 1
	ContactSystem<Plane> s;
	s.bodies.resize(2);
	s.bodies[1].w[0] = s.bodies[1].w[1] = 1;
	s.bodies[1].v[0] = -0.5;
	for (const double side : { 1., -1. }) {
		ContactRow<Plane> c = tests::contact(0, 1, side, 0, 0);
		c.bias = gap;
		c.pn = side > 0 ? 1.5 : 1;
		s.contacts.push_back(c);
	}
	s.assembleBlocks();
	ContactSystem<Plane> plain = s;
	const SolverReport slow = nsgs(plain, tests::to(1e-9)), report = accelerated(s, tests::to(1e-9));
	CHECK(slow.status == Status::stagnated);
	CHECK(report.status == Status::converged);
	CHECK(report.iterations < 0.02 / (2 * gap)); // Nesterov's sequence without a cap: 2 sqrt(1/(2 gap)), 450
	CHECK(s.contacts[0].pn == doctest::Approx(0.5 - gap).epsilon(1e-8)); // the tolerance on e, ten times
	CHECK(s.contacts[1].pn == 0);
}

// In groups, as leftovers and beside walls alike: contacts without a common body are solved by one sweep.
TEST_CASE("one sweep solves contacts that share no body, up to round-off")
{
	for (const int pairs : { 1, 7, 8, 9, 100 }) {
		ContactSystem<Plane> s;
		std::mt19937 random(7);
		std::uniform_real_distribution<double> unit(0, 1);
		s.bodies.resize(2 * pairs);
		for (int i = 0; i < pairs; i++) {
			for (int k = 0; k < 2; k++) {
				BodyVelocity<Plane>& b = s.bodies[2 * i + k];
				b.w[0] = b.w[1] = 0.5 + unit(random);
				b.w[2] = 1 + unit(random);
				b.v[0] = unit(random) - k;
				b.v[2] = unit(random) - 0.5;
			}
			ContactRow<Plane> c;
			c.a = 2 * i;
			c.b = 2 * i + 1;
			c.nx = std::cos(unit(random));
			c.ny = std::sqrt(1 - c.nx * c.nx);
			c.at = 0.5;
			c.bt = -0.7;
			c.mu = unit(random);
			s.contacts.push_back(c);
		}
		s.assembleBlocks();
		SolverSettings settings;
		settings.fixedIterations = 1;
		CHECK(nsgs(s, settings).residual < 1e-15 * 8); // a few roundings of numbers of order 1
	}
}

TEST_CASE("no contact is lost, the contacts of a group share no movable body, nor do neighbouring groups before the last 64")
{
	std::mt19937 random(9);
	const int bodies = 400, contacts = 1500, hub = bodies - 1, floor = 0;
	Grouping grouping;
	std::vector<uint64_t> has;
	for (const bool withHub : { true, false, true }) { // again with what the others left behind
		CAPTURE(withHub);
		std::vector<std::pair<int, int>> ends;
		has.assign(bodies, 0);
		BodyGroups groups(grouping, has);
		for (int i = 0; i < contacts; i++) {
			const int near = 1 + i * (bodies - 20) / contacts;
			const int a = i % 10 == 0 ? floor : near + random() % 8, b = withHub && i % 9 == 0 ? hub : near + 9 + random() % 8;
			ends.emplace_back(a, b);
			groups.add({ i, a != floor ? a : b, b });
		}
		groups.end();
		CHECK((withHub || grouping.loose.size() <= 10)); // what the last groups, cut short, dissolved into
		std::multiset<int> seen(grouping.loose.begin(), grouping.loose.end());
		std::set<int> before;
		for (std::size_t g = 0; g < grouping.groups(); g++) {
			std::set<int> now;
			for (int lane = 0; lane < lanes; lane++) {
				const int contact = grouping.members[g * lanes + lane];
				if (contact < 0)
					continue;
				seen.insert(contact);
				for (const int body : { ends[contact].first, ends[contact].second })
					if (body != floor) {
						CHECK(now.insert(body).second);
						CHECK((before.count(body) == 0 || withHub || g + 64 > grouping.groups()));
					}
			}
			before = now;
		}
		CHECK(seen.size() == contacts);
		CHECK(*seen.begin() == 0);
		CHECK(*seen.rbegin() == contacts - 1);
		CHECK(std::adjacent_find(seen.begin(), seen.end()) == seen.end());
	}
}
