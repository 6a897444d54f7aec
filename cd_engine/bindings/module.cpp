// The Python module `cd_engine.core._core`: the solvers without YADE, for problems given by their matrix or by their bodies. Nobody but
// cd_engine/core/solve.py calls it, which has checked all that is in the arrays.
#include "python.hpp"

#include "error/error.hpp"
#include "base/base.hpp"
#include "solvability/solvability.hpp"

#include <algorithm>
#include <time.h>

namespace {

using namespace cd_engine;

// The calls of a thread follow each other and share one. So who solves a problem again, with other numbers, does not wait for it to be
// packed anew.
thread_local cd::Workspace memory;

// A problem by its matrix: W as rows of 2 x 2 blocks (start, column, blocks), q and mu.
cd::DelassusSystem matrixSystem(const py::tuple& arrays, const py::object& impulses)
{
	cd::DelassusSystem s;
	s.memory = &memory;
	s.start = numbers<std::size_t>(arrays[0]);
	s.column = numbers<int32_t>(arrays[1]);
	s.blocks = numbers<cd::Block>(arrays[2]);
	s.q = numbers<double>(arrays[3]);
	s.mu = numbers<double>(arrays[4]);
	s.p = numbers<double>(impulses);
	for (std::size_t i = 0; i < s.mu.size(); i++) {
		const auto begin = s.column.begin(), end = begin + static_cast<std::ptrdiff_t>(s.start[i + 1]);
		const auto own = std::lower_bound(begin + static_cast<std::ptrdiff_t>(s.start[i]), end, static_cast<int32_t>(i));
		s.diagonal.push_back(static_cast<std::size_t>(own - begin));
	}
	return s;
}

// A problem in the velocities of the bodies: three inverse masses and three free velocities a body; two bodies, a normal, four arms (a_n,
// a_t, b_n, b_t), a bias and a friction coefficient a contact.
cd::ContactSystem<cd::Plane> bodySystem(const py::tuple& arrays, const py::object& impulses)
{
	const auto w = numbers<double>(arrays[0]), v = numbers<double>(arrays[1]), normal = numbers<double>(arrays[3]);
	const auto pair = numbers<int32_t>(arrays[2]);
	const auto arm = numbers<double>(arrays[4]), bias = numbers<double>(arrays[5]), mu = numbers<double>(arrays[6]);
	const auto p = numbers<double>(impulses);
	cd::ContactSystem<cd::Plane> s;
	s.memory = &memory;
	s.bodies.resize(w.size() / 3);
	for (std::size_t i = 0; i < s.bodies.size(); i++) {
		std::copy_n(&w[3 * i], 3, s.bodies[i].w);
		std::copy_n(&v[3 * i], 3, s.bodies[i].v);
	}
	s.contacts.resize(mu.size());
	for (std::size_t i = 0; i < mu.size(); i++) {
		cd::ContactRow<cd::Plane>& c = s.contacts[i];
		c.a = pair[2 * i];
		c.b = pair[2 * i + 1];
		c.nx = normal[2 * i];
		c.ny = normal[2 * i + 1];
		c.an = arm[4 * i];
		c.at = arm[4 * i + 1];
		c.bn = arm[4 * i + 2];
		c.bt = arm[4 * i + 3];
		c.bias = bias[i];
		c.mu = mu[i];
		c.pn = p[2 * i];
		c.pt = p[2 * i + 1];
	}
	s.assembleBlocks();
	return s;
}

// Of this thread [s]: what a solution costs, whatever else the machine does meanwhile.
double processorTime()
{
	timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Ctrl-C ends a solution.
void endOnSignal()
{
	const WithInterpreterLock locked;
	if (PyErr_CheckSignals() != 0)
		throw py::error_already_set();
}

// (iterations, factorizations, residual, residual_max, status, contact, solved_by, seconds, evaluations) of a solution. evaluations: of a
// trace, two numbers each.
template <class System, class Solver>
py::tuple solved(System& system, Solver* solver, const std::string& method, cd::SolverSettings settings, bool traced)
{
	cd::Trace trace;
	trace.records = traced;
	trace.interrupt = endOnSignal;
	settings.trace = &trace;
	cd::SolverReport report;
	double seconds = 0;
	{
		const WithoutInterpreterLock unlocked;
		const double begin = processorTime();
		report = solver(system, settings);
		seconds = processorTime() - begin;
	}
	py::list evaluations;
	for (const cd::Trace::Evaluation& one : trace.evaluations) {
		evaluations.append(one.iterations);
		evaluations.append(one.error);
	}
	return py::make_tuple(report.iterations, report.factorizations, report.residual, report.residualMax, cd::name(report.status), report.contact,
	    cd::solvedBy(method, report), seconds, evaluations);
}

// Returns the impulses, and what `solved` does. threads: for bodies, of which there are seven arrays.
py::tuple solve(const py::tuple& arrays, const py::object& impulses, const std::string& method, double tolerance, int maxIterations,
    int fixedIterations, unsigned seed, bool traced, int threads)
{
	cd::SolverSettings settings { tolerance, maxIterations, fixedIterations, seed };
	// A guess that tells nothing is not used: it would stay where nothing resists it.
	if (py::len(arrays) == 5) {
		cd::DelassusSystem system = matrixSystem(arrays, impulses);
		if (!(cd::resolution(system).growth <= cd::mostGrowth))
			std::fill(system.p.begin(), system.p.end(), 0.);
		const py::tuple report = solved(system, cd::findDelassusSolver(method), method, settings, traced);
		return py::make_tuple(bytes(system.p), report);
	}
	cd::ContactSystem<cd::Plane> system = bodySystem(arrays, impulses);
	if (!(cd::resolution(system, numbers<double>(arrays[1])).growth <= cd::mostGrowth))
		for (cd::ContactRow<cd::Plane>& c : system.contacts)
			c.pn = c.pt = 0;
	cd::Threads team;
	team.use(threads);
	settings.threads = &team;
	const py::tuple report = solved(system, cd::findSolver(method), method, settings, traced);
	std::vector<double> p;
	for (const cd::ContactRow<cd::Plane>& c : system.contacts)
		p.insert(p.end(), { c.pn, c.pt });
	return py::make_tuple(bytes(p), report);
}

// Returns (residual, residual_max).
py::tuple residual(const py::tuple& arrays, const py::object& impulses)
{
	const cd::Residual e = py::len(arrays) == 5 ? cd::residual(matrixSystem(arrays, impulses))
						    : cd::residual(bodySystem(arrays, impulses), numbers<double>(arrays[1]));
	return py::make_tuple(e.norm, e.maximum);
}

// (bytes of a contact, of its impulses a sweep before, of a body) as sweeps over bodies store them.
py::tuple bytesOfASweep()
{
	return py::make_tuple(
	    sizeof(cd::Group<cd::Plane>) / cd::lanes, sizeof(cd::GroupBefore<cd::Plane>) / cd::lanes, sizeof(cd::PackedBody<cd::Plane>));
}

} // namespace

BOOST_PYTHON_MODULE(_core)
{
	py::def("solve", solve);
	py::def("residual", residual);
	py::def("bytes_of_a_sweep", bytesOfASweep);
	defineNames();
}
