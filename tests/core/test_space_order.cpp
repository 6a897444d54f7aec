// The order of the bodies along a curve through space.
#include "search/space_order.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <numeric>
#include <random>

using namespace cd;

namespace {

constexpr int boundary = std::numeric_limits<int>::max();

// A wall and disks at random places of a square of side 1.
World randomDisks(int disks, unsigned seed)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(0, 1);
	World w;
	w.bodies.resize(1 + disks);
	for (int i = 1; i <= disks; i++) {
		w.bodies[i].x = unit(random);
		w.bodies[i].y = unit(random);
		w.bodies[i].radius = 1e-3;
	}
	return w;
}

struct Kept {
	std::vector<int> rank;
	double path = 0;
	bool renew(const World& w, bool look) { return renewOrder(w, { rank, path }, look); }
};

} // namespace

TEST_CASE("every disk has its own place, a boundary none, and the way through them is short")
{
	const int disks = 5000;
	const World w = randomDisks(disks, 1);
	Kept kept;
	CHECK(kept.renew(w, false));
	CHECK(kept.rank[0] == boundary);
	std::vector<int> sorted(kept.rank.begin() + 1, kept.rank.end()), all(disks);
	std::sort(sorted.begin(), sorted.end());
	std::iota(all.begin(), all.end(), 0);
	CHECK(sorted == all);
	// The shortest way through n random points in an area A is 0.7124 sqrt(n A) long (Johnson, McGeoch & Rothberg 1996); curves that fill the
	// plane take about a third more, random order 0.52 n sqrt(A).
	CHECK(kept.path > 0.7124 * std::sqrt(disks));
	CHECK(kept.path < 1.5 * 0.7124 * std::sqrt(disks));
}

TEST_CASE("the order is renewed when the disks have mixed, if looked at, and otherwise stays")
{
	World w = randomDisks(5000, 2);
	Kept kept;
	kept.renew(w, true);
	const std::vector<int> first = kept.rank;
	CHECK(!kept.renew(w, true));
	for (Body& b : w.bodies) {
		b.x += 0.3 * b.y; // sheared as a whole
		b.y += 1e-4 * std::sin(1e3 * b.x);
	}
	CHECK(!kept.renew(w, true));
	CHECK(kept.rank == first);
	std::mt19937 random(3);
	std::shuffle(w.bodies.begin() + 1, w.bodies.end(), random);
	CHECK(!kept.renew(w, false));
	CHECK(kept.renew(w, true));
	CHECK(kept.path < 1.5 * 0.7124 * std::sqrt(5000 * 1.3));
	Kept anew;
	anew.renew(w, false);
	CHECK(kept.rank == anew.rank); // a function of where the bodies are
}

TEST_CASE("the order is renewed when bodies have come, not when they have gone, and few need none")
{
	World w = randomDisks(3000, 4);
	Kept kept;
	kept.renew(w, true);
	w.bodies[17] = {};
	CHECK(!kept.renew(w, true));
	w.bodies.push_back(w.bodies[5]);
	CHECK(kept.renew(w, false));
	CHECK(kept.rank.size() == w.bodies.size());
	CHECK(kept.rank[17] == boundary);
	w.bodies.resize(2000);
	CHECK(kept.renew(w, false));
	CHECK(kept.rank.empty());
	CHECK(!kept.renew(w, true));
}

TEST_CASE("disks in one point, on a line and one alone have an order")
{
	World w = randomDisks(2100, 5);
	for (Body& b : w.bodies)
		b.x = b.y = 0.25;
	Kept point;
	CHECK(point.renew(w, true));
	CHECK(point.path == 0);
	for (std::size_t i = 1; i < w.bodies.size(); i++)
		w.bodies[i].x = 1e-3 * static_cast<double>(i);
	Kept line;
	line.renew(w, true);
	CHECK(line.path == doctest::Approx(2.099));
	for (std::size_t i = 2; i < w.bodies.size(); i++)
		w.bodies[i].radius = 0;
	Kept alone;
	alone.renew(w, true);
	CHECK(alone.rank[1] == 0);
	CHECK(alone.path == 0);
}

TEST_CASE("an order that cannot be one, as from a damaged file, is made anew when it is looked at")
{
	const World w = randomDisks(3000, 6);
	Kept good;
	good.renew(w, true);
	for (const int wrong : { -1, static_cast<int>(w.bodies.size()), 2000000000, std::numeric_limits<int>::min() }) {
		Kept kept = good;
		kept.rank[7] = wrong;
		CHECK(!kept.renew(w, false));
		CHECK(kept.renew(w, true));
		CHECK(kept.rank == good.rank);
	}
	Kept endless = good;
	endless.path = std::numeric_limits<double>::quiet_NaN();
	CHECK(endless.renew(w, true));
	CHECK(endless.path == good.path);
}
