// Whether the plug-in and YADE share the libraries through which they meet.
#pragma once

namespace cd_engine {

// Boost.Python and Boost.Serialization keep what is registered with them in the library itself: a plug-in linked to another version of them than
// YADE would register its engines where YADE never looks. Throws LayoutError if the process holds two of either.
void mustBeLoadedOnce();

} // namespace cd_engine
