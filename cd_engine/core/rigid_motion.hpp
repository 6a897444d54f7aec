// The rigid motion in which the boundaries of a problem take part, such as a turning drum or a shaken box.
#pragma once

#include "contact_system.hpp"

#include <vector>

namespace cd {

// Sets `motion`, three velocities a body, to the rigid motion that best fits the boundaries in contact; blocked freedoms keep their velocities.
// freeVelocity: as in residual.hpp. Returns false where no boundary is in contact or the places of the bodies are not known.
bool rigidMotion(const ContactSystem& system, const std::vector<double>& freeVelocity, std::vector<double>& motion);

} // namespace cd
