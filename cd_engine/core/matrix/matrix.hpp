// Gauss-Seidel sweeps over a problem given by its matrix.
#pragma once

#include "matrix/cone_sweep.hpp"
#include "matrix/delassus_sweep.hpp"
