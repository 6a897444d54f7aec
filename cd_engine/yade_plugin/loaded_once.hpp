// Checks that the plug-in and YADE use the same copies of their common libraries.
#pragma once

namespace cd_engine {

// Boost.Python and Boost.Serialization keep what is registered with them inside the library. A plug-in linked to another version than YADE would
// register its engines where YADE never looks. Throws LayoutError if the process has not loaded exactly one version of each.
void mustBeLoadedOnce();

} // namespace cd_engine
