// Whether velocities exist that keep every contact from closing.
//
// If none exist, the problem has no solution (feasibility.cpp has the proof). Friction has no part in it, since it opens no contact.
#pragma once

#include "problem/problem.hpp"
#include "base/base.hpp"

#include <vector>

namespace cd {

// Whether a blocked freedom of a body moves.
template <class Space> bool isDriven(const BodyVelocity<Space>& b)
{
	bool driven = false;
	for (int k = 0; k < Space::freedoms; k++)
		driven = driven || (!(b.w[k] > 0) && b.v[k] != 0);
	return driven;
}
// Whether no blocked freedom moves and no bias is negative: then zero velocities close no contact. Costs a look at every body and contact.
template <class Space> bool surelySolvable(const ContactSystem<Space>&, Threads* = nullptr);
// How fast boundaries and biases close contacts [m/s]: the fastest closing if all other bodies rest, or move along with the boundaries as one rigid
// body, whichever is less. It is 0 for belts, drums and shaken boxes. freeVelocity: as in residual.hpp. Costs a few passes over the contacts.
template <class Space> double closingOfBoundaries(const ContactSystem<Space>&, const std::vector<double>& freeVelocity);

struct Feasibility {
	bool possible = false; // velocities were found at which no contact closes faster than `least`
	int32_t contact = -1; // if it is proven that there are none: the contact that closes most
};

// Searches for such velocities, from those of the impulses in the system, with at most `products` products with J and its transpose. For a matrix
// problem, velocities are W p + q for all p, whatever their signs.
template <class Space> Feasibility feasibility(const ContactSystem<Space>&, const std::vector<double>& freeVelocity, double least, int products);
Feasibility feasibility(const DelassusSystem&, double least, int products);
Feasibility feasibility(const ConeSystem&, double least, int products);

} // namespace cd
