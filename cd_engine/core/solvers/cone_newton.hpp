// Proximal-point Newton without sweeps, from the impulses in the system: a turn of the methods that make both in turn.
#pragma once

#include "solvers/solver.hpp"

namespace cd {

SolverReport newtonAlone(ConeSystem&, const SolverSettings&);

} // namespace cd
