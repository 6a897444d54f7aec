// The Python module `_yade_plugin`: checks that it fits the running YADE, then registers the engines with YADE's class factory and with Python, as
// YADE's own plug-ins are.
#include "../bindings/python.hpp"
#include "contact_dynamics.hpp"
#include "waiting.hpp"

namespace cd_engine {
namespace {

	void fill()
	{
		establishLayout();
		Matches::registerConverters();
		for (void (*const registerEngine)() : registrations)
			registerEngine();
		defineNames();
		// Every member of YADE's classes that the plug-in relies on, with its confirmed offset, by the check made above; for tests.
		py::def("layout", establishLayout, py::arg("claims") = py::dict());
		py::def("check_engines", &ContactDynamics::checkEngines); // RuntimeError if it cannot work with others in O.engines; between runs
		py::def("next_problem", &ContactDynamics::nextProblem);
		py::def("settle", ContactDynamics::settleLatest);
		py::def(
		    "take_error", +[] { return exchangeError(""); });
		const auto runBegins = +[] {
			paused = false;
			exchangeError("");
		};
		py::def("run_begins", runBegins); // or goes on
		py::def(
		    "pause_begins", +[] { paused = true; }); // by another thread, which has to see the last step until the next run begins
		py::def(
		    "wait_begins", +[] { waiting++; }); // somebody waits for the end of the run, and does not look at the scene meanwhile
		const auto waitEnds = +[] {
			waiting--;
			ContactDynamics::settleLatest();
		};
		py::def("wait_ends", waitEnds);
	}

} // namespace
} // namespace cd_engine

// By hand and not by BOOST_PYTHON_MODULE, which returns the module even when filling it failed, and so hides the reason.
extern "C" PyObject* PyInit__yade_plugin()
{
	static PyModuleDef definition = { PyModuleDef_HEAD_INIT, "_yade_plugin", nullptr, -1, nullptr, nullptr, nullptr, nullptr, nullptr };
	PyObject* const module = boost::python::detail::init_module(definition, cd_engine::fill);
	if (!PyErr_Occurred())
		return module;
	Py_XDECREF(module);
	return nullptr;
}
