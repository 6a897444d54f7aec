// What both Python modules use: arrays, the interpreter's lock, and the names of the solvers and of the instruction sets for their sweeps.
#pragma once

#include "kernels/kernels.hpp"
#include "solvers/solvers.hpp"

#include <boost/python.hpp>

#include <string>
#include <vector>

namespace cd_engine {

namespace py = boost::python;

[[noreturn]] inline void raise(PyObject* type, const std::string& message)
{
	PyErr_SetString(type, message.c_str());
	throw py::error_already_set();
}

// Arrays pass as bytes, so that NumPy is needed by the callers only.
template <class T> py::object bytes(const std::vector<T>& v)
{
	return py::object(
	    py::handle<>(PyBytes_FromStringAndSize(reinterpret_cast<const char*>(v.data()), static_cast<Py_ssize_t>(v.size() * sizeof(T)))));
}

// A copy of what an array of T holds. The caller in Python has checked its type and its length.
template <class T> std::vector<T> numbers(const py::object& array)
{
	Py_buffer view;
	if (PyObject_GetBuffer(array.ptr(), &view, PyBUF_C_CONTIGUOUS) != 0)
		py::throw_error_already_set();
	const T* const begin = static_cast<const T*>(view.buf);
	std::vector<T> copy(begin, begin + static_cast<std::size_t>(view.len) / sizeof(T));
	PyBuffer_Release(&view);
	return copy;
}

// Other Python threads run while this exists.
class WithoutInterpreterLock {
    public:
	~WithoutInterpreterLock() { PyEval_RestoreThread(state); }

    private:
	PyThreadState* state = PyEval_SaveThread();
};

// This thread may call Python while this exists.
class WithInterpreterLock {
    public:
	~WithInterpreterLock() { PyGILState_Release(state); }

    private:
	PyGILState_STATE state = PyGILState_Ensure();
};

inline py::list instructionSets()
{
	py::list all;
	for (const cd::GroupKernel<cd::Plane>& kernel : cd::groupKernels<cd::Plane>())
		all.append(kernel.name);
	return all;
}

inline void useInstructionSet(const std::string& name)
{
	for (const cd::GroupKernel<cd::Plane>& kernel : cd::groupKernels<cd::Plane>())
		if (name == kernel.name)
			return cd::useGroupKernel(kernel);
	raise(PyExc_ValueError, "this processor has no instruction set '" + name + "' that the sweeps are written for");
}

// In the module that is being filled.
inline void defineNames()
{
	const auto methods = +[] {
		py::list all;
		for (const std::string& name : cd::solverNames())
			all.append(name);
		return all;
	};
	py::def("methods", methods, "Names of the contact solvers.");
	py::def("instruction_sets", instructionSets, "Names of those the sweeps can use on this processor, the fastest first.");
	py::def("use_instruction_set", useInstructionSet, "Sweep with this one from now on. The results are the same bits with all.");
}

} // namespace cd_engine
