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

// All parts in a row, numbers as C++ prints them by default.
template <class... Parts> std::string text(const Parts&... parts)
{
	std::ostringstream s;
	(s << ... << parts);
	return s.str();
}

// In the remedy a # in square brackets stands for the id: "O.bodies[#]".
[[noreturn]] inline void refuseBody(int id, const std::string& what, std::string remedy)
{
	for (std::size_t at; (at = remedy.find("[#]")) != std::string::npos;)
		remedy.replace(at + 1, 1, std::to_string(id));
	throw SceneError(text("ContactDynamics: body #", id, " ", what, ". ", remedy));
}

inline const char* const releaseClump = "Clumps are not supported: append its disks one by one (O.bodies.append instead of appendClumped)";

} // namespace cd_engine
