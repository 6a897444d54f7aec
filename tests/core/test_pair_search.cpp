// Near pairs: against a look at all of them, while bodies move.
#include "search/pair_search.hpp"
#include "search/reach.hpp"
#include "step/time_step.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <random>
#include <set>

using namespace cd;

namespace {

std::vector<Pair> pairsOf(PairSearch& search, World& w, const std::vector<int>& rank = {})
{
	search.find(w, rank);
	return w.pairs;
}

using Ids = std::set<std::pair<int, int>>;

// Disks of unequal size and speed, some boxes, a wall, a disk that is far away and fast, one that is in no contact.
World scene(int disks, unsigned seed, double speed)
{
	std::mt19937 draw(seed);
	std::uniform_real_distribution<double> u(0, 1);
	World w;
	const double size = 0.02 * std::sqrt(disks);
	const auto add = [&](const Body& b, const Shape& s) {
		w.bodies.push_back(b);
		w.shapes.push_back(s);
		w.masks.push_back(1);
	};
	for (int i = 0; i < disks; i++) {
		Body b;
		b.x = size * (u(draw) - 0.5);
		b.y = size * (u(draw) - 0.5);
		b.radius = 0.01 * (0.2 + u(draw));
		const double fast = u(draw) < 0.05 ? 50 * speed : speed;
		b.v[0] = fast * (u(draw) - 0.5);
		b.v[1] = fast * (u(draw) - 0.5);
		std::fill_n(b.inverseMass, 3, 1);
		add(b, {});
	}
	for (int i = 0; i < 12; i++) {
		Body b;
		b.x = size * (u(draw) - 0.5);
		b.y = size * (u(draw) - 0.5);
		Shape s;
		s.kind = ShapeKind::box;
		s.ex = i == 0 ? size : 0.05 * u(draw);
		s.ey = 0.01 * u(draw);
		s.cosine = std::cos(i);
		s.sine = std::sin(i);
		add(b, s);
	}
	Body b;
	Shape s;
	s.kind = ShapeKind::wall;
	s.axis = 1;
	b.y = -0.4 * size;
	add(b, s);
	w.bodies[3].x = 1e6;
	w.bodies[3].v[0] = 1e3;
	w.masks[4] = 0;
	return w;
}

double reach(const World& w, std::size_t i, double dt) { return reachOf(w.bodies[i], wayOf(w.bodies[i], w.shapes[i], dt)); }

bool twoBoundaries(const World& w, int i, int j) { return isBoundary(w.bodies[i]) && isBoundary(w.bodies[j]); }

double gap(const World& w, int i, int j)
{
	if (!isBoundary(w.bodies[i]))
		std::swap(i, j); // a boundary comes first
	return -locateContact(placeAhead(w.bodies[i], 0), placeAhead(w.bodies[j], 0), w.shapes[i]).overlap;
}

// Those that a step may need.
Ids needed(const World& w, double dt)
{
	Ids ids;
	const int n = static_cast<int>(w.bodies.size());
	for (int i = 0; i < n; i++)
		for (int j = i + 1; j < n; j++)
			if ((w.masks[i] & w.masks[j]) != 0 && !twoBoundaries(w, i, j) && gap(w, i, j) <= reach(w, i, dt) + reach(w, j, dt))
				ids.insert({ i, j });
	return ids;
}

Ids listed(const std::vector<Pair>& pairs)
{
	Ids ids;
	for (const Pair& p : pairs)
		CHECK(ids.insert(std::minmax(p.a, p.b)).second); // each once
	return ids;
}

} // namespace

TEST_CASE("the list holds all pairs that a step may need until it is made anew")
{
	constexpr double dt = 1e-3;
	for (const double speed : { 0.1, 3. })
		for (unsigned seed = 1; seed <= 5; seed++) {
			World w = scene(150, seed, speed);
			PairSearch search;
			std::vector<Pair> pairs;
			int searches = 0;
			for (int step = 0; step < 60; step++) {
				if (search.needed(w, dt, 0.1, {})) {
					pairs = pairsOf(search, w);
					searches++;
				}
				const Ids found = listed(pairs), all = needed(w, dt);
				CHECK(std::includes(found.begin(), found.end(), all.begin(), all.end()));
				for (std::size_t i = 0; i < w.bodies.size(); i++)
					CHECK((w.masks[i] == 0 || w.listed[i] >= reach(w, i, dt)));
				for (Body& b : w.bodies) {
					b.x += dt * b.v[0];
					b.y += dt * b.v[1];
					if (!isBoundary(b))
						b.v[1] -= 9.81 * dt;
				}
			}
			CHECK(searches > 1);
			CHECK(searches < 40); // though eight disks and more go many of their radii in a step
		}
}

TEST_CASE("fast bodies make nobody else's margin wider")
{
	std::size_t slow = 0;
	for (const double speed : { 0., 30. }) {
		World w = scene(400, 7, 0);
		for (int k = 0; k < 12; k++) { // above the others
			Body b = w.bodies[0];
			b.x = 0.05 * k;
			b.y = 5;
			b.v[0] = speed;
			w.bodies.push_back(b);
			w.shapes.emplace_back();
			w.masks.push_back(1);
		}
		w.bodies[3].v[0] = 0;
		PairSearch search;
		REQUIRE(search.needed(w, 1e-3, 0.1, {}));
		std::size_t among = 0;
		for (const Pair& p : pairsOf(search, w))
			among += std::max(p.a, p.b) < 413;
		if (speed == 0)
			slow = among;
		else
			CHECK(among <= 2 * slow); // half a radius, for what an impact may ask
	}
}

TEST_CASE("a few fast disks have margins that last long, but not where others are as fast")
{
	constexpr double dt = 1e-3, way = 0.01;
	for (const int fast : { 5, 100 }) {
		World w = scene(150, 1, 0);
		for (int i = 0; i < 150; i++)
			w.bodies[i].v[0] = i < fast ? way / dt : 0;
		PairSearch search;
		REQUIRE(search.needed(w, dt, 0.1, {}));
		pairsOf(search, w);
		for (int i = 0; i < fast; i++)
			if (w.masks[i] != 0)
				CHECK((search.marginOf(i) - reach(w, i, dt) > 20 * way) == (fast == 5));
	}
}

TEST_CASE("what changes a body makes the list anew")
{
	World w = scene(50, 1, 0);
	w.bodies[3].v[0] = 0;
	PairSearch search;
	REQUIRE(search.needed(w, 1e-3, 0.1, {}));
	pairsOf(search, w);
	CHECK(!search.needed(w, 1e-3, 0.1, {}));
	World other = w;
	other.bodies[5].radius *= 1.01;
	CHECK(search.needed(other, 1e-3, 0.1, {}));
	other = w;
	other.masks[5] = 2;
	CHECK(search.needed(other, 1e-3, 0.1, {}));
	other = w;
	other.apart = 1;
	CHECK(search.needed(other, 1e-3, 0.1, {}));
	other = w;
	other.shapes[52].sine = 0;
	CHECK(search.needed(other, 1e-3, 0.1, {}));
	other = w;
	other.bodies.pop_back();
	other.shapes.pop_back();
	other.masks.pop_back();
	CHECK(search.needed(other, 1e-3, 0.1, {}));
}

TEST_CASE("a body in no contact may move as it likes")
{
	World w = scene(50, 1, 0);
	w.bodies[3].v[0] = 0;
	w.bodies[4].v[0] = 50; // masked
	PairSearch search;
	REQUIRE(search.needed(w, 1e-3, 0.1, {}));
	pairsOf(search, w);
	for (int step = 0; step < 100; step++) {
		w.bodies[4].x += 0.05;
		CHECK(!search.needed(w, 1e-3, 0.1, {}));
	}
}

TEST_CASE("bodies far from the origin and one without a rank have their pairs in the same order")
{
	World w = scene(100, 4, 0);
	w.bodies[3].v[0] = 0;
	PairSearch here, there;
	REQUIRE(here.needed(w, 1e-3, 0.1, {}));
	std::vector<int> rank(w.bodies.size(), std::numeric_limits<int>::max());
	std::iota(rank.begin(), rank.begin() + 99, 0); // one disk less
	const std::vector<Pair> first = pairsOf(here, w, rank);
	for (Body& b : w.bodies) {
		b.x += 1e7;
		b.y -= 1e7;
	}
	REQUIRE(there.needed(w, 1e-3, 0.1, {}));
	const std::vector<Pair> second = pairsOf(there, w, rank);
	REQUIRE(first.size() > 50);
	const auto ids = listed(first), again = listed(second);
	std::vector<std::pair<int, int>> lost;
	std::set_symmetric_difference(ids.begin(), ids.end(), again.begin(), again.end(), std::back_inserter(lost));
	CHECK(lost.size() <= 1); // 1e7 m leave 2e-9 m
}

TEST_CASE("masks keep bodies apart as YADE's do")
{
	World w = scene(80, 2, 0);
	for (std::size_t i = 0; i < w.masks.size(); i++)
		w.masks[i] = 1 + static_cast<int>(i % 3); // 1, 2, 3
	PairSearch search;
	search.needed(w, 1e-3, 1, {});
	bool unequal = false;
	for (const Pair& p : pairsOf(search, w)) {
		CHECK((w.masks[p.a] & w.masks[p.b]) != 0);
		unequal = unequal || w.masks[p.a] != w.masks[p.b];
	}
	CHECK(unequal);
	w.apart = 2;
	REQUIRE(search.needed(w, 1e-3, 1, {}));
	for (const Pair& p : pairsOf(search, w))
		CHECK((w.masks[p.a] != w.masks[p.b] || w.masks[p.a] == 1));
}

TEST_CASE("pairs keep their places in the order whatever others are listed, and are found again")
{
	World w = scene(300, 3, 0);
	PairSearch search;
	std::mt19937 draw(1);
	std::vector<int> rank(w.bodies.size(), std::numeric_limits<int>::max());
	std::iota(rank.begin(), rank.begin() + 300, 0);
	std::shuffle(rank.begin(), rank.begin() + 300, draw);
	for (const std::vector<int>& ranks : { std::vector<int> {}, rank }) {
		search.needed(w, 1e-3, 3, {});
		const std::vector<Pair> many = pairsOf(search, w, ranks);
		search.needed(w, 1e-3, 0.1, {});
		const std::vector<Pair> few = pairsOf(search, w, ranks);
		REQUIRE(few.size() < many.size());
		CHECK(search.left().size() == many.size() - few.size());
		std::vector<int> numbers(many.size());
		std::iota(numbers.begin(), numbers.end(), 0);
		search.rearrange(numbers);
		int32_t before = -1;
		for (std::size_t k = 0; k < few.size(); k++) {
			const int32_t from = search.from()[k];
			REQUIRE(from > before);
			CHECK(many[from].a == few[k].a);
			CHECK(many[from].b == few[k].b);
			CHECK(numbers[k] == from);
			before = from;
		}
		search.needed(w, 1e-3, 3, {});
		search.find(w, ranks);
		CHECK(search.left().empty());
	}
}

TEST_CASE("a wall of one side is solid however far behind it")
{
	for (const int sense : { -1, 0, 1 })
		for (const double x : { -5., 5. }) {
			World w;
			for (const double at : { 0., x }) {
				Body b;
				b.x = at;
				w.bodies.push_back(b);
				w.shapes.emplace_back();
				w.masks.push_back(1);
			}
			w.shapes[0].kind = ShapeKind::wall;
			w.shapes[0].sense = sense;
			w.bodies[1].radius = 0.1;
			std::fill_n(w.bodies[1].inverseMass, 3, 1);
			PairSearch search;
			REQUIRE(search.needed(w, 1e-3, 0.1, {}));
			CHECK(pairsOf(search, w).size() == (sense * x < 0 ? 1 : 0));
		}
}

TEST_CASE("spheres are found beside facets that share a corner, each pair once")
{
	std::mt19937 draw(1);
	std::uniform_real_distribution<double> around(-1, 1);
	WorldOf<Space3> w;
	std::vector<double> margins;
	const auto add = [&](const Vector3& at, double radius, double margin) {
		SpaceBody b;
		b.at = at;
		b.radius = radius;
		w.bodies.push_back(b);
		w.shapes.push_back({});
		w.masks.push_back(1);
		margins.push_back(margin);
	};
	// Fans about three corners: the facets of one lie in few cells, those of the next in some, and those of the last in too many.
	int k = 0;
	for (const double size : { 0.02, 0.06, 1. })
		for (int i = 0; i < 60; i++) {
			add({ 0.3 * k, 0, 0 }, 0, 1e-3);
			SpaceShape& s = w.shapes.back();
			s.kind = ShapeKind::facet;
			s.part[0] = { 0, 0, 0 };
			for (const int end : { 0, 1 })
				s.part[1 + end] = size * Vector3 { std::cos(0.1 * (i + end)), std::sin(0.1 * (i + end)), 0.2 };
			k = i == 59 ? k + 1 : k;
		}
	for (int i = 0; i < 400; i++)
		add({ 0.5 * around(draw) + 0.3, 0.3 * around(draw), 0.1 * around(draw) }, 0.01, 4e-3 * (i % 3));
	add({ 0.3, 0, -0.55 }, 0.5, 1e-3); // a giant
	w.masks[200] = 0;
	const int n = static_cast<int>(w.bodies.size());
	Ids expected, seen;
	for (int i = 0; i < n; i++)
		for (int j = i + 1; j < n; j++)
			if (w.masks[i] != 0 && w.masks[j] != 0 && !isBoundary(w.bodies[j]))
				if (-locateContact(placeAhead(w.bodies[i], 0), placeAhead(w.bodies[j], 0), w.shapes[i]).overlap
				    <= margins[i] + margins[j])
					expected.insert({ i, j });
	std::vector<NearPair> found;
	NearPairsOf<Space3>().find(w, margins, found);
	for (const NearPair& p : found)
		CHECK(seen.insert(std::minmax(p.a, p.b)).second);
	CHECK(seen == expected);
	CHECK(expected.size() > 100);
}
