// Newton's method for a contact problem, step by step, with sparse factorization.
#pragma once

#include "newton/cone_proximal.hpp"
#include "newton/proximal_problem.hpp"
