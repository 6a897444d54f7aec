// Whether impulses within the tolerance resolve the velocities.
//
// The error e is relative to the impulses. Two walls that close in on a body load it with impulses that grow without end while its contacts close as
// before: e falls below every tolerance, although nothing is solved. Impulses may also be large because friction wedges bodies or because a column
// is nearly straight. Beside them, velocities of many tolerances are small. So what counts are the velocities: the fastest closing of a contact,
// compared with the fastest closing that there would be without impulses. Both are the same for an observer who moves along.
#pragma once

#include "problem/problem.hpp"
#include "base/base.hpp"

#include <limits>
#include <vector>

namespace cd {

constexpr double roundOff = 16 * std::numeric_limits<double>::epsilon(); // of velocities, relative to the magnitudes of their terms

struct Resolution {
	// Largest |min(u_n, W_nn p_n)| [m/s]: the speed of a contact that closes, or that parts although it carries something (Signorini's
	// condition).
	double miss = 0;
	double free = 0; // fastest closing of a contact without impulses [m/s]
	bool yields = false; // whether loaded contacts close rather than part, as where boundaries close in on bodies
	double growth = 0; // |p| relative to the impulses that would stop each closing contact alone, both weighted by W_nn
	bool indefinite = false; // p . W p < 0, which is impossible in mechanics. Only known of a matrix problem
	int32_t contact = -1; // the one with the largest power of closing, else the one with the largest impulse
	bool finite = true; // else `contact` is one with NaN or infinity
};

// Of the impulses in the system. Costs a pass over the contacts; for a matrix, a product with W. freeVelocity: as in residual.hpp; the bodies have
// the velocities of the impulses.
template <class Space> Resolution resolution(const ContactSystem<Space>&, const std::vector<double>& freeVelocity);
Resolution resolution(const DelassusSystem&);
Resolution resolution(const ConeSystem&);

// With a larger growth, round-off makes velocities wrong by a ten-thousandth of those that the impulses must stop. A mass ratio of 1 : 1e8 makes 1e8.
constexpr double mostGrowth = 1e11;

// The kinetic energy after the impulses over that before them; infinite if there was none. Where no boundary moves a body, more than 1 is wrong.
template <class Space> double energyGain(const ContactSystem<Space>&, const std::vector<double>& freeVelocity);

} // namespace cd
