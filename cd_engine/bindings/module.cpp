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

template <class T> void read(const py::object& array, std::vector<T>& to) { to = numbers<T>(array); }

// A problem by its matrix: W as rows of 2 x 2 blocks, in space 3 x 3 (start, column, blocks), q and mu.
template <class System> System matrixSystem(const py::tuple& arrays, const py::object& impulses)
{
	System s;
	s.memory = &memory;
	s.start = numbers<std::size_t>(arrays[0]);
	s.column = numbers<int32_t>(arrays[1]);
	read(arrays[2], s.blocks);
	read(arrays[3], s.q);
	s.mu = numbers<double>(arrays[4]);
	read(impulses, s.p);
	for (std::size_t i = 0; i < s.mu.size(); i++) {
		const auto begin = s.column.begin(), end = begin + static_cast<std::ptrdiff_t>(s.start[i + 1]);
		const auto own = std::lower_bound(begin + static_cast<std::ptrdiff_t>(s.start[i]), end, static_cast<int32_t>(i));
		s.diagonal.push_back(static_cast<std::size_t>(own - begin));
	}
	return s;
}

// Of a matrix: q has three numbers a contact.
bool inSpace(const py::tuple& arrays) { return py::len(arrays[3]) == 3 * py::len(arrays[4]) && py::len(arrays[4]) > 0; }

// A problem in the velocities of the bodies: three inverse masses and three free velocities a body; two bodies, a normal, four arms (a_n,
// a_t, b_n, b_t), a bias, a friction coefficient, two compliances and a bias of the slip a contact.
cd::ContactSystem<cd::Plane> bodySystem(const py::tuple& arrays, const py::object& impulses)
{
	const auto w = numbers<double>(arrays[0]), v = numbers<double>(arrays[1]), normal = numbers<double>(arrays[3]);
	const auto pair = numbers<int32_t>(arrays[2]);
	const auto arm = numbers<double>(arrays[4]), bias = numbers<double>(arrays[5]), mu = numbers<double>(arrays[6]);
	const auto p = numbers<double>(impulses), compliance = numbers<double>(arrays[7]), slipBias = numbers<double>(arrays[8]);
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
		c.cn = compliance[2 * i];
		c.ct = compliance[2 * i + 1];
		c.slipBias = slipBias[i];
		c.pn = p[2 * i];
		c.pt = p[2 * i + 1];
	}
	s.assembleBlocks();
	s.contacts.compliant = !s.contacts.empty() && std::all_of(s.contacts.begin(), s.contacts.end(), [](const auto& c) { return c.compliant(); });
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

// (iterations, factorizations, residual, residual_max, error, status, contact, solved_by, seconds, evaluations) of a solution. evaluations: of a
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
	return py::make_tuple(report.iterations, report.factorizations, report.residual, report.residualMax, report.error, cd::name(report.status),
	    report.contact, cd::solvedBy(method, report), seconds, evaluations);
}

// Returns the impulses, and what `solved` does. threads: for bodies, of which there are nine arrays.
py::tuple solve(const py::tuple& arrays, const py::object& impulses, const std::string& method, double tolerance, int maxIterations,
    int fixedIterations, unsigned seed, bool traced, int threads)
{
	cd::SolverSettings settings { tolerance, maxIterations, fixedIterations, seed };
	if (py::len(arrays) == 5) {
		const auto solveMatrix = [&](auto system, auto* solver) {
			if (!(cd::resolution(system).growth <= cd::mostGrowth))
				std::fill(system.p.begin(), system.p.end(), typename decltype(system.p)::value_type {});
			const py::tuple report = solved(system, solver, method, settings, traced);
			return py::make_tuple(bytes(system.p), report);
		};
		return inSpace(arrays) ? solveMatrix(matrixSystem<cd::ConeSystem>(arrays, impulses), cd::findConeSolver(method))
				       : solveMatrix(matrixSystem<cd::DelassusSystem>(arrays, impulses), cd::findDelassusSolver(method));
	}
	// A guess that tells nothing is not used: it would stay where nothing resists it.
	cd::ContactSystem<cd::Plane> system = bodySystem(arrays, impulses);
	if (!system.contacts.compliant && !(cd::resolution(system, numbers<double>(arrays[1])).growth <= cd::mostGrowth))
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

// Spheres in space: six inverse masses and six free velocities a body; two bodies, a normal, two distances from the centres, a bias, a friction
// coefficient, two compliances and the bias of the slip a contact; of an impulse the normal part, and the three components of what is across.
cd::ContactSystem<cd::Space3> sphereSystem(const py::tuple& arrays, const std::vector<double>& p)
{
	const auto w = numbers<double>(arrays[0]), v = numbers<double>(arrays[1]), normal = numbers<double>(arrays[3]),
		   arm = numbers<double>(arrays[4]), bias = numbers<double>(arrays[5]), mu = numbers<double>(arrays[6]),
		   compliance = numbers<double>(arrays[7]), slip = numbers<double>(arrays[8]);
	const auto pair = numbers<int32_t>(arrays[2]);
	cd::ContactSystem<cd::Space3> s;
	s.memory = &memory;
	s.bodies.resize(w.size() / 6);
	for (std::size_t i = 0; i < s.bodies.size(); i++) {
		std::copy_n(&w[6 * i], 6, s.bodies[i].w);
		std::copy_n(&v[6 * i], 6, s.bodies[i].v);
	}
	s.contacts.resize(mu.size());
	for (std::size_t i = 0; i < mu.size(); i++) {
		const double *n = &normal[3 * i], *impulse = &p[4 * i];
		cd::ContactRow<cd::Space3>& c = s.contacts[i];
		c.a = pair[2 * i];
		c.b = pair[2 * i + 1];
		c.nx = n[0];
		c.ny = n[1];
		c.nz = n[2];
		c.at = arm[2 * i];
		c.bt = arm[2 * i + 1];
		c.bias = bias[i];
		c.mu = mu[i];
		c.cn = compliance[2 * i];
		c.ct = compliance[2 * i + 1];
		c.slipX = slip[3 * i];
		c.slipY = slip[3 * i + 1];
		c.slipZ = slip[3 * i + 2];
		cd::setImpulse(c, { impulse[0], impulse[1], impulse[2], impulse[3] });
	}
	s.assembleBlocks();
	s.contacts.compliant = !s.contacts.empty() && std::all_of(s.contacts.begin(), s.contacts.end(), [](const auto& c) { return c.compliant(); });
	return s;
}

// As solve().
py::tuple solveSpheres(const py::tuple& arrays, const py::object& impulses, bool momentum, double tolerance, int maxIterations, int fixedIterations,
    unsigned seed, bool traced, int threads)
{
	cd::SolverSettings settings { tolerance, maxIterations, fixedIterations, seed };
	cd::ContactSystem<cd::Space3> system = sphereSystem(arrays, numbers<double>(impulses));
	cd::Threads team;
	team.use(threads);
	settings.threads = &team;
	const py::tuple report
	    = solved(system, momentum ? cd::accelerated<cd::Space3> : cd::nsgs<cd::Space3>, momentum ? "accelerated" : "nsgs", settings, traced);
	std::vector<double> p;
	for (const cd::ContactRow<cd::Space3>& c : system.contacts)
		p.insert(p.end(), { c.pn, c.px, c.py, c.pz });
	return py::make_tuple(bytes(p), report);
}

// Returns (residual, residual_max).
py::tuple residual(const py::tuple& arrays, const py::object& impulses)
{
	const cd::Residual e = py::len(arrays) != 5 ? cd::residual(bodySystem(arrays, impulses), numbers<double>(arrays[1]))
	    : inSpace(arrays)			    ? cd::residual(matrixSystem<cd::ConeSystem>(arrays, impulses))
						    : cd::residual(matrixSystem<cd::DelassusSystem>(arrays, impulses));
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
	py::def("solve_spheres", solveSpheres);
	py::def("residual", residual);
	py::def("bytes_of_a_sweep", bytesOfASweep);
	defineNames();
}
