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
		py::def("layout", establishLayout, py::arg("claims") = py::dict(),
		    "Every member of YADE's classes the plug-in relies on, with its confirmed offset in bytes, by the check made on import. With "
		    "false claims {member: offset or type name}: ImportError where one is found out.");
		py::def(
		    "wait_begins", +[] { waiting++; }, "Somebody waits for the run to end and does not look at the scene meanwhile.");
		const auto waitEnds = +[] {
			waiting--;
			ContactDynamics::settleLatest();
		};
		py::def("wait_ends", waitEnds, "The end of that: the scene is up to date.");
		const auto runBegins = +[] {
			paused = false;
			exchangeError("");
		};
		py::def("run_begins", runBegins, "A run begins or goes on.");
		py::def("check_engines", &ContactDynamics::checkEngines,
		    "RuntimeError if this engine cannot work with others in O.engines. For use between runs.");
		py::def(
		    "pause_begins", +[] { paused = true; },
		    "Another thread has paused the run and looks at the scene: until the next run begins, it has to see the last step.");
		py::def("former_stop", formerStop, "O.stopAtIter as it was before stopUnsolved ended a run, given the present one.");
		py::def("next_problem", &ContactDynamics::nextProblem, "What exportProblem writes.");
		py::def("settle", ContactDynamics::settleLatest, "Bring the scene up to date.");
		py::def(
		    "take_error", +[] { return exchangeError(""); }, "The error that has ended the last run, if nobody has taken it; else empty.");
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
