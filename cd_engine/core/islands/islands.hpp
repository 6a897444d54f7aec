// Solves each island of contacts for itself, and leaves islands at rest asleep.
#pragma once

#include "islands/island_solver.hpp"
#include "islands/rest.hpp"
#include "islands/sleepers.hpp"
