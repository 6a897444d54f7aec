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

// `words` with the id in place of each # in square brackets: "O.bodies[#]".
inline std::string ofBody(int id, std::string words)
{
	for (std::size_t at; (at = words.find("[#]")) != std::string::npos;)
		words.replace(at + 1, 1, std::to_string(id));
	return words;
}

[[noreturn]] inline void refuseBody(int id, const std::string& what, const std::string& remedy)
{
	throw SceneError(text("ContactDynamics: body #", id, " ", what, ". ", ofBody(id, remedy)));
}

inline const char* const releaseClump = "Release the clump (O.bodies.releaseClump) or use single disks";

} // namespace cd_engine
