// Reads memory of this process that may not exist: returns false instead of crashing.
#pragma once

#include <cstddef>

namespace cd_engine {

bool readMemory(const void* from, void* to, std::size_t bytes);

template <class T> bool readMemory(const void* from, T& to) { return readMemory(from, &to, sizeof(T)); }

} // namespace cd_engine
