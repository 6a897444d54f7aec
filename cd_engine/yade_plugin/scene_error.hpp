// The only exception by which an engine refuses a scene. It ends the run and reaches the user.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace cd_engine {

// The scene asks for something that the engine cannot do, or a quantity is not a number. The text names the body and the remedy.
class SceneError : public std::runtime_error {
	using std::runtime_error::runtime_error;
};

inline std::string ofBody(int id) { return "O.bodies[" + std::to_string(id) + "]"; }

[[noreturn]] inline void refuseBody(int id, const std::string& what, const std::string& remedy)
{
	throw SceneError("ContactDynamics: body #" + std::to_string(id) + " " + what + ". " + remedy);
}

inline const char* const releaseClump = "Release the clump (O.bodies.releaseClump) or use single disks";

// A number as C++ prints it by default.
inline std::string text(double x)
{
	std::ostringstream s;
	s << x;
	return s.str();
}

} // namespace cd_engine
