// The one kind of exception by which an engine refuses a scene; it ends the run and reaches the user.
#pragma once

#include <stdexcept>

namespace cd_engine {

// What a scene asks that the engine cannot do, or a quantity that is no number; the text names the body and the remedy.
class SceneError : public std::runtime_error {
	using std::runtime_error::runtime_error;
};

} // namespace cd_engine
