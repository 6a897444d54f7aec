// Whether impulses are a solution, and whether a problem has any.
#pragma once

#include "solvability/verdict.hpp"
