// Where bodies touch, against geometry done the slow way.
#include "scene/scene.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace cd;

namespace {

struct Item : Body {
	Shape shape;
};

Item disk(double x, double y, double r)
{
	Item b;
	b.x = x;
	b.y = y;
	b.radius = r;
	return b;
}

Item box(double x, double y, double ex, double ey, double angle)
{
	Item b;
	b.x = x;
	b.y = y;
	b.shape.kind = ShapeKind::box;
	b.shape.ex = ex;
	b.shape.ey = ey;
	b.shape.cosine = std::cos(angle);
	b.shape.sine = std::sin(angle);
	return b;
}

Touch locate(const Item& a, const Item& b, double ahead = 0) { return locateContact(placeAhead(a, ahead), placeAhead(b, ahead), a.shape); }

} // namespace

TEST_CASE("disk on box: the nearest of many points of the outline, over faces and corners, at any angle")
{
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(-1, 1);
	for (int trial = 0; trial < 200; trial++) {
		const double angle = 3 * unit(random), ex = 0.3, ey = 0.1;
		Item a = box(unit(random), unit(random), ex, ey, angle);
		Item b = disk(a.x + unit(random), a.y + unit(random), 0.05);
		const Touch p = locate(a, b);
		const double c = std::cos(angle), s = std::sin(angle);
		double nearest = 1e9, nx = 0, ny = 0;
		for (int i = 0; i < 40000; i++) {
			const double t = i / 10000.0, u = 2 * (t - std::floor(t)) - 1;
			const double lx = i < 10000 ? u * ex : i < 20000 ? ex : i < 30000 ? -u * ex : -ex;
			const double ly = i < 10000 ? -ey : i < 20000 ? u * ey : i < 30000 ? ey : -u * ey;
			const double dx = b.x - (a.x + c * lx - s * ly), dy = b.y - (a.y + s * lx + c * ly);
			if (std::hypot(dx, dy) < nearest) {
				nearest = std::hypot(dx, dy);
				nx = dx;
				ny = dy;
			}
		}
		const double lx = c * (b.x - a.x) + s * (b.y - a.y), ly = -s * (b.x - a.x) + c * (b.y - a.y);
		const double sign = std::abs(lx) < ex && std::abs(ly) < ey ? -1 : 1;
		// The outline is sampled every 6e-5 m; a tangential miss of d costs d^2/(2 distance) in distance.
		CHECK(-p.overlap == doctest::Approx(sign * nearest - 0.05).epsilon(1e-4));
		CHECK(std::hypot(p.nx, p.ny) == doctest::Approx(1));
		if (nearest > 0.05)
			CHECK(p.nx * nx / nearest + p.ny * ny / nearest == doctest::Approx(sign).epsilon(1e-3));
	}
}

TEST_CASE("both bodies see the contact point midway between the surfaces")
{
	Item a = disk(0, 0, 0.2), b = disk(0.35, 0, 0.1);
	const Touch p = locate(a, b);
	CHECK(p.overlap == doctest::Approx(-0.05));
	CHECK(p.cx == doctest::Approx(0.225));
}

TEST_CASE("bodies are placed ahead by their velocities, a box also turned")
{
	Item a = box(0, 0, 1, 0.1, 0), b = disk(0, 1, 0.05);
	a.v[2] = 2;
	b.v[1] = -1;
	const Touch p = locate(a, b, 0.25);
	CHECK(p.nx == doctest::Approx(-std::sin(0.5)));
	CHECK(-p.overlap == doctest::Approx(0.75 * std::cos(0.5) - 0.1 - 0.05));
}

TEST_CASE("a wall acts on its side only")
{
	Item wall;
	wall.shape.kind = ShapeKind::wall;
	wall.shape.axis = 0;
	Item d = disk(-0.3, 5, 0.1);
	const Touch before = locate(wall, d);
	CHECK(before.overlap == doctest::Approx(-0.2));
	CHECK(before.nx == -1);
	wall.shape.sense = 1;
	const Touch behind = locate(wall, d);
	CHECK(behind.overlap == doctest::Approx(0.4));
	CHECK(behind.nx == 1);
}

TEST_CASE("a disk on a wall of no thickness is pushed back to its own side")
{
	Item plate = box(0, 0, 0, 1, 0);
	for (const double side : { -1., 1. }) {
		Item d = disk(side * 0.02, 0.3, 0.1);
		const Touch p = locate(plate, d);
		CHECK(p.nx == side);
		CHECK(p.overlap == doctest::Approx(0.08));
	}
}
