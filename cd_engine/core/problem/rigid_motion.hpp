// The rigid motion that fits best to the boundaries of a problem: that of a drum which turns, of a box which is shaken. A problem of contacts is the
// same for an observer who moves along, because a rigid motion changes no relative velocity.
#pragma once

#include "problem/contact_system.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace cd {

class RigidMotion {
    public:
	// Fits the velocities of the bodies that cannot be moved and that contacts touch. freeVelocity: three numbers a body. Marks these bodies in
	// `touched`.
	RigidMotion(const ContactSystem& system, const std::vector<double>& freeVelocity, std::vector<char>& touched)
	{
		if (system.places.empty())
			return;
		const auto place = [&](std::size_t i) { return Vector { system.places[i][0], system.places[i][1] }; };
		const auto velocity = [&](std::size_t i) { return Vector { freeVelocity[3 * i], freeVelocity[3 * i + 1] }; };
		touched.assign(system.bodies.size(), 0);
		for (const ContactRow& c : system.contacts)
			for (const int32_t i : { c.a, c.b }) {
				const double* const w = system.bodies[i].w;
				if (!(c.wnn > 0) || w[0] != 0 || w[1] != 0 || touched[i])
					continue;
				touched[i] = 1;
				boundaries++;
				centre = centre + place(i);
				velocityThere = velocityThere + velocity(i);
				spin += freeVelocity[3 * i + 2];
			}
		if (boundaries == 0)
			return;
		centre = (1. / boundaries) * centre;
		velocityThere = (1. / boundaries) * velocityThere;
		double turn = 0, spread = 0;
		for (std::size_t i = 0; i < touched.size(); i++)
			if (touched[i]) {
				const Vector arm = place(i) - centre;
				turn += cross(arm, velocity(i) - velocityThere);
				spread += dot(arm, arm);
			}
		spin = spread > 0 ? turn / spread : spin / boundaries;
		double fastest = dot(velocityThere, velocityThere), turning = spin * spin; // squares
		for (std::size_t i = 0; i < touched.size(); i++)
			if (touched[i]) {
				fastest = std::max(fastest, dot(velocity(i), velocity(i)));
				turning = std::max(turning, freeVelocity[3 * i + 2] * freeVelocity[3 * i + 2]);
			}
		if (spread > 0 && spin * spin * spread <= roundOff * boundaries * fastest)
			spin = 0;
		together = fastest > 0 || turning > 0;
		for (std::size_t i = 0; i < touched.size(); i++)
			if (touched[i]) {
				const auto [x, y, omega] = of(system.places[i]);
				const Vector v = velocity(i), miss = v - Vector { x, y };
				const double turns = freeVelocity[3 * i + 2], otherwise = turns - omega;
				together = together && dot(miss, miss) <= nearly * dot(v, v) + roundOff * fastest
				    && otherwise * otherwise <= nearly * turns * turns + roundOff * turning;
			}
	}

	bool any() const { return boundaries > 0; }
	// Whether each of the boundaries moves so, but for a tenth of its own velocity. A sum over all would let a few that press pass beside many
	// others.
	bool ofAll() const { return together; }
	// The velocity of a body that moves along, and its angular velocity.
	std::array<double, 3> of(const std::array<double, 2>& place) const
	{
		const Vector arm = Vector { place[0], place[1] } - centre;
		return { velocityThere.x - spin * arm.y, velocityThere.y + spin * arm.x, spin };
	}

    private:
	int boundaries = 0;
	Vector centre { 0, 0 }, velocityThere { 0, 0 };
	double spin = 0; // [rad/s]
	static constexpr double nearly = 0.01, roundOff = 1e-18; // shares of squares
	bool together = false;
};

} // namespace cd
