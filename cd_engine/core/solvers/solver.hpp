// The input and output of a contact solver, and the list of solvers. To add one, write its file and add its line to solver.cpp.
#pragma once

#include "problem/problem.hpp"
#include "error/error.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace cd {

class Start;
class Threads;

// The evaluations of the error while a problem is solved, in their order, by whatever methods and from whatever starts.
struct Trace {
	struct Evaluation {
		int iterations; // made until then, of all methods
		double error; // compared with the tolerance
	};
	std::vector<Evaluation> evaluations;
	int made = 0; // iterations so far
	bool records = true;
	void (*interrupt)() = nullptr; // called at each evaluation; what it throws ends the solution

	void add(int iterations) { made += iterations; }
	void evaluated(double error)
	{
		if (records)
			evaluations.push_back({ made, error });
		if (interrupt)
			interrupt();
	}
};

struct SolverSettings {
	double tolerance = 1e-6; // on the errors of residual.hpp
	int maxIterations = 10000; // sweeps and factorizations
	int fixedIterations = 0; // > 0: exactly so many plain Gauss-Seidel sweeps, without an evaluation of the error in between
	unsigned seed = 0; // > 0: every sweep in a new random order drawn from this seed; 0: one fixed order
	double mostWork = std::numeric_limits<double>::infinity(); // floating-point operations after which Newton's method ends
	const Start* start = nullptr; // the system's initial state, if the caller keeps a copy (start.hpp)
	Threads* threads = nullptr; // share the work of a problem given by its bodies; the bits do not depend on them
	Trace* trace = nullptr; // records the error on the way, or ends the solution, if somebody asks for it
};

// no_solution: proven (feasibility.hpp); indefinite: not solved, and p . W p < 0, which is impossible in mechanics.
enum class Status { converged, fixed_iterations, max_iterations, stagnated, diverged, no_solution, indefinite };
const char* name(Status);

struct SolverReport {
	int iterations = 0; // sweeps and factorizations made
	int factorizations = 0; // how many of these are factorizations; if any, Newton's method ended the search
	double residual = 0; // e of the impulses returned
	double residualMax = 0; // its maximum over the contacts
	double bodyError = 0; // the error of the bodies (residual.hpp)
	int body = -1; // the body whose velocity may be the most wrong, in the island with the largest error of the bodies; -1: none
	double error = 0; // the largest of e, e weighted by W_nn, and the error of the bodies; compared with the tolerance
	double work = 0; // sum of W_nn |p|^2 over the contacts that are awake [J]
	bool plain = false; // plain Gauss-Seidel sweeps ended the search, although the method has better ones
	Status status = Status::converged;
	// Row of the contact where, at the tolerance asked for, the velocities are not resolved, or are none. If the status is converged, smaller
	// tolerances have resolved them; the impulses are so large that they would spoil the next solution as its first guess. -1: none.
	int32_t contact = -1;

	void measure(const Residual& e)
	{
		residual = e.norm;
		residualMax = e.maximum;
		bodyError = e.bodies;
		body = e.body;
		work = e.work;
		error = std::isfinite(e.impulse) ? e.error() : std::numeric_limits<double>::quiet_NaN();
	}
};

// Improves the impulses in `system.contacts` and leaves the velocities of these impulses in `system.bodies`.
template <class Space> using Solver = SolverReport (*)(ContactSystem<Space>&, const SolverSettings&);
// The same method for a problem given by its matrix; improves the impulses in `system.p`.
using DelassusSolver = SolverReport (*)(DelassusSystem&, const SolverSettings&);
using ConeSolver = SolverReport (*)(ConeSystem&, const SolverSettings&); // in space

// Which method brought a problem given to `method` to its tolerance; "none" if none did.
std::string solvedBy(const std::string& method, const SolverReport&);

// Null if there is no such method. What they return as converged resolves the velocities, too (resolution.hpp): if the error alone is within the
// tolerance, they go on to smaller ones. Under fixedIterations nothing of this is done.
// In space and with moments there is no newton for bodies (null), and auto is accelerated.
template <class Space = Plane> Solver<Space> findSolver(const std::string& method);
template <> Solver<Plane> findSolver(const std::string& method);
template <> Solver<RollingPlane> findSolver(const std::string& method);
template <> Solver<Space3> findSolver(const std::string& method);
DelassusSolver findDelassusSolver(const std::string& method);
ConeSolver findConeSolver(const std::string& method);
std::vector<std::string> solverNames();

template <class Space> SolverReport nsgs(ContactSystem<Space>&, const SolverSettings&);
SolverReport nsgs(DelassusSystem&, const SolverSettings&);
SolverReport nsgs(ConeSystem&, const SolverSettings&);
template <class Space> SolverReport accelerated(ContactSystem<Space>&, const SolverSettings&);
SolverReport accelerated(DelassusSystem&, const SolverSettings&);
SolverReport accelerated(ConeSystem&, const SolverSettings&);
SolverReport newton(ContactSystem<Plane>&, const SolverSettings&);
SolverReport newton(DelassusSystem&, const SolverSettings&);
SolverReport newton(ConeSystem&, const SolverSettings&);
SolverReport automatic(ContactSystem<Plane>&, const SolverSettings&);
SolverReport automatic(DelassusSystem&, const SolverSettings&);
SolverReport automatic(ConeSystem&, const SolverSettings&);

} // namespace cd
