// Threads that share work, memory that is kept from step to step, random orders, and the number of contacts that are solved at once.
#pragma once

#include "base/lanes.hpp"
#include "base/random_order.hpp"
#include "base/range.hpp"
#include "base/threads.hpp"
#include "base/workspace.hpp"
