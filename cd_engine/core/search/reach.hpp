// How far apart two bodies may be for a step to make a contact of them, and how far the search for pairs must reach.
#pragma once

#include "scene/scene.hpp"

#include <algorithm>

namespace cd {

namespace contact_limits {
	constexpr double nearby = 1e-3; // of a disk's radius: gaps up to this are contacts, however slow the bodies are

	// A pair is a contact if its gap is at most `soon` times the relative motion of its bodies in the step plus `pushed` of the smaller radius,
	// as other contacts may change both velocities. It is none if the gap is more than `mostWays` times the sum of both ways.
	constexpr double soon = 1.2, pushed = 0.5, mostWays = 2;

	constexpr double quick = 1 + 1e-3; // factor on the speed that closes a gap, larger than round-off
} // namespace contact_limits

// The farthest from its outline that a body may meet others in a step [m]. way: the distance that it moves in the step (wayOf) [m]. A pair becomes a
// contact only if its gap is at most the sum of the reaches of both bodies: each of the two limits above is at most that, for any partner. Adds the
// half way that each body moves before contact is looked at.
template <class Body> double reachOf(const Body& b, double way)
{
	using namespace contact_limits;
	const double most = mostWays * way;
	return 0.5 * way + nearby * b.radius + (isBoundary(b) ? most : std::min(most, soon * way + pushed * b.radius));
}

} // namespace cd
