// What a contact solver takes and returns, and the list of those there are. To add one: write its file, add its line to solver.cpp.
#pragma once

#include "contact_system.hpp"
#include "delassus_system.hpp"
#include "residual.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace cd {

class Start;
class Threads;

struct SolverSettings {
	double tolerance = 1e-6; // on the errors of residual.hpp
	int maxIterations = 10000; // sweeps and factorizations
	int fixedIterations = 0; // > 0: exactly so many plain Gauss-Seidel sweeps, no test on the way
	unsigned seed = 0; // > 0: every sweep in a new random order drawn from this seed; 0: one fixed order
	double mostWork = std::numeric_limits<double>::infinity(); // floating-point operations after which Newton's method ends
	bool guessSolved = true; // whether the first guess is of a step that was solved; else its size excuses no growth (verdict.hpp)
	bool guessPressed = false; // whether it is of a step without a solution, or in doubt: what it leads to is confirmed from none
	const Start* start = nullptr; // what the system holds, if somebody keeps it already (start.hpp)
	Threads* threads = nullptr; // that share the work of a problem given by its bodies; the bits are the same with any, and without
};

// no_solution: none, or only one beyond every bound (verdict.hpp); indefinite: the same, and W gives some impulses a negative energy.
enum class Status { converged, fixed_iterations, max_iterations, stagnated, diverged, no_solution, indefinite };
const char* name(Status);
// Whether it is what the problem is, and not what has been made of it.
inline bool hasNoSolution(Status s) { return s == Status::no_solution || s == Status::indefinite || s == Status::diverged; }

struct SolverReport {
	int iterations = 0; // sweeps made, and factorizations
	int factorizations = 0; // of these; any: it was Newton's method that ended the search
	double residual = 0; // e of the impulses returned
	double residualMax = 0; // its maximum over the contacts
	double bodyError = 0; // the error of the bodies (residual.hpp)
	int body = -1; // whose velocity may be the most wrong, where the error of the bodies is the largest; -1: none
	double error = 0; // the largest of e, e weighted by W_nn, and the error of the bodies: what the tolerance is held against
	bool plain = false; // plain Gauss-Seidel sweeps ended the search of a method that has better ones
	bool doubtful
	    = false; // under fixedIterations: whether, however small the errors, the impulses are none that verdict.hpp takes for a solution
	Status status = Status::converged;
	int32_t contact = -1; // row of the contact that speaks most against the impulses, where one does: for no_solution, indefinite, diverged

	void measure(const Residual& e)
	{
		residual = e.norm;
		residualMax = e.maximum;
		bodyError = e.bodies;
		body = e.body;
		error = std::isfinite(e.impulse) ? e.error() : std::numeric_limits<double>::quiet_NaN();
	}
};

// Improves the impulses in `system.contacts` and leaves the velocities that belong to them in `system.bodies`.
using Solver = SolverReport (*)(ContactSystem&, const SolverSettings&);
// The same method for a problem given by its matrix; improves the impulses in `system.p`.
using DelassusSolver = SolverReport (*)(DelassusSystem&, const SolverSettings&);

// Which method brought a problem given to `method` to its tolerance; "none" if none did.
std::string solvedBy(const std::string& method, const SolverReport&);

// Null if there is no such method. What they return is judged: whatever the method's own error says, impulses that verdict.hpp finds to solve nothing
// do not count as converged, and what has no solution is called so. At most a tenth of maxIterations is kept for finding that out where the bodies
// do not tell beforehand.
Solver findSolver(const std::string& method);
DelassusSolver findDelassusSolver(const std::string& method);
std::vector<std::string> solverNames();

SolverReport nsgs(ContactSystem&, const SolverSettings&);
SolverReport nsgs(DelassusSystem&, const SolverSettings&);
SolverReport accelerated(ContactSystem&, const SolverSettings&);
SolverReport accelerated(DelassusSystem&, const SolverSettings&);
SolverReport newton(ContactSystem&, const SolverSettings&);
SolverReport newton(DelassusSystem&, const SolverSettings&);
SolverReport automatic(ContactSystem&, const SolverSettings&);
SolverReport automatic(DelassusSystem&, const SolverSettings&);

} // namespace cd
