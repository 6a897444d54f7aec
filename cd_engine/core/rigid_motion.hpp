// The rigid motion in which the boundaries of a problem take part, such as a turning drum or a shaken box.
#pragma once

#include "contact_system.hpp"

#include <vector>

namespace cd {

// Sets `motion`, three velocities a body, to the rigid motion that best fits the boundaries in contact; blocked freedoms keep their velocities.
// freeVelocity: as in residual.hpp. Returns false where no boundary is in contact or the places of the bodies are not known.
bool rigidMotion(const ContactSystem& system, const std::vector<double>& freeVelocity, std::vector<double>& motion);

// Whether all bodies could move with the boundaries: in their rigid motion u_n >= mu |u_t| at every contact, to within `tolerance` of the closing of
// the free velocities. Where such velocities exist the problem has a solution (Acary et al. 2011, Z. Angew. Math. Mech. 91, 155, section 3), so
// nothing is pressed. They are zero in the frame of a drum that turns.
bool movesAsOne(const ContactSystem& system, const std::vector<double>& freeVelocity, double tolerance);

} // namespace cd
