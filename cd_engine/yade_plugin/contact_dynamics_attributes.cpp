// The attributes of the engine and its registration.
#include "contact_dynamics.hpp"

#include <algorithm>
#include <tuple>

namespace cd_engine {

const char* const ContactDynamics::documentation
    = "Contact Dynamics for disks in the plane and spheres in space: rigid bodies, unilateral contact (Signorini) and exact, non-associated Coulomb "
      "friction, "
      "solved implicitly for all contacts of a step at once; moves the bodies by the Moreau-Jean scheme. Takes the place of InteractionLoop and "
      "NewtonIntegrator; stands after ForceResetter (:py:func:`cd_engine.engines` makes the list). Finds near pairs itself, without a collider. "
      "Sphere bodies that blockedDOFs keeps in one plane, 'zXY' in x-y, 'yXZ' in x-z, 'xYZ' in y-z, are disks, and the scene is solved in that "
      "plane; "
      "if one can leave it, in space. Box (turned at will) and Wall are boundaries: fixed, "
      "moving at a prescribed velocity, or free in some directions and pushed by O.forces. Two boundaries never touch each other. Friction: the "
      "smaller frictionAngle of the two. After a step every loaded contact is a real interaction with ScGeom and FrictPhys, and O.forces holds the "
      "total on each body, gravity of free bodies included.";

template <class Visitor> void ContactDynamics::attributes(Visitor&& visit)
{
	constexpr double most = std::numeric_limits<int>::max();
#define CD_ATTRIBUTE(type, name, initial, ...) visit(#name, &ContactDynamics::name, __VA_ARGS__);
#include "attributes.inl"
#undef CD_ATTRIBUTE
}

// Whoever assigns a tolerance wants it in every step.
void ContactDynamics::assigned(const std::string& attribute)
{
	if (attribute == "tolerance")
		flowTolerance = 0;
}

// Checks loaded lists that steps use unchecked. bodyOrder is not checked: it is only a hint, and is made anew if it is invalid.
void ContactDynamics::checkLoaded() const
{
	const std::size_t pairs = referenceOverlaps.size();
	bool valid = referenceIds.size() == 2 * pairs;
	for (std::size_t i = 0; valid && i < pairs; i++) {
		const int *const now = &referenceIds[2 * i], *const before = i > 0 ? now - 2 : nullptr;
		valid = 0 <= now[0] && now[0] < now[1] && (!before || std::tie(before[0], before[1]) < std::tie(now[0], now[1]))
		    && std::isfinite(referenceOverlaps[i]) && referenceOverlaps[i] > 0;
	}
	if (!valid)
		throw SceneError(
		    "ContactDynamics: the file is damaged: referenceIds must hold the ids of two bodies for each of the referenceOverlaps, the "
		    "smaller first, in ascending order, and each overlap must be a positive number. Load another one, or empty both lists in "
		    "it, which makes the overlaps present now count as such");
}

std::string ContactDynamics::wordFault(const char* attribute, const std::string& value)
{
	const std::vector<std::string> known = std::string(attribute) == "method" ? cd::solverNames() : std::vector<std::string> { "due", "always" };
	if (std::find(known.begin(), known.end(), value) != known.end())
		return "";
	std::string words;
	for (const std::string& word : known)
		words += (words.empty() ? "'" : ", '") + word + "'";
	return "='" + value + "' is not known; there is " + words;
}

template class RegisteredEngine<ContactDynamics>;

} // namespace cd_engine

CD_ENGINE_REGISTER(ContactDynamics)
