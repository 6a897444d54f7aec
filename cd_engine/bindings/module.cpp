// The Python module `cd_engine.core._core`: the solvers without YADE, for problems given by their matrix or by their bodies.
// Arrays come in through Python's buffer protocol, so that NumPy is needed by the callers only; cd_engine/core/solve.py is what users see.
#include "../core/group_kernel.hpp"
#include "../core/residual.hpp"
#include "../core/solver.hpp"
#include "../core/threads.hpp"
#include "../core/verdict.hpp"
#include "../core/workspace.hpp"

#include <boost/python.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <time.h>

namespace {

namespace py = boost::python;

// A contiguous array of T lent by a Python object for as long as this lives. std::invalid_argument is Python's ValueError.
template <class T> class Lent {
    public:
	Lent(const py::object& array, const char* name, bool writable = false)
	{
		if (PyObject_GetBuffer(array.ptr(), &view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | (writable ? PyBUF_WRITABLE : 0)) != 0)
			py::throw_error_already_set();
		const char kind = view.format && std::strlen(view.format) == 1 ? view.format[0] : '?';
		const bool fits = std::is_floating_point_v<T> ? kind == 'd' : std::strchr("ilq", kind) != nullptr;
		if (!fits || view.itemsize != sizeof(T)) {
			PyBuffer_Release(&view);
			throw std::invalid_argument(std::string(name) + " is not an array of the type expected");
		}
	}
	~Lent() { PyBuffer_Release(&view); }
	Lent(const Lent&) = delete;
	Lent& operator=(const Lent&) = delete;

	T* begin() const { return static_cast<T*>(view.buf); }
	std::size_t size() const { return static_cast<std::size_t>(view.len) / sizeof(T); }
	T* end() const { return begin() + size(); }

    private:
	Py_buffer view;
};

void require(bool holds, const char* otherwise)
{
	if (!holds)
		throw std::invalid_argument(otherwise);
}

// The calls of a thread follow each other and share one. So who solves a problem again, with other numbers, does not wait for it to be packed anew.
cd::Workspace& memoryOfThread()
{
	static thread_local cd::Workspace memory;
	return memory;
}

// start, column, blocks: W as rows of 2 x 2 blocks. What is checked is what keeps the core inside its arrays; what a user can get wrong is
// found in problem.py, where it has a name and a place.
cd::DelassusSystem build(
    const py::object& start, const py::object& column, const py::object& blocks, const py::object& q, const py::object& mu, const Lent<double>& p)
{
	const Lent<int64_t> starts(start, "start");
	const Lent<int32_t> columns(column, "column");
	const Lent<double> values(blocks, "blocks"), free(q, "q"), friction(mu, "mu");
	const std::size_t n = friction.size();
	require(n < std::numeric_limits<int32_t>::max(), "too many contacts");
	require(starts.size() == n + 1 && free.size() == 2 * n && p.size() == 2 * n, "start, q, mu and the impulses do not fit together");
	require(values.size() == 4 * columns.size(), "blocks and column do not fit together");
	require(*starts.begin() == 0 && std::is_sorted(starts.begin(), starts.end()) && starts.begin()[n] == static_cast<int64_t>(columns.size()),
	    "start does not count the blocks");
	cd::DelassusSystem s;
	s.memory = &memoryOfThread();
	s.start.assign(starts.begin(), starts.end());
	s.column.assign(columns.begin(), columns.end());
	s.blocks.resize(columns.size());
	for (std::size_t k = 0; k < s.blocks.size(); k++) {
		const double* const v = values.begin() + 4 * k;
		s.blocks[k] = { v[0], v[1], v[2], v[3] };
	}
	s.q.assign(free.begin(), free.end());
	s.mu.assign(friction.begin(), friction.end());
	s.p.assign(p.begin(), p.end());
	s.diagonal.resize(n);
	for (std::size_t i = 0; i < n; i++) {
		std::size_t found = s.start[i + 1];
		for (std::size_t k = s.start[i]; k < s.start[i + 1]; k++) {
			require(s.column[k] >= 0 && static_cast<std::size_t>(s.column[k]) < n, "a block lies outside the matrix");
			if (static_cast<std::size_t>(s.column[k]) == i)
				found = k;
		}
		require(found < s.start[i + 1] && s.blocks[found].nn > 0 && s.blocks[found].tt > 0, "a diagonal block is missing or not positive");
		s.diagonal[i] = found;
	}
	return s;
}

// A problem in the velocities of the bodies, given as a tuple of arrays: three inverse masses and three free velocities a body; two bodies, a
// normal, four arms (a_n, a_t, b_n, b_t), a bias and a friction coefficient a contact. Checked as above; body_problem.py finds the rest.
struct Bodies {
	explicit Bodies(const py::tuple& arrays)
	    : w(arrays[0], "inverse_masses")
	    , v(arrays[1], "free_velocities")
	    , pair(arrays[2], "pairs")
	    , normal(arrays[3], "normals")
	    , arm(arrays[4], "arms")
	    , gap(arrays[5], "bias")
	    , friction(arrays[6], "mu")
	{
	}
	cd::ContactSystem build(const Lent<double>& p) const;

	const Lent<double> w, v;
	const Lent<int32_t> pair;
	const Lent<double> normal, arm, gap, friction;
};

cd::ContactSystem Bodies::build(const Lent<double>& p) const
{
	const std::size_t n = friction.size(), bodies = w.size() / 3;
	require(n < std::numeric_limits<int32_t>::max() && bodies < std::numeric_limits<int32_t>::max(), "too many contacts or bodies");
	require(w.size() == 3 * bodies && v.size() == 3 * bodies, "inverse_masses and free_velocities do not fit together");
	require(pair.size() == 2 * n && normal.size() == 2 * n && arm.size() == 4 * n && gap.size() == n && p.size() == 2 * n,
	    "pairs, normals, arms, bias, mu and the impulses do not fit together");
	cd::ContactSystem s;
	s.memory = &memoryOfThread();
	s.bodies.resize(bodies);
	for (std::size_t i = 0; i < bodies; i++) {
		std::copy_n(w.begin() + 3 * i, 3, s.bodies[i].w);
		std::copy_n(v.begin() + 3 * i, 3, s.bodies[i].v);
	}
	s.contacts.resize(n);
	for (std::size_t i = 0; i < n; i++) {
		cd::ContactRow& c = s.contacts[i];
		c.a = pair.begin()[2 * i];
		c.b = pair.begin()[2 * i + 1];
		for (const int32_t body : { c.a, c.b })
			require(body >= 0 && static_cast<std::size_t>(body) < bodies, "a contact has a body that is not there");
		require(c.a != c.b, "a body touches itself");
		c.nx = normal.begin()[2 * i];
		c.ny = normal.begin()[2 * i + 1];
		c.an = arm.begin()[4 * i];
		c.at = arm.begin()[4 * i + 1];
		c.bn = arm.begin()[4 * i + 2];
		c.bt = arm.begin()[4 * i + 3];
		c.bias = gap.begin()[i];
		c.mu = friction.begin()[i];
		c.pn = p.begin()[2 * i];
		c.pt = p.begin()[2 * i + 1];
	}
	s.assembleBlocks();
	return s;
}

// Other Python threads run while this one solves.
class WithoutInterpreterLock {
    public:
	WithoutInterpreterLock()
	    : state(PyEval_SaveThread())
	{
	}
	~WithoutInterpreterLock() { PyEval_RestoreThread(state); }

    private:
	PyThreadState* state;
};

// Of this thread [s]: what a solution costs, whatever else the machine does meanwhile.
double processorTime()
{
	timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// (iterations, factorizations, residual, residual_max, status, doubtful, contact, solved_by, seconds, looks) of a solution. looks: of a trace, two
// numbers each.
template <class System, class Solver>
py::tuple solved(System& system, Solver* solver, const std::string& method, cd::SolverSettings settings, bool traced)
{
	cd::Trace trace;
	if (traced)
		settings.trace = &trace;
	cd::SolverReport report;
	double seconds = 0;
	{
		const WithoutInterpreterLock unlocked;
		const double begin = processorTime();
		report = solver(system, settings);
		seconds = processorTime() - begin;
	}
	py::list looks;
	for (const cd::Trace::Look& look : trace.looks) {
		looks.append(look.iterations);
		looks.append(look.error);
	}
	return py::make_tuple(report.iterations, report.factorizations, report.residual, report.residualMax, cd::name(report.status), report.doubtful,
	    report.contact, cd::solvedBy(method, report), seconds, looks);
}

// Improves `impulses` in place. Returns what `solved` does.
py::tuple solve(const py::object& start, const py::object& column, const py::object& blocks, const py::object& q, const py::object& mu,
    const py::object& impulses, const std::string& method, double tolerance, int maxIterations, int fixedIterations, unsigned seed, bool traced)
{
	const cd::DelassusSolver solver = cd::findDelassusSolver(method);
	require(solver != nullptr, "there is no such method");
	const Lent<double> p(impulses, "impulses", true);
	cd::DelassusSystem system = build(start, column, blocks, q, mu, p);
	if (!(cd::growth(system) <= cd::mostGrowth)) // a guess that tells nothing, and would stay where nothing resists it
		std::fill(system.p.begin(), system.p.end(), 0.);
	const py::tuple report = solved(system, solver, method, { tolerance, maxIterations, fixedIterations, seed }, traced);
	std::copy(system.p.begin(), system.p.end(), p.begin());
	return report;
}

// The same for bodies.
py::tuple solveBodies(const py::tuple& arrays, const py::object& impulses, const std::string& method, double tolerance, int maxIterations,
    int fixedIterations, unsigned seed, bool traced, int threads)
{
	const cd::Solver solver = cd::findSolver(method);
	require(solver != nullptr, "there is no such method");
	const Lent<double> p(impulses, "impulses", true);
	const Bodies bodies(arrays);
	cd::ContactSystem system = bodies.build(p);
	if (!(cd::growth(system, { bodies.v.begin(), bodies.v.end() }) <= cd::mostGrowth)) // as above
		for (cd::ContactRow& c : system.contacts)
			c.pn = c.pt = 0;
	cd::Threads team;
	team.use(threads);
	cd::SolverSettings settings { tolerance, maxIterations, fixedIterations, seed };
	settings.threads = &team;
	const py::tuple report = solved(system, solver, method, settings, traced);
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		p.begin()[2 * i] = system.contacts[i].pn;
		p.begin()[2 * i + 1] = system.contacts[i].pt;
	}
	return report;
}

// Returns (residual, residual_max).
py::tuple residual(const py::object& start, const py::object& column, const py::object& blocks, const py::object& q, const py::object& mu,
    const py::object& impulses)
{
	const Lent<double> p(impulses, "impulses");
	const cd::Residual e = cd::residual(build(start, column, blocks, q, mu, p));
	return py::make_tuple(e.norm, e.maximum);
}

py::tuple residualOfBodies(const py::tuple& arrays, const py::object& impulses)
{
	const Lent<double> p(impulses, "impulses");
	const Bodies bodies(arrays);
	const cd::Residual e = cd::residual(bodies.build(p), { bodies.v.begin(), bodies.v.end() });
	return py::make_tuple(e.norm, e.maximum);
}

py::list methods()
{
	py::list all;
	for (const std::string& m : cd::solverNames())
		all.append(m);
	return all;
}

py::list instructionSets()
{
	py::list all;
	for (const cd::GroupKernel& kernel : cd::groupKernels())
		all.append(kernel.name);
	return all;
}

void useInstructionSet(const std::string& name)
{
	for (const cd::GroupKernel& kernel : cd::groupKernels())
		if (name == kernel.name)
			return cd::useGroupKernel(kernel);
	throw std::invalid_argument("this processor has no instruction set '" + name + "' that the sweeps are written for");
}

// (bytes of a contact, of its impulses a sweep before, of a body) as sweeps over bodies store them.
py::tuple bytesOfASweep()
{
	return py::make_tuple(sizeof(cd::Group) / cd::Group::lanes, sizeof(cd::GroupBefore) / cd::Group::lanes, sizeof(cd::PackedBody));
}

} // namespace

BOOST_PYTHON_MODULE(_core)
{
	py::def("solve", solve);
	py::def("residual", residual);
	py::def("solve_bodies", solveBodies);
	py::def("residual_of_bodies", residualOfBodies);
	py::def("methods", methods);
	py::def("instruction_sets", instructionSets);
	py::def("use_instruction_set", useInstructionSet);
	py::def("bytes_of_a_sweep", bytesOfASweep);
}
