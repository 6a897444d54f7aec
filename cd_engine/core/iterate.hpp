// The loop around sweeps that every sweeping method shares: when to ask for the error, when to stop, what to report.
#pragma once

#include "solver.hpp"
#include "sweep.hpp"

#include <functional>

namespace cd {

// `method(sweep)` gives a function that makes one sweep; after each call the packed impulses are the iterate.
// Stops when the error e, and the same weighted by W_nn, are at most settings.tolerance, at settings.maxIterations sweeps, or when nothing is gained
// any more; With settings.fixedIterations it makes exactly so many plain sweeps, whatever the method, and asks for the error at the end: what is
// known of under-converged contact dynamics (Unger & Kertesz 2003) holds for plain Gauss-Seidel.
SolverReport iterate(ContactSystem&, const SolverSettings&, const std::function<std::function<void()>(Sweep&)>& method);

} // namespace cd
