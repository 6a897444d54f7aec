#include "alone.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace cd {
namespace {

	constexpr std::size_t most = 8;
	constexpr double endless = std::numeric_limits<double>::infinity();

	// The way along x or y, with the velocity before the step or with that which the external forces alone make, whichever is longer [m].
	double wayAlong(int axis, const Body& b, double dt)
	{
		return dt * std::max(std::abs(b.v[axis]), std::abs(b.v[axis] + dt * b.inverseMass[axis] * b.force[axis]));
	}

	// Whether all other bodies are further away, along x or along y, than four ways of both and a diameter: cd::reach asks for four ways, too.
	bool isAlone(const World& world, std::size_t lone, double dt, const std::vector<int>& others, double fastest)
	{
		const Body& a = world.bodies[lone];
		const double own[2] = { wayAlong(0, a, dt), wayAlong(1, a, dt) };
		for (std::size_t i = 0; i < world.bodies.size(); i++) {
			const Body& b = world.bodies[i];
			const Half half = halfSides(b, world.shapes[i]);
			const double apart[2] = { std::abs(a.x - b.x) - half.x, std::abs(a.y - b.y) - half.y };
			const bool other = std::find(others.begin(), others.end(), static_cast<int>(i)) != others.end();
			const auto far = [&](int axis) {
				const double way = other ? std::max(wayAlong(axis, b, dt), fastest) : fastest;
				return apart[axis] > 4 * own[axis] + 4 * way + 2 * a.radius;
			};
			if (i != lone && !far(0) && !far(1))
				return false;
		}
		return true;
	}

} // namespace

Half halfSides(const Body& body, const Shape& shape)
{
	if (body.radius > 0)
		return { body.radius, body.radius };
	if (shape.kind == ShapeKind::wall)
		return { shape.axis == 0 ? 0 : endless, shape.axis == 1 ? 0 : endless };
	const double c = std::abs(shape.cosine), s = std::abs(shape.sine);
	return { c * shape.ex + s * shape.ey, s * shape.ex + c * shape.ey };
}

const std::vector<int>& FastAndAlone::find(const World& world, double dt, double slow)
{
	fast.clear();
	fast.reserve(world.bodies.size());
	double fastest = 0; // of the bodies that are not alone
	for (std::size_t i = 0; i < world.bodies.size(); i++) {
		const double way = wayOf(world.bodies[i], world.shapes[i], dt);
		if (way > slow && world.bodies[i].radius > 0)
			fast.emplace_back(way, static_cast<int>(i));
		else
			fastest = std::max(fastest, way);
	}
	std::sort(fast.begin(), fast.end(), std::greater<>());
	if (fast.size() > most)
		fastest = std::max(fastest, fast[most].first);
	alone.clear();
	for (std::size_t k = 0; k < std::min(most, fast.size()); k++)
		alone.push_back(fast[k].second);
	// Those that are not are among the others then, and the rest has to be alone beside them.
	for (std::size_t before = 0; before != alone.size();) {
		before = alone.size();
		tried.swap(alone);
		alone.clear();
		double next = fastest;
		for (const int id : tried)
			if (isAlone(world, id, dt, tried, fastest))
				alone.push_back(id);
			else
				next = std::max(next, wayOf(world.bodies[id], world.shapes[id], dt));
		fastest = next;
	}
	return alone;
}

int leftBehind(const World& world, const std::vector<int>& alone)
{
	double low[2] = { endless, endless }, high[2] = { -endless, -endless };
	for (std::size_t i = 0; i < world.bodies.size(); i++) {
		const Half half = halfSides(world.bodies[i], world.shapes[i]);
		if (world.bodies[i].alone || std::isinf(half.x) || std::isinf(half.y))
			continue;
		const double place[2] = { world.bodies[i].x, world.bodies[i].y }, side[2] = { half.x, half.y };
		for (const int k : { 0, 1 }) {
			low[k] = std::min(low[k], place[k] - side[k]);
			high[k] = std::max(high[k], place[k] + side[k]);
		}
	}
	const double spread = std::hypot(high[0] - low[0], high[1] - low[1]);
	for (const int id : alone) {
		const Body& b = world.bodies[id];
		const double dx = b.x - std::clamp(b.x, low[0], std::max(low[0], high[0])),
			     dy = b.y - std::clamp(b.y, low[1], std::max(low[1], high[1]));
		if (std::hypot(dx, dy) > spread && dx * b.v[0] + dy * b.v[1] > 0 && dx * b.force[0] + dy * b.force[1] >= 0)
			return id;
	}
	return -1;
}

} // namespace cd
