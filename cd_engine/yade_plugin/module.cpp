// The Python module `_yade_plugin`: checks that it fits the running YADE, then registers the engines with YADE's class factory,
// with Boost.Serialization and with Python, as YADE's own plug-ins are.
#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/xml_iarchive.hpp>
#include <boost/archive/xml_oarchive.hpp>
// The archives come first: the export below instantiates one serializer for each archive known by then.
#include "../core/group_kernel.hpp"
#include "contact_dynamics.hpp"
#include "dashpot_work.hpp"
#include "path_independent_shear.hpp"
#include "python_registration.hpp"
#include "waiting.hpp"

#include <boost/serialization/export.hpp>

// Vector3r in an archive is YADE's: its serializer is the one already instantiated in the process.
namespace boost {
namespace serialization {
	template <class Archive> void serialize(Archive& archive, yade::Vector3r& v, unsigned)
	{
		archive& make_nvp("x", v[0]) & make_nvp("y", v[1]) & make_nvp("z", v[2]);
	}
}
}

// Version 1 begins with the names of its attributes (registered_engine.hpp).
BOOST_CLASS_VERSION(cd_engine::ContactDynamics, 1)
BOOST_CLASS_VERSION(cd_engine::DashpotWork, 1)
BOOST_CLASS_VERSION(cd_engine::PathIndependentShear, 1)
BOOST_CLASS_EXPORT(cd_engine::ContactDynamics)
BOOST_CLASS_EXPORT(cd_engine::DashpotWork)
BOOST_CLASS_EXPORT(cd_engine::PathIndependentShear)

namespace cd_engine {

template class RegisteredEngine<ContactDynamics>;
template class RegisteredEngine<DashpotWork>;
template class RegisteredEngine<PathIndependentShear>;

namespace {

	py::list layoutList()
	{
		py::list all;
		for (const auto& entry : layoutEntries())
			all.append(py::make_tuple(entry.first, entry.second));
		return all;
	}

	void verify(const std::map<std::string, Lie>& lies)
	{
		try {
			establishLayout(lies);
		} catch (const LayoutError& e) {
			raise(PyExc_ImportError, e.what());
		}
	}

	// For the tests: repeats the check of the module's import with false claims, {"State.vel": 136} (an offset) or {"State.vel": "int"} (a type).
	void verifyLayout(const py::dict& claims)
	{
		std::map<std::string, Lie> lies;
		const py::list names = claims.keys();
		for (py::ssize_t i = 0; i < py::len(names); i++) {
			Lie lie;
			const py::object claim = claims[names[i]];
			py::extract<long> offset(claim);
			if (offset.check())
				lie.offset = offset();
			else
				lie.type = py::extract<std::string>(claim);
			lies[py::extract<std::string>(names[i])] = lie;
		}
		verify(lies);
	}

	py::list methods()
	{
		py::list all;
		for (const std::string& m : cd::solverNames())
			all.append(m);
		return all;
	}

	void endWait()
	{
		waitEnds();
		ContactDynamics::settleLatest();
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
		raise(PyExc_ValueError, "this processor has no instruction set '" + name + "' that the sweeps are written for");
	}

	void fill()
	{
		verify({});
		registerEngine<ContactDynamics>();
		registerEngine<DashpotWork>();
		registerEngine<PathIndependentShear>();
		py::def("layout", layoutList, "Every member of YADE's classes the plug-in relies on, with its confirmed offset in bytes.");
		py::def("verify_layout", verifyLayout,
		    "Repeat the check made on import with false claims {member: offset or type name}; ImportError where one is found out.");
		py::def("wait_begins", waitBegins, "Somebody waits for the run to end and does not look at the scene meanwhile.");
		py::def("wait_ends", endWait, "The end of that: the scene is up to date.");
		py::def("pause_begins", pauseBegins, "Somebody is about to pause the run and to look at the scene.");
		py::def("settle", ContactDynamics::settleLatest, "Bring the scene up to date.");
		py::def("take_error", takeError, "The error that has ended the last run, if nobody has taken it; else empty.");
		py::def("run_begins", runBegins, "A run begins or goes on.");
		py::def("methods", methods, "Names of the contact solvers.");
		py::def("instruction_sets", instructionSets, "Names of those the sweeps can use on this processor, the fastest first.");
		py::def("use_instruction_set", useInstructionSet, "Sweep with this one from now on. The results are the same bits with all.");
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
