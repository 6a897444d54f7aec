// Whether the velocities of a solution are exact enough, and whether a problem has a solution.
#pragma once

#include "solvability/feasibility.hpp"
#include "solvability/resolution.hpp"
