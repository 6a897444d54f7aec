#include "rigid_motion.hpp"
#include "vector.hpp"
#include "workspace.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
bool rigidMotion(const ContactSystem& system, const std::vector<double>& free, std::vector<double>& motion)
{
	if (system.places.empty())
		return false;
	const auto place = [&](std::size_t i) { return Vector { system.places[i][0], system.places[i][1] }; };
	const auto velocity = [&](std::size_t i) { return Vector { free[3 * i], free[3 * i + 1] }; };
	const Borrowed<std::vector<char>, BodyVelocity> marks(system.memory);
	std::vector<char>& touched = *marks;
	touched.assign(system.bodies.size(), 0);
	Vector centre { 0, 0 }, v { 0, 0 };
	double spin = 0, turn = 0, spread = 0;
	int count = 0;
	for (const ContactRow& c : system.contacts) {
		if (!(c.wnn > 0))
			continue;
		for (const int32_t i : { c.a, c.b }) {
			if (system.bodies[i].w[0] != 0 || system.bodies[i].w[1] != 0 || touched[i])
				continue;
			touched[i] = 1;
			count++;
			centre = centre + place(i);
			v = v + velocity(i);
			spin += free[3 * i + 2];
		}
	}
	if (count == 0)
		return false;
	centre = { centre.x / count, centre.y / count };
	v = { v.x / count, v.y / count };
	for (std::size_t i = 0; i < touched.size(); i++)
		if (touched[i]) {
			const Vector arm = place(i) - centre;
			turn += cross(arm, velocity(i) - v);
			spread += dot(arm, arm);
		}
	spin = spread > 0 ? turn / spread : spin / count;
	motion = free;
	for (std::size_t i = 0; i < touched.size(); i++) {
		const Vector arm = place(i) - centre;
		const double rigid[3] = { v.x - spin * arm.y, v.y + spin * arm.x, spin };
		for (int k = 0; k < 3; k++)
			if (system.bodies[i].w[k] > 0)
				motion[3 * i + k] = rigid[k];
	}
	return true;
}

} // namespace cd
