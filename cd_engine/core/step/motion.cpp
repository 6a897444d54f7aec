#include "step/motion.hpp"
#include "search/search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <functional>

namespace cd {
namespace {

	inline void setFree(const Body& b, double dt, BodyVelocity<Plane>& s)
	{
		for (int k = 0; k < 3; k++) {
			s.w[k] = b.inverseMass[k];
			s.v[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
		}
		const double ax = b.inverseMass[0] * b.force[0], ay = b.inverseMass[1] * b.force[1];
		s.pushed = dt * std::sqrt(ax * ax + ay * ay);
		s.twisted = dt * b.inverseMass[2] * std::abs(b.force[2]);
	}

} // namespace

double smallestRadius(const World& world)
{
	double smallest = endless;
	for (const Body& b : world.bodies)
		smallest = isBoundary(b) ? smallest : std::min(smallest, b.radius);
	return smallest;
}

BodyMotion<Plane>::Start BodyMotion<Plane>::begin(const World& world, double dt, ContactSystem<Plane>& system, Threads& threads)
{
	assert(dt > 0 && world.shapes.size() == world.bodies.size());
	const std::size_t count = world.bodies.size();
	const bool known = system.bodies.size() == count;
	system.bodies.resize(count);
	system.places.resize(count);
	placeOf.resize(count);
	way.resize(count);
	shifts.clear();
	const double ahead = world.ahead(dt);
	const bool belts = !world.surfaces.empty();
	const auto begin = [&](std::size_t from, std::size_t to) {
		Start start { false, known, false };
		for (std::size_t i = from; i < to; i++) {
			const Body& b = world.bodies[i];
			start.sameMasses = start.sameMasses && std::equal(b.inverseMass, b.inverseMass + 3, system.bodies[i].w);
			setFree(b, dt, system.bodies[i]);
			const bool belt = belts && world.isBelt(i);
			if (belt)
				system.bodies[i].v[2] = 1;
			placeOf[i] = placeAhead(b, ahead);
			system.places[i] = { placeOf[i].x, placeOf[i].y };
			way[i] = belt ? 0 : wayOf(b, world.shapes[i], system.bodies[i].v, dt);
			start.turns = start.turns || (isBoundary(b) && b.v[2] != 0);
			start.guides = start.guides || (!isBoundary(b) && isGuided(b));
		}
		return start;
	};
	return reduceRanges<Start>(&threads, count, begin, [](const Start& a, const Start& b) {
		return Start { a.turns || b.turns, a.sameMasses && b.sameMasses, a.guides || b.guides };
	});
}

void BodyMotion<Plane>::resetFree(const World& world, double dt, ContactSystem<Plane>& system, Threads& threads)
{
	const bool belts = !world.surfaces.empty();
	forRanges(&threads, world.bodies.size(), [&](std::size_t from, std::size_t to) {
		for (std::size_t i = from; i < to; i++) {
			setFree(world.bodies[i], dt, system.bodies[i]);
			if (belts && world.isBelt(i))
				system.bodies[i].v[2] = 1;
		}
	});
}

inline double BodyMotion<Plane>::reach(const World& world, std::size_t i, double dt) const
{
	return contact_limits::quick * dt * (meanOf[i].speed + 0.5 * outlineSpeed(world.bodies[i].v, world.bodies[i], world.shapes[i]));
}

std::vector<double> BodyMotion<Plane>::reaches(const World& world, double dt) const
{
	std::vector<double> all(meanOf.size());
	for (std::size_t i = 0; i < all.size(); i++)
		all[i] = reach(world, i, dt);
	return all;
}

bool BodyMotion<Plane>::average(const World& world, double dt, const std::vector<BodyVelocity<Plane>>& bodies, bool solved, Threads& threads)
{
	assert(bodies.size() == world.bodies.size() && way.size() == bodies.size());
	meanOf.resize(bodies.size());
	const bool implicit = world.compliant(), belts = !world.surfaces.empty();
	double most = endless;
	if (!solved && !way.empty())
		most = (4 * *std::max_element(way.begin(), way.end()) + 2 * smallestRadius(world)) / dt;
	struct Found {
		double fastest = 0;
		bool outran = false;
	};
	const auto average = [&](std::size_t from, std::size_t to) {
		Found found;
		for (std::size_t i = from; i < to; i++) {
			const Body& b = world.bodies[i];
			const double* v = bodies[i].v;
			for (int k = 0; k < 3; k++)
				meanOf[i].v[k] = implicit ? v[k] : 0.5 * (b.v[k] + v[k]);
			meanOf[i].speed = std::min(outlineSpeed(v, b, world.shapes[i]), most);
			if (belts && world.isBelt(i))
				meanOf[i] = { { v[0], v[1], v[2] }, 0 };
			found.fastest = std::max(found.fastest, meanOf[i].speed);
			found.outran = found.outran || (i < world.listed.size() && reach(world, i, dt) > world.listed[i]);
		}
		return found;
	};
	const Found all = reduceRanges<Found>(&threads, bodies.size(), average, [](const Found& a, const Found& b) {
		return Found { std::max(a.fastest, b.fastest), a.outran || b.outran };
	});
	largestSpeed = all.fastest;
	return all.outran;
}

void BodyMotion<Plane>::shift(int32_t disk, double x, double y)
{
	shifts.push_back({ disk, x, y });
	placeOf[disk].x += x;
	placeOf[disk].y += y;
}

bool BodyMotion<Plane>::finish(World& world, double h, const std::vector<BodyVelocity<Plane>>& bodies, Threads& threads) const
{
	const bool implicit = world.compliant(), belts = !world.surfaces.empty();
	const auto move = [&](std::size_t from, std::size_t to) {
		bool moves = false;
		for (std::size_t i = from; i < to; i++) {
			Body& b = world.bodies[i];
			const double* v = bodies[i].v;
			if (belts && world.isBelt(i)) {
				b.turn = 0;
				continue;
			}
			if (implicit) {
				b.x += h * v[0];
				b.y += h * v[1];
				b.turn = h * v[2];
			} else {
				b.x += 0.5 * h * (b.v[0] + v[0]);
				b.y += 0.5 * h * (b.v[1] + v[1]);
				b.turn = 0.5 * h * (b.v[2] + v[2]);
			}
			std::memcpy(b.v, v, sizeof b.v);
			moves = moves || v[0] != 0 || v[1] != 0 || v[2] != 0;
		}
		return moves;
	};
	const bool moves = reduceRanges<bool>(&threads, world.bodies.size(), move, [](bool a, bool b) { return a || b; });
	for (const Shift& shift : shifts) {
		world.bodies[shift.disk].x += shift.x;
		world.bodies[shift.disk].y += shift.y;
	}
	return moves;
}

double BodyMotion<Plane>::damped(const World& world, const std::vector<BodyVelocity<Plane>>& bodies, Threads& threads)
{
	return reduceRanges<double>(
	    &threads, bodies.size(),
	    [&](std::size_t from, std::size_t to) {
		    double sum = 0;
		    for (std::size_t i = from; i < to; i++)
			    for (int k = 0; k < 3; k++)
				    if (const Body& b = world.bodies[i]; b.inverseMass[k] > 0)
					    sum += 0.5 * (bodies[i].v[k] - b.v[k]) * (bodies[i].v[k] - b.v[k]) / b.inverseMass[k];
		    return sum;
	    },
	    std::plus<double>());
}

void BodyMotion<Plane>::placeBack(const World& world, double dt)
{
	placeOf.clear();
	for (const Body& b : world.bodies)
		placeOf.push_back(placeAhead(b, world.ahead(dt) - dt));
}

} // namespace cd
