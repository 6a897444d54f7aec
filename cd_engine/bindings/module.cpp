// The Python module `cd_engine.core._core`: the solvers for problems given by their matrix, without YADE.
// Arrays come in through Python's buffer protocol, so that NumPy is needed by the callers only; cd_engine/core/solve.py is what users see.
#include "../core/residual.hpp"
#include "../core/solver.hpp"

#include <boost/python.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

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

// Improves `impulses` in place. Returns (iterations, residual, residual_max, status, seconds).
py::tuple solve(const py::object& start, const py::object& column, const py::object& blocks, const py::object& q, const py::object& mu,
    const py::object& impulses, const std::string& method, double tolerance, int maxIterations, int fixedIterations, unsigned seed)
{
	const cd::DelassusSolver solver = cd::findDelassusSolver(method);
	require(solver != nullptr, "there is no such method");
	const Lent<double> p(impulses, "impulses", true);
	cd::DelassusSystem system = build(start, column, blocks, q, mu, p);
	cd::SolverReport report;
	double seconds = 0;
	{
		const WithoutInterpreterLock unlocked;
		const auto begin = std::chrono::steady_clock::now();
		report = solver(system, { tolerance, maxIterations, fixedIterations, seed });
		seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
	}
	std::copy(system.p.begin(), system.p.end(), p.begin());
	return py::make_tuple(report.iterations, report.residual, report.residualMax, cd::name(report.status), seconds);
}

// Returns (residual, residual_max).
py::tuple residual(const py::object& start, const py::object& column, const py::object& blocks, const py::object& q, const py::object& mu,
    const py::object& impulses)
{
	const Lent<double> p(impulses, "impulses");
	const cd::Residual e = cd::residual(build(start, column, blocks, q, mu, p));
	return py::make_tuple(e.norm, e.maximum);
}

py::list methods()
{
	py::list all;
	for (const std::string& m : cd::solverNames())
		all.append(m);
	return all;
}

} // namespace

BOOST_PYTHON_MODULE(_core)
{
	py::def("solve", solve);
	py::def("residual", residual);
	py::def("methods", methods);
}
