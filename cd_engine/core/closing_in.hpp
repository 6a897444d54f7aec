// Tests whether boundaries close in on bodies, so that no velocities at all keep every contact from overlapping further.
//
// A problem is solvable along the normals if velocities v of the movable bodies exist with  J v + b >= 0.  J v are normal relative velocities, b
// those that the boundaries and the biases prescribe. Friction does not help, as it cannot open a contact. The least total closing velocity,
//   min over v of |min(J v + b, 0)|^2,
// is 0 if and only if such velocities exist. If it is not 0, y = -min(J v + b, 0) at the minimum is the proof (Farkas' lemma): y >= 0, J^T y = 0 and
// b . y = -|y|^2 < 0. The proof does not use the impulses. It serves where impulses that balance each other for other reasons hide a press.
#pragma once

#include "contact_system.hpp"

#include <vector>

namespace cd {

// Returns the row of the contact that must close most, if mostProducts products with J and J^T suffice to prove that there is no solution; else -1.
// freeVelocity: as in residual.hpp. The search begins at the velocities in system.bodies or at the rigid motion nearest to that of the boundaries. If
// contacts close there by less than three tolerances of the free and prescribed closing, it ends at once. Velocities beyond `bound` times the
// prescribed ones, both weighted by the masses, do not count as a solution. Memory is kept from one problem of a thread to the next.
int closingIn(const ContactSystem& system, const std::vector<double>& freeVelocity, double tolerance, double bound, int mostProducts);

} // namespace cd
