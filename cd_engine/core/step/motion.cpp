#include "step/motion.hpp"
#include "search/search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <functional>

namespace cd {
namespace {

	// How fast external forces make a body in dt, and turn it.
	inline void setPush(const Body& b, double dt, BodyVelocity<Plane>& s)
	{
		const double ax = b.inverseMass[0] * b.force[0], ay = b.inverseMass[1] * b.force[1];
		s.pushed = dt * std::sqrt(ax * ax + ay * ay);
		s.twisted = dt * b.inverseMass[2] * std::abs(b.force[2]);
	}
	inline void setPush(const SpaceBody& b, double dt, BodyVelocity<Space3>& s)
	{
		Vector3 gained[2];
		for (int k = 0; k < Space3::freedoms; k++)
			gained[k / 3][k % 3] = dt * b.inverseMass[k] * b.force[k];
		s.pushed = length(gained[0]);
		s.twisted = length(gained[1]);
	}

	// belt: its surface moves.
	template <class Body, class Velocity> inline void setFree(const Body& b, double dt, bool belt, Velocity& s)
	{
		constexpr int freedoms = sizeof b.v / sizeof *b.v;
		for (int k = 0; k < freedoms; k++) {
			s.w[k] = b.inverseMass[k];
			s.v[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
		}
		setPush(b, dt, s);
		if (belt)
			s.v[freedoms - 1] = 1;
	}

	inline void moveBy(Place& p, const Vector& by)
	{
		p.x += by.x;
		p.y += by.y;
	}
	inline void moveBy(Body& b, const Vector& by)
	{
		b.x += by.x;
		b.y += by.y;
	}
	inline void moveBy(SpacePlace& p, const Vector3& by) { p.at = p.at + by; }
	inline void moveBy(SpaceBody& b, const Vector3& by) { b.at = b.at + by; }

	// way(k): how far freedom k moves.
	template <class Way> inline void move(Body& b, const Way& way)
	{
		moveBy(b, { way(0), way(1) });
		b.turn = way(2);
	}
	template <class Way> inline void move(SpaceBody& b, const Way& way)
	{
		moveBy(b, { way(0), way(1), way(2) });
		b.turn = { way(3), way(4), way(5) };
	}

	inline std::array<double, 2> arrayOf(const Place& p) { return { p.x, p.y }; }
	inline std::array<double, 3> arrayOf(const SpacePlace& p) { return { p.at.x, p.at.y, p.at.z }; }

} // namespace

void StandingShapes<Space3>::stand(const WorldOf<Space3>& world, double ahead, bool any, const uint8_t* still)
{
	shapeOf = any ? &turned : &world.shapes;
	filled = filled && still;
	if (!any)
		return;
	turned.resize(world.shapes.size());
	for (std::size_t i = 0; i < world.bodies.size(); i++)
		if (filled && still[i])
			continue;
		else if (const SpaceBody& b = world.bodies[i]; isBoundary(b))
			turned[i] = turns(b) ? rotated(world.shapes[i], ahead * spinOf(b)) : world.shapes[i];
	filled = true;
}

template <class Space>
typename BodyMotion<Space>::Start BodyMotion<Space>::begin(const World& world, double dt, ContactSystem<Space>& system, Threads& threads)
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
	const bool belts = !world.surfaces.empty();
	const uint8_t* const still = world.stillSince(seen);
	system.still = world.reading != 0 ? &world.still : nullptr;
	const auto begin = [&](std::size_t from, std::size_t to) {
		Start start { false, known, false };
		for (std::size_t i = from; i < to; i++) {
			if (still && still[i])
				continue;
			const BodyOf<Space>& b = world.bodies[i];
			start.sameMasses = start.sameMasses && std::equal(b.inverseMass, b.inverseMass + Space::freedoms, system.bodies[i].w);
			const bool belt = belts && world.isBelt(i);
			setFree(b, dt, belt, system.bodies[i]);
			placeOf[i] = placeAhead(b, ahead);
			system.places[i] = arrayOf(placeOf[i]);
			way[i] = belt ? 0 : wayOf(b, world.shapes[i], system.bodies[i].v, dt);
			start.turns = start.turns || (isBoundary(b) && turns(b));
			start.guides = start.guides || (!isBoundary(b) && isGuided(b));
		}
		return start;
	};
	const Start all = reduceRanges<Start>(&threads, count, begin, [](const Start& a, const Start& b) {
		return Start { a.turns || b.turns, a.sameMasses && b.sameMasses, a.guides || b.guides };
	});
	this->stand(world, ahead, all.turns, still);
	return all;
}

template <class Space> void BodyMotion<Space>::resetFree(const World& world, double dt, ContactSystem<Space>& system, Threads& threads)
{
	const bool belts = !world.surfaces.empty();
	forRanges(&threads, world.bodies.size(), [&](std::size_t from, std::size_t to) {
		for (std::size_t i = from; i < to; i++)
			if (!system.isStill(i))
				setFree(world.bodies[i], dt, belts && world.isBelt(i), system.bodies[i]);
	});
}

template <class Space> inline double BodyMotion<Space>::reach(const World& world, std::size_t i, double dt) const
{
	return contact_limits::quick * dt * (meanOf[i].speed + 0.5 * outlineSpeed(world.bodies[i].v, world.bodies[i], world.shapes[i]));
}

template <class Space> std::vector<double> BodyMotion<Space>::reaches(const World& world, double dt) const
{
	std::vector<double> all(meanOf.size());
	for (std::size_t i = 0; i < all.size(); i++)
		all[i] = reach(world, i, dt);
	return all;
}

template <class Space> bool BodyMotion<Space>::average(const World& world, double dt, const Velocities& bodies, bool solved, Threads& threads)
{
	assert(bodies.size() >= world.bodies.size() && way.size() == world.bodies.size());
	meanOf.resize(way.size());
	const bool implicit = world.compliant(), belts = !world.surfaces.empty();
	const uint8_t* const still = world.stillSince(seen);
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
			if (still && still[i])
				continue;
			const BodyOf<Space>& b = world.bodies[i];
			const double* v = bodies[i].v;
			const bool belt = belts && world.isBelt(i);
			for (int k = 0; k < Space::freedoms; k++)
				meanOf[i].v[k] = implicit || belt ? v[k] : 0.5 * (b.v[k] + v[k]);
			meanOf[i].speed = belt ? 0 : std::min(outlineSpeed(v, b, world.shapes[i]), most);
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

template <class Space> void BodyMotion<Space>::shift(int32_t body, const VectorOf<Space>& by)
{
	shifts.push_back({ body, by });
	moveBy(placeOf[body], by);
}

template <class Space> bool BodyMotion<Space>::finish(World& world, double h, const Velocities& bodies, Threads& threads)
{
	const bool implicit = world.compliant(), belts = !world.surfaces.empty();
	const uint8_t* const still = world.stillSince(seen);
	const auto finish = [&](std::size_t from, std::size_t to) {
		bool moves = false;
		for (std::size_t i = from; i < to; i++) {
			if (still && still[i])
				continue;
			BodyOf<Space>& b = world.bodies[i];
			const double* v = bodies[i].v;
			if (belts && world.isBelt(i)) {
				b.turn = {};
				continue;
			}
			if (implicit)
				move(b, [&](int k) { return h * v[k]; });
			else
				move(b, [&](int k) { return 0.5 * h * (b.v[k] + v[k]); });
			std::memcpy(b.v, v, sizeof b.v);
			moves = moves || std::any_of(v, v + Space::freedoms, [](double u) { return u != 0; });
		}
		return moves;
	};
	const bool moves = reduceRanges<bool>(&threads, world.bodies.size(), finish, [](bool a, bool b) { return a || b; });
	for (const Shift& shift : shifts)
		moveBy(world.bodies[shift.body], shift.by);
	seen = world.reading;
	return moves;
}

template <class Space> double BodyMotion<Space>::damped(const World& world, const Velocities& bodies, Threads& threads)
{
	return reduceRanges<double>(
	    &threads, world.bodies.size(),
	    [&](std::size_t from, std::size_t to) {
		    double sum = 0;
		    for (std::size_t i = from; i < to; i++)
			    for (int k = 0; k < Space::freedoms; k++)
				    if (const BodyOf<Space>& b = world.bodies[i]; b.inverseMass[k] > 0)
					    sum += 0.5 * (bodies[i].v[k] - b.v[k]) * (bodies[i].v[k] - b.v[k]) / b.inverseMass[k];
		    return sum;
	    },
	    std::plus<double>());
}

template <class Space> void BodyMotion<Space>::placeBack(const World& world, double dt)
{
	const double ahead = world.ahead(dt) - dt;
	placeOf.clear();
	for (const BodyOf<Space>& b : world.bodies)
		placeOf.push_back(placeAhead(b, ahead));
	this->stand(world, ahead, true, nullptr);
}

template class BodyMotion<Plane>;
template class BodyMotion<Space3>;

} // namespace cd
