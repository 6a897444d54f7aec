// Whether boundaries close in on bodies so that no velocities at all keep every contact open or closed.
//
// Solvable along the normals means that velocities v of what can move exist with  J v + b >= 0:  J v the normal relative velocities, b those that
// the boundaries and the biases prescribe. Friction does not help, as it cannot open a contact. The least that contacts have to close by,
//   min over v of |min(J v + b, 0)|^2,
// is 0 if and only if such velocities exist. Where it is not, y = -min(J v + b, 0) at the minimum is the proof (Farkas' lemma): y >= 0, J^T y = 0
// and b . y = -|y|^2 < 0. It says nothing of the impulses, and serves where these hold each other for other reasons and hide what presses.
#pragma once

#include "contact_system.hpp"

#include <vector>

namespace cd {

// The row of the contact that has to close most if it is proven within mostProducts products with J and J^T that there is no solution; else -1.
// freeVelocity: as in residual.hpp. The search begins at the velocities in system.bodies, or at the one rigid motion that all boundaries share; where
// these close by less than this tolerance of what is prescribed, it ends at once. A solution whose velocities would be beyond `bound` times the
// prescribed ones, both weighted by the masses, is none. Memory is kept from one problem of a thread to the next.
int closingIn(const ContactSystem& system, const std::vector<double>& freeVelocity, double tolerance, double bound, int mostProducts);

} // namespace cd
