// How often the program has asked for memory.
#pragma once

#include <cstddef>

// Calls of operator new since the program started, in all threads.
std::size_t allocations();
