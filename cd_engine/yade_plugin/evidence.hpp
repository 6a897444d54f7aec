// What the running process itself tells about its binary interface, and the refusal of a YADE that does not fit.
#pragma once

#include <string>

namespace cd_engine {

// Raises the ImportError of every refusal, which says what was checked, expected and found, and what to do.
[[noreturn]] void refuse(const std::string& what, const std::string& expected, const std::string& found);

// Reads up to 4096 bytes of this process that may not exist: returns false instead of crashing.
bool readMemory(const void* from, void* to, std::size_t bytes);
template <class T> bool readMemory(const void* from, T& to) { return readMemory(from, &to, sizeof(T)); }

// Offset in bytes of a class member, read from YADE's Boost.Python registration. It must be published by pointer-to-member with this C++ type.
long publishedOffset(const std::string& className, const std::string& member, const std::string& type);

// Boost.Python and Boost.Serialization keep what is registered with them inside the library. A plug-in linked to another version than YADE would
// register its engines where YADE never looks. Refuses a process that has not loaded exactly one version of each.
void mustBeLoadedOnce();

} // namespace cd_engine
