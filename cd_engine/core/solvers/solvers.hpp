// The methods that solve a contact problem, each in a file of its own, and what they share.
#pragma once

#include "solvers/solver.hpp"
