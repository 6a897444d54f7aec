// Threads and the blocks they sweep: every part of the work is done once, and nothing of a result shows by how many.
#include "graph/blocks.hpp"
#include "search/space_order.hpp"
#include "sweeps/sweep.hpp"
#include "systems.hpp"
#include "base/threads.hpp"
#include "step/time_step.hpp"
#include "worlds.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <doctest/doctest.h>
#include <functional>
#include <numeric>
#include <random>
#include <set>

using namespace cd;

namespace {

constexpr int counts[] = { 1, 2, 3, 4, 8, 16 };

bool same(const void* a, const void* b, std::size_t bytes) { return std::memcmp(a, b, bytes) == 0; }

template <class T> bool same(const std::vector<T>& a, const std::vector<T>& b)
{
	return a.size() == b.size() && same(a.data(), b.data(), a.size() * sizeof(T));
}

// 3721 disks in a lattice: more contacts than one block may have, in the order of its rows. The left wall is pressed on them; beside them a pair of
// disks that touch nothing else.
ContactSystem<Plane> packing()
{
	ContactSystem<Plane> s = tests::lattice(61, 0.5, 3);
	const int wall = 61 * 61 + 1, pair = static_cast<int>(s.bodies.size());
	s.bodies[wall].w[0] = 0.1;
	s.bodies[wall].v[0] = 0.3;
	s.bodies.resize(s.bodies.size() + 2);
	for (const int disk : { pair, pair + 1 }) {
		std::copy_n(s.bodies[0].w, 3, s.bodies[disk].w);
		s.bodies[disk].v[0] = disk == pair ? 0.1 : 0;
	}
	ContactRow<Plane> c = s.contacts[0];
	c.a = pair;
	c.b = pair + 1;
	s.contacts.push_back(c);
	s.assembleBlocks();
	return s;
}

// The lattice's contacts in the order that the plug-in sweeps them: along a curve through its disks, scattered among 32 of them.
ContactSystem<Plane> alongCurve(int rows, double mu)
{
	ContactSystem<Plane> s = tests::lattice(rows, mu);
	World w;
	w.bodies.resize(s.bodies.size());
	w.shapes.resize(s.bodies.size());
	for (int i = 0; i < rows * rows; i++) {
		w.bodies[i].x = 2 * (i % rows) + (i / rows) % 2;
		w.bodies[i].y = std::sqrt(3.) * (i / rows);
		w.bodies[i].radius = 1;
	}
	std::vector<int> rank;
	double path = 0;
	renewOrder(w, { rank, path }, true);
	const auto key = [&](const ContactRow<Plane>& c) {
		const uint64_t both = static_cast<uint64_t>(std::min(c.a, c.b)) << 32 | static_cast<uint64_t>(std::max(c.a, c.b));
		return std::make_pair(std::min(rank[c.a], rank[c.b]) / 32, both * 0x9E3779B97F4A7C15ull);
	};
	std::sort(s.contacts.begin(), s.contacts.end(), [&](const ContactRow<Plane>& a, const ContactRow<Plane>& b) { return key(a) < key(b); });
	return s;
}

} // namespace

TEST_CASE("every part is done once by every number of threads, and none is started for one")
{
	for (const int count : counts) {
		CAPTURE(count);
		Threads threads;
		threads.use(count);
		for (const std::vector<int32_t>& bounds :
		    { std::vector<int32_t> { 0, 1 }, { 3, 3 }, { 0, 2 }, { 5, 6, 6, 70 }, { 0, 64 }, { 0, 1000 } }) {
			const std::size_t rows = bounds.size() - 1;
			const bool before = threads.started();
			std::vector<std::atomic<int>> done(bounds.back());
			for (int again = 0; again < 200; again++)
				threads.run(bounds.data(), rows, [&](int32_t part) { done[part]++; });
			for (int32_t part = 0; part < bounds.back(); part++)
				CHECK(done[part] == (part < bounds[0] ? 0 : 200));
			CHECK((before || threads.started() == (count > 1 && bounds.back() - bounds[0] > 1)));
		}
		Threads moved = std::move(threads);
		CHECK(moved.started() == (count > 1));
		CHECK(moved.count() == count);
	}
}

TEST_CASE("sums over ranges are the same bits by every number of threads, and those of few items are plain sums")
{
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(-1, 1);
	std::vector<double> x(100000);
	for (double& one : x)
		one = unit(random);
	const auto sum = [&](std::size_t from, std::size_t to) { return std::accumulate(&x[from], &x[0] + to, 0.); };
	for (const std::size_t n : { std::size_t(0), Cut::few - 1, x.size() }) {
		const double alone = reduceRanges<double>(nullptr, n, sum, std::plus<double>());
		CHECK(alone == doctest::Approx(sum(0, n)).epsilon(1e-12));
		CHECK((n >= Cut::few || alone == sum(0, n)));
		for (const int count : counts) {
			Threads threads;
			threads.use(count);
			const double shared = reduceRanges<double>(&threads, n, sum, std::plus<double>());
			CHECK(same(&alone, &shared, sizeof alone));
			CHECK(threads.started() == (count > 1 && n >= Cut::few));
			CHECK(!anyOf(&threads, n, [&](std::size_t i) { return x[i] > 1; }));
			CHECK(anyOf(&threads, n, [&](std::size_t i) { return i + 1 == n; }) == (n > 0));
		}
	}
}

TEST_CASE("blocks hold every contact once in the order given, and those of a colour share no body that can move")
{
	const int disks = 6000, wall = disks, floor = disks + 1, contacts = 20000;
	std::mt19937 random(3);
	std::vector<uint8_t> freedom(disks + 2, 3);
	freedom[wall] = 1;
	freedom[floor] = 0;
	std::vector<Link> links;
	for (int i = 0; i < contacts; i++) {
		const int near = static_cast<int>(static_cast<long>(i) * (disks - 40) / contacts);
		const int a = i % 50 == 0 ? wall : i % 20 == 0 ? floor : near + static_cast<int>(random() % 20);
		links.push_back({ a, near + 20 + static_cast<int>(random() % 20), i % 7 == 0 || i % 11 != 0 });
	}
	for (const int n : { 100, contacts, static_cast<int>(Blocks::worthwhile) }) {
		CAPTURE(n);
		const std::vector<Link> some(links.begin(), links.begin() + n);
		Blocks blocks;
		blocks.cut(some, freedom);
		std::multiset<int32_t> seen(blocks.contacts.begin(), blocks.contacts.end());
		CHECK(seen.size() == static_cast<std::size_t>(std::count_if(some.begin(), some.end(), [](const Link& l) { return l.solvable; })));
		CHECK(std::adjacent_find(seen.begin(), seen.end()) == seen.end());
		CHECK((n == contacts) == (blocks.count() > 1)); // the others have too few that can be solved
		if (n == contacts) {
			CHECK(blocks.count() >= 30);
			CHECK(blocks.colours() >= 3); // neighbours along the line, and the wall
			CHECK(blocks.colours() <= 6);
		}
		for (std::size_t c = 0; c < blocks.colours(); c++) {
			std::vector<int> owner(freedom.size(), -1);
			for (int32_t b = blocks.colour[c]; b < blocks.colour[c + 1]; b++)
				for (int32_t k = blocks.block[b]; k < blocks.block[b + 1]; k++) {
					CHECK((k == blocks.block[b] || blocks.contacts[k - 1] < blocks.contacts[k]));
					for (const int32_t body : { some[blocks.contacts[k]].a, some[blocks.contacts[k]].b }) {
						CHECK((freedom[body] == 0 || owner[body] < 0 || owner[body] == b));
						owner[body] = b;
						CHECK((n < contacts || body != wall || c + 1 == blocks.colours()));
					}
				}
		}
	}
}

TEST_CASE("every number of threads gives the same bits, by every method")
{
	const ContactSystem<Plane> start = packing();
	{
		ContactSystem<Plane> swept = start;
		const Sweep<Plane> sweep(swept, 0);
		CHECK(sweep.blocks().count() > 10);
		CHECK(sweep.blocks().colours() > 2);
		const Blocks& blocks = sweep.blocks();
		CHECK(blocks.block[blocks.count()] - blocks.block[blocks.count() - 1] == 31); // the wall's come last, in a block of their own
	}
	for (const char* const method : { "nsgs", "accelerated", "newton", "auto" })
		for (const unsigned seed : { 0u, 3u }) {
			CAPTURE(method);
			CAPTURE(seed);
			const bool factorizes = std::strcmp(method, "newton") == 0 || std::strcmp(method, "auto") == 0;
			if (factorizes && seed > 0)
				continue;
			SolverSettings settings;
			settings.tolerance = 1e-5;
			settings.maxIterations = factorizes ? 12 : 60; // sweeps, and a few factorizations
			settings.seed = seed;
			ContactSystem<Plane> alone = start;
			const SolverReport expected = findSolver(method)(alone, settings);
			CHECK(expected.iterations >= settings.maxIterations);
			for (const int count : counts) {
				CAPTURE(count);
				Threads threads;
				threads.use(count);
				settings.threads = &threads;
				ContactSystem<Plane> shared = start;
				const SolverReport report = findSolver(method)(shared, settings);
				CHECK(threads.started() == (count > 1));
				CHECK(same(alone.contacts.all(), shared.contacts.all()));
				CHECK(same(alone.bodies, shared.bodies));
				CHECK(report.iterations == expected.iterations);
				CHECK(same(&report.residual, &expected.residual, sizeof(double)));
				CHECK(same(&report.bodyError, &expected.bodyError, sizeof(double)));
				CHECK(report.body == expected.body);
			}
			settings.threads = nullptr;
		}
}

TEST_CASE("steps are the same bits by every number of threads, with restitution and without, in islands and as a whole")
{
	for (const bool reduce : { false, true })
		for (const double restitution : { 0., 0.7 }) {
			CAPTURE(reduce);
			CAPTURE(restitution);
			World expected;
			std::vector<std::array<double, 3>> forces, shared;
			double dissipated = 0;
			int most = 0;
			for (const int count : counts) {
				CAPTURE(count);
				World w = tests::flow(80, 80);
				TimeStep<Plane> step;
				StepSettings<Plane> settings;
				settings.dt = 2e-3;
				settings.restitution = restitution;
				settings.reduce = reduce;
				settings.threads = count;
				settings.solve = findSolver("auto");
				settings.solver.tolerance = 1e-2;
				settings.solver.maxIterations = 200;
				double lost = 0;
				for (int i = 0; i < 4; i++) {
					step.sleepers.update(w);
					const StepReport report = step(w, settings);
					CHECK(report.solver.status != Status::diverged);
					most = std::max(most, report.contacts);
					lost += report.dissipated;
				}
				shared = step.impulsesOn(w);
				if (count == 1) {
					expected = w;
					forces = shared;
					dissipated = lost;
					continue;
				}
				CHECK(same(expected.bodies, w.bodies));
				CHECK(same(forces, shared));
				CHECK(same(&dissipated, &lost, sizeof lost));
				CHECK(same(expected.carried, w.carried));
				bool pairs = true;
				for (std::size_t i = 0; i < w.pairs.size(); i++)
					pairs = pairs && same(&expected.pairs[i].reference, &w.pairs[i].reference, sizeof(double));
				CHECK(pairs);
			}
			CHECK((restitution > 0 || most > static_cast<int>(Blocks::worthwhile)));
		}
}

// The numbers are those of sweeps in one order, without blocks (Blocks::worthwhile above all numbers of contacts; those to 1e-3 by plain and to 1e-4
// by accelerated sweeps are those of commit ed647a4, before there were blocks). The lattice is in the order of the plug-in.
TEST_CASE("blocks cost no sweeps")
{
	const struct {
		double tolerance;
		int plain, accelerated;
	} known[] = { { 1e-3, 533, 63 }, { 1e-4, 2054, 121 }, { 1e-6, 6254, 264 } };
	for (const auto& one : known) {
		ContactSystem<Plane> plain = alongCurve(61, 0.5), ahead = plain;
		CHECK(Sweep(plain, 0).blocks().count() > 10);
		const SolverReport slow = nsgs(plain, tests::to(one.tolerance)), fast = accelerated(ahead, tests::to(one.tolerance));
		CHECK(slow.status == Status::converged);
		CHECK(slow.iterations <= 1.05 * one.plain);
		CHECK(fast.status == Status::converged);
		CHECK(fast.iterations <= 1.05 * one.accelerated);
	}
}
