#include "lost.hpp"

#include <algorithm>
#include <cmath>

namespace cd {

int leftBehind(const World& world, const std::vector<std::size_t>& some)
{
	if (some.empty())
		return -1;
	double low[2] = { endless, endless }, high[2] = { -endless, -endless };
	for (std::size_t i = 0; i < world.bodies.size(); i++) {
		const Half half = halfSides(world.bodies[i], world.shapes[i]);
		if (std::isinf(half.x) || std::isinf(half.y) || std::find(some.begin(), some.end(), i) != some.end())
			continue;
		const double place[2] = { world.bodies[i].x, world.bodies[i].y }, side[2] = { half.x, half.y };
		for (const int k : { 0, 1 }) {
			low[k] = std::min(low[k], place[k] - side[k]);
			high[k] = std::max(high[k], place[k] + side[k]);
		}
	}
	constexpr double far = 50; // of its radii; what is less far may be part of a small scene
	const double spread = std::hypot(high[0] - low[0], high[1] - low[1]);
	for (const std::size_t id : some) {
		const Body& b = world.bodies[id];
		const double dx = b.x - std::clamp(b.x, low[0], std::max(low[0], high[0])),
			     dy = b.y - std::clamp(b.y, low[1], std::max(low[1], high[1]));
		if (std::hypot(dx, dy) > std::max(spread, far * b.radius) && dx * b.v[0] + dy * b.v[1] > 0 && dx * b.force[0] + dy * b.force[1] >= 0)
			return static_cast<int>(id);
	}
	return -1;
}

} // namespace cd
