#include "step/motion_in_space.hpp"
#include "search/search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <functional>

namespace cd {
namespace {

	void setFree(const SpaceBody& b, double dt, BodyVelocity<Space3>& s)
	{
		Vector3 gained[2];
		for (int k = 0; k < Space3::freedoms; k++) {
			const double gain = dt * b.inverseMass[k] * b.force[k];
			s.w[k] = b.inverseMass[k];
			s.v[k] = b.v[k] + gain;
			gained[k / 3][k % 3] = gain;
		}
		s.pushed = length(gained[0]);
		s.twisted = length(gained[1]);
	}

} // namespace

double smallestRadius(const WorldOf<Space3>& world)
{
	double smallest = endless;
	for (const SpaceBody& b : world.bodies)
		smallest = isBoundary(b) ? smallest : std::min(smallest, b.radius);
	return smallest;
}

// The shapes of boundaries that turn, as they stand where contact is looked for.
void BodyMotion<Space3>::standShapes(const WorldOf<Space3>& world, double ahead)
{
	turned.resize(world.shapes.size());
	for (std::size_t i = 0; i < world.bodies.size(); i++)
		if (const SpaceBody& b = world.bodies[i]; isBoundary(b))
			turned[i] = turns(b) ? rotated(world.shapes[i], ahead * spinOf(b)) : world.shapes[i];
	shapeOf = &turned;
}

BodyMotion<Space3>::Start BodyMotion<Space3>::begin(const WorldOf<Space3>& world, double dt, ContactSystem<Space3>& system, Threads& threads)
{
	assert(dt > 0 && world.shapes.size() == world.bodies.size());
	const std::size_t count = world.bodies.size();
	const bool known = way.size() == count && system.bodies.size() >= count;
	system.bodies.resize(count);
	system.places.resize(count);
	placeOf.resize(count);
	way.resize(count);
	shifts.clear();
	const double ahead = world.ahead(dt);
	const auto begin = [&](std::size_t from, std::size_t to) {
		Start start { false, known, false };
		for (std::size_t i = from; i < to; i++) {
			const SpaceBody& b = world.bodies[i];
			start.sameMasses = start.sameMasses && std::equal(b.inverseMass, b.inverseMass + Space3::freedoms, system.bodies[i].w);
			setFree(b, dt, system.bodies[i]);
			placeOf[i] = placeAhead(b, ahead);
			system.places[i] = { placeOf[i].at.x, placeOf[i].at.y, placeOf[i].at.z };
			way[i] = wayOf(b, world.shapes[i], system.bodies[i].v, dt);
			start.turns = start.turns || (isBoundary(b) && turns(b));
			start.guides = start.guides || (!isBoundary(b) && isGuided(b));
		}
		return start;
	};
	const Start all = reduceRanges<Start>(&threads, count, begin, [](const Start& a, const Start& b) {
		return Start { a.turns || b.turns, a.sameMasses && b.sameMasses, a.guides || b.guides };
	});
	shapeOf = &world.shapes;
	if (all.turns)
		standShapes(world, ahead);
	return all;
}

void BodyMotion<Space3>::resetFree(const WorldOf<Space3>& world, double dt, ContactSystem<Space3>& system, Threads& threads)
{
	forRanges(&threads, world.bodies.size(), [&](std::size_t from, std::size_t to) {
		for (std::size_t i = from; i < to; i++)
			setFree(world.bodies[i], dt, system.bodies[i]);
	});
}

double BodyMotion<Space3>::reach(const WorldOf<Space3>& world, std::size_t i, double dt) const
{
	return contact_limits::quick * dt * (meanOf[i].speed + 0.5 * outlineSpeed(world.bodies[i].v, world.bodies[i], world.shapes[i]));
}

std::vector<double> BodyMotion<Space3>::reaches(const WorldOf<Space3>& world, double dt) const
{
	std::vector<double> all(meanOf.size());
	for (std::size_t i = 0; i < all.size(); i++)
		all[i] = reach(world, i, dt);
	return all;
}

bool BodyMotion<Space3>::average(
    const WorldOf<Space3>& world, double dt, const std::vector<BodyVelocity<Space3>>& bodies, bool solved, Threads& threads)
{
	assert(bodies.size() >= world.bodies.size() && way.size() == world.bodies.size());
	meanOf.resize(way.size());
	const bool implicit = world.compliant();
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
			const SpaceBody& b = world.bodies[i];
			const double* v = bodies[i].v;
			for (int k = 0; k < Space3::freedoms; k++)
				meanOf[i].v[k] = implicit ? v[k] : 0.5 * (b.v[k] + v[k]);
			meanOf[i].speed = std::min(outlineSpeed(v, b, world.shapes[i]), most);
			found.fastest = std::max(found.fastest, meanOf[i].speed);
			found.outran = found.outran || (i < world.listed.size() && reach(world, i, dt) > world.listed[i]);
		}
		return found;
	};
	const Found all = reduceRanges<Found>(&threads, way.size(), average, [](const Found& a, const Found& b) {
		return Found { std::max(a.fastest, b.fastest), a.outran || b.outran };
	});
	largestSpeed = all.fastest;
	return all.outran;
}

void BodyMotion<Space3>::shift(int32_t sphere, const Vector3& by)
{
	shifts.push_back({ sphere, by });
	placeOf[sphere].at = placeOf[sphere].at + by;
}

bool BodyMotion<Space3>::finish(WorldOf<Space3>& world, double h, const std::vector<BodyVelocity<Space3>>& bodies, Threads& threads) const
{
	const bool implicit = world.compliant();
	const auto move = [&](std::size_t from, std::size_t to) {
		bool moves = false;
		for (std::size_t i = from; i < to; i++) {
			SpaceBody& b = world.bodies[i];
			const double* v = bodies[i].v;
			for (int k = 0; k < 3; k++) {
				b.at[k] += implicit ? h * v[k] : 0.5 * h * (b.v[k] + v[k]);
				b.turn[k] = implicit ? h * v[k + 3] : 0.5 * h * (b.v[k + 3] + v[k + 3]);
			}
			std::memcpy(b.v, v, sizeof b.v);
			moves = moves || std::any_of(v, v + Space3::freedoms, [](double u) { return u != 0; });
		}
		return moves;
	};
	const bool moves = reduceRanges<bool>(&threads, world.bodies.size(), move, [](bool a, bool b) { return a || b; });
	for (const Shift& shift : shifts)
		world.bodies[shift.sphere].at = world.bodies[shift.sphere].at + shift.by;
	return moves;
}

double BodyMotion<Space3>::damped(const WorldOf<Space3>& world, const std::vector<BodyVelocity<Space3>>& bodies, Threads& threads)
{
	return reduceRanges<double>(
	    &threads, world.bodies.size(),
	    [&](std::size_t from, std::size_t to) {
		    double sum = 0;
		    for (std::size_t i = from; i < to; i++)
			    for (int k = 0; k < Space3::freedoms; k++)
				    if (const SpaceBody& b = world.bodies[i]; b.inverseMass[k] > 0)
					    sum += 0.5 * (bodies[i].v[k] - b.v[k]) * (bodies[i].v[k] - b.v[k]) / b.inverseMass[k];
		    return sum;
	    },
	    std::plus<double>());
}

void BodyMotion<Space3>::placeBack(const WorldOf<Space3>& world, double dt)
{
	placeOf.clear();
	for (const SpaceBody& b : world.bodies)
		placeOf.push_back(placeAhead(b, world.ahead(dt) - dt));
	standShapes(world, world.ahead(dt) - dt);
}

} // namespace cd
