// Whether velocities exist that keep every contact from closing.
//
// If none exist, the problem has no solution (feasibility.cpp has the proof). Friction has no part in it, since it opens no contact.
#pragma once

#include "problem/problem.hpp"
#include "base/base.hpp"

#include <vector>

namespace cd {

// Whether a blocked freedom of a body moves.
inline bool isDriven(const BodyVelocity<Plane>& b)
{
	return (!(b.w[0] > 0) && b.v[0] != 0) || (!(b.w[1] > 0) && b.v[1] != 0) || (!(b.w[2] > 0) && b.v[2] != 0);
}
// Whether no blocked freedom moves and no bias is negative: then zero velocities close no contact. Costs a look at every body and contact.
bool surelySolvable(const ContactSystem<Plane>&, Threads* = nullptr);
// The same if boundaries move, but no contact closes faster than `least` [m/s] when all other bodies rest, or move along with the boundaries as one
// rigid body: belts, drums, shaken boxes. freeVelocity: as in residual.hpp. Costs a few passes over the contacts. Not known of a matrix.
bool staysOpen(const ContactSystem<Plane>&, const std::vector<double>& freeVelocity, double least);

struct Feasibility {
	bool possible = false; // velocities were found at which no contact closes faster than `least`
	int32_t contact = -1; // if it is proven that there are none: the contact that closes most
};

// Searches for such velocities, from those of the impulses in the system, with at most `products` products with J and its transpose. For a matrix
// problem, velocities are W p + q for all p, whatever their signs.
Feasibility feasibility(const ContactSystem<Plane>&, const std::vector<double>& freeVelocity, double least, int products);
Feasibility feasibility(const DelassusSystem&, double least, int products);
Feasibility feasibility(const ConeSystem&, double least, int products);

} // namespace cd
