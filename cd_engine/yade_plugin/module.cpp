// The Python module `_yade_plugin`: checks that it fits the running YADE, then registers ContactDynamics with YADE's class factory,
// with Boost.Serialization and with Python, as YADE's own plug-ins are.
#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/xml_iarchive.hpp>
#include <boost/archive/xml_oarchive.hpp>
// The archives come first: the export below instantiates one serializer for each archive known by then.
#include "contact_dynamics.hpp"

#include <boost/python/raw_function.hpp>
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

BOOST_CLASS_EXPORT(cd_engine::ContactDynamics)

namespace cd_engine {

namespace py = boost::python;

namespace {

	const char* const documentation
	    = "Contact Dynamics for disks in the plane: rigid bodies, unilateral contact (Signorini) and exact, non-associated Coulomb friction, "
	      "solved implicitly for all contacts of a step at once; moves the bodies by the Moreau-Jean scheme. Takes the place of InteractionLoop "
	      "and "
	      "NewtonIntegrator; stands after ForceResetter and a collider that reports pairs before they touch (:py:func:`cd_engine.engines` makes "
	      "the list). "
	      "Disks are Sphere bodies with blockedDOFs='zXY' in one plane of constant z; Box (turned about z at will) and Wall are boundaries: "
	      "fixed, moving at a "
	      "prescribed velocity, or free in some freedoms and pushed by O.forces. Two boundaries never touch each other. Friction: the smaller "
	      "frictionAngle of the two. "
	      "After a step every loaded contact is a real interaction with ScGeom and FrictPhys, and O.forces holds the total on each body, gravity "
	      "included.";

	template <class T> std::string typeName();
	template <> std::string typeName<double>() { return "Real"; }
	template <> std::string typeName<int>() { return "int"; }
	template <> std::string typeName<long>() { return "long"; }
	template <> std::string typeName<bool>() { return "bool"; }
	template <> std::string typeName<std::string>() { return "string"; }
	template <> std::string typeName<Vector3r>() { return "Vector3r"; }
	template <> std::string typeName<std::vector<int>>() { return "vector<int>"; }
	template <> std::string typeName<std::vector<double>>() { return "vector<Real>"; }

	[[noreturn]] void raise(PyObject* type, const std::string& message)
	{
		PyErr_SetString(type, message.c_str());
		throw py::error_already_set();
	}

	std::string number(double x)
	{
		std::ostringstream s;
		s << x;
		return s.str();
	}

	// The range in words, empty where there is none.
	std::string allowed(const Range& range)
	{
		if (!std::isfinite(range.low))
			return "";
		std::string words = (range.openLow ? "above " : "at least ") + number(range.low);
		if (range.high < 1e9)
			words += " and at most " + number(range.high);
		return words;
	}

	void check(const char* name, double value, const Range& range)
	{
		if (value >= range.low && value <= range.high && !(range.openLow && value == range.low))
			return;
		raise(PyExc_ValueError,
		    std::string("ContactDynamics.") + name + "=" + number(value) + " is out of range: it must be " + allowed(range));
	}
	void check(const char* name, int value, const Range& range) { check(name, static_cast<double>(value), range); }
	void check(const char*, bool, const Range&) { }
	void check(const char* name, const std::string& value, const Range&)
	{
		if (std::string(name) != "method" || cd::findSolver(value))
			return;
		std::string known;
		for (const std::string& m : cd::solverNames())
			known += (known.empty() ? "'" : ", '") + m + "'";
		raise(PyExc_ValueError, "ContactDynamics.method='" + value + "' is not known; there is " + known);
	}
	void check(const char* name, const Vector3r& value, const Range&)
	{
		if (!value.allFinite())
			raise(PyExc_ValueError, std::string("ContactDynamics.") + name + " is not a vector of finite numbers");
		if (value[2] != 0)
			raise(PyExc_ValueError, std::string("ContactDynamics.") + name + " has a component out of the plane; its z must be 0");
	}
	template <class T> void check(const char*, const T&, const Range&) { } // results, never set

	template <class T> struct Setter {
		T ContactDynamics::*member;
		const char* name;
		Range range;
		void operator()(ContactDynamics& engine, const T& value) const
		{
			check(name, value, range);
			engine.*member = value;
		}
	};

	// Registers one attribute with its documentation in the form YADE's inspector and manual read.
	struct PropertyMaker {
		py::class_<ContactDynamics, boost::shared_ptr<ContactDynamics>, py::bases<yade::GlobalEngine>, boost::noncopyable>& cls;
		const ContactDynamics& defaults;

		template <class T>
		void operator()(const char* name, T ContactDynamics::*member, Access access, const Range& range, const char* text) const
		{
			const py::object value(defaults.*member);
			const std::string initial = py::extract<std::string>(py::str(value));
			const std::string words = allowed(range);
			const std::string doc = std::string(text) + (words.empty() ? "" : " Must be " + words + ".") + " :ydefault:`" + initial
			    + "` :yattrtype:`" + typeName<T>() + "` :yattrflags:`" + (access == Access::read ? "2" : "0") + "` ";
			const py::object getter = py::make_getter(member, py::return_value_policy<py::return_by_value>());
			if (access == Access::read)
				cls.add_property(name, getter, doc.c_str());
			else
				cls.add_property(name, getter,
				    py::make_function(Setter<T> { member, name, range }, py::default_call_policies(),
					boost::mpl::vector3<void, ContactDynamics&, const T&>()),
				    doc.c_str());
		}
	};

	// ContactDynamics(tolerance=1e-8, ...): keyword attributes as with every engine of YADE's.
	boost::shared_ptr<ContactDynamics> construct(py::tuple& arguments, py::dict& keywords)
	{
		const auto engine = boost::make_shared<ContactDynamics>();
		engine->pyHandleCustomCtorArgs(arguments, keywords);
		if (py::len(arguments) > 0)
			raise(PyExc_TypeError, "ContactDynamics takes keyword arguments only, for instance ContactDynamics(tolerance=1e-8)");
		if (py::len(keywords) > 0) {
			engine->pyUpdateAttrs(keywords);
			engine->callPostLoad();
		}
		return engine;
	}

	py::object constructRaw(py::tuple arguments, py::dict keywords)
	{
		py::object self = arguments[0];
		py::tuple rest(arguments.slice(1, py::_));
		return py::object(self.attr("__init__")(construct(rest, keywords)));
	}

	yade::Factorable* create() { return new ContactDynamics; }
	boost::shared_ptr<yade::Factorable> createShared() { return boost::make_shared<ContactDynamics>(); }
	void* createPureCustom() { return nullptr; }

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

} // namespace

void ContactDynamics::pySetAttr(const std::string& key, const py::object& value)
{
	bool found = false;
	attributes([&](const char* name, auto member, Access access, const Range& range, const char*) {
		if (key != name)
			return;
		found = true;
		if (access == Access::read)
			raise(PyExc_AttributeError, "ContactDynamics." + key + " is a result and cannot be set");
		using T = std::decay_t<decltype(this->*member)>;
		py::extract<T> extracted(value);
		if (!extracted.check())
			raise(PyExc_TypeError,
			    "ContactDynamics." + key + " must be of type " + typeName<T>() + ", not " + Py_TYPE(value.ptr())->tp_name);
		Setter<T> { member, name, range }(*this, extracted());
	});
	if (!found)
		GlobalEngine::pySetAttr(key, value);
}

py::dict ContactDynamics::pyDict() const
{
	py::dict all;
	attributes([&](const char* name, auto member, Access, const Range&, const char*) { all[name] = this->*member; });
	all.update(pyDictCustom());
	all.update(GlobalEngine::pyDict());
	return all;
}

void ContactDynamics::pyRegisterClass(py::object scope)
{
	checkPyClassRegistersItself("ContactDynamics");
	const py::scope inside(scope);
	py::docstring_options options;
	options.disable_signatures();
	py::class_<ContactDynamics, boost::shared_ptr<ContactDynamics>, py::bases<yade::GlobalEngine>, boost::noncopyable> cls(
	    "ContactDynamics", documentation);
	cls.def("__init__", py::raw_function(constructRaw, 1));
	cls.def("__init__", py::make_constructor(+[](const boost::shared_ptr<ContactDynamics>& e) { return e; }));
	attributes(PropertyMaker { cls, *this });
}

namespace {

	void fill()
	{
		verify({});
		Singleton<yade::ClassFactory>::instance().registerFactorable("ContactDynamics", create, createShared, createPureCustom);
		ContactDynamics().pyRegisterClass(py::import("yade.wrapper"));
		py::def("layout", layoutList, "Every member of YADE's classes the plug-in relies on, with its confirmed offset in bytes.");
		py::def("verify_layout", verifyLayout,
		    "Repeat the check made on import with false claims {member: offset or type name}; ImportError where one is found out.");
		py::def("methods", methods, "Names of the contact solvers.");
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
