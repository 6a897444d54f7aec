// Gauss-Seidel sweeps over a problem given by its bodies.
#pragma once

#include "sweeps/sweep.hpp"
