// A random heap that several tests sweep.
#pragma once

#include "contact_system.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace tests {
using namespace cd;

// Disks of spread masses on a floor, each in contact with some before it; a loaded wall with one freedom, and where `general` bodies
// whose contacts couple the two directions. Body 0 is immobile, body 1 the wall.
inline ContactSystem heap(unsigned seed, int contacts, double mu, bool general)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(0, 1);
	ContactSystem s;
	const int bodies = 3 + contacts / 2;
	s.bodies.resize(bodies);
	s.bodies[1].w[0] = 0.3;
	s.bodies[1].v[0] = 0.2;
	std::vector<double> radius(bodies);
	for (int i = 2; i < bodies; i++) {
		BodyVelocity& b = s.bodies[i];
		radius[i] = 0.3 + unit(random);
		const double mass = 3 * radius[i] * radius[i];
		b.w[0] = b.w[1] = 1 / mass;
		b.w[2] = 2 / (mass * radius[i] * radius[i]);
		b.v[0] = unit(random) - 0.5;
		b.v[1] = -unit(random);
	}
	for (int k = 0; k < contacts; k++) {
		ContactRow c;
		c.b = 2 + k % (bodies - 2);
		c.a = std::max(0, c.b - 1 - static_cast<int>(6 * unit(random)));
		const double angle = c.a == 1 ? 0 : 1.57 + 2 * (unit(random) - 0.5);
		c.nx = c.a == 1 ? 1 : std::cos(angle);
		c.ny = c.a == 1 ? 0 : std::sin(angle);
		c.at = radius[c.a];
		c.bt = -radius[c.b];
		if (general && k % 5 == 0)
			c.bn = 0.3 * unit(random);
		c.mu = mu;
		c.bias = 0.1 * unit(random);
		s.contacts.push_back(c);
	}
	s.assembleBlocks();
	return s;
}

} // namespace tests
