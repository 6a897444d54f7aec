// The Python side of RegisteredEngine: attributes, constructor, documentation, and the entry in YADE's class factory.
#pragma once

#include "registered_engine.hpp"

#include <boost/make_shared.hpp>
#include <boost/python/raw_function.hpp>

#include <cmath>
#include <sstream>

namespace cd_engine {

namespace py = boost::python;

template <class T> inline const char* const typeName = nullptr;
template <> inline const char* const typeName<double> = "Real";
template <> inline const char* const typeName<int> = "int";
template <> inline const char* const typeName<long> = "long";
template <> inline const char* const typeName<bool> = "bool";
template <> inline const char* const typeName<std::string> = "string";
template <> inline const char* const typeName<Vector3r> = "Vector3r";
template <> inline const char* const typeName<std::vector<int>> = "vector<int>";
template <> inline const char* const typeName<std::vector<double>> = "vector<Real>";

[[noreturn]] inline void raise(PyObject* type, const std::string& message)
{
	PyErr_SetString(type, message.c_str());
	throw py::error_already_set();
}

inline std::string number(double x)
{
	std::ostringstream s;
	s << x;
	return s.str();
}

// The range in words; empty if there is no range.
inline std::string allowed(const Range& range)
{
	if (!std::isfinite(range.low))
		return "";
	std::string words = (range.openLow ? "above " : "at least ") + number(range.low);
	if (range.high < 1e9)
		words += " and at most " + number(range.high);
	return words;
}

// Refuses a value that the attribute cannot have.
template <class E, class T> void check(const char* attribute, const T& value, const Range& range)
{
	const auto full = [&] { return std::string(E::name) + "." + attribute; };
	if constexpr (std::is_same_v<T, double> || std::is_same_v<T, int>) {
		const double x = value;
		if (!(x >= range.low && x <= range.high && !(range.openLow && x == range.low)))
			raise(PyExc_ValueError,
			    full() + "=" + number(x) + " is out of range: it must be " + (allowed(range).empty() ? "a number" : allowed(range)));
	} else if constexpr (std::is_same_v<T, std::string>) {
		E::checkText(attribute, value);
	} else if constexpr (std::is_same_v<T, Vector3r>) {
		if (!value.allFinite())
			raise(PyExc_ValueError, full() + " is not a vector of finite numbers");
		if (value[2] != 0)
			raise(PyExc_ValueError, full() + " has a component out of the plane; its z must be 0");
	}
}

template <class E, class T> struct Setter {
	T E::*member;
	const char* name;
	Range range;
	void operator()(E& engine, const T& value) const
	{
		check<E>(name, value, range);
		const std::lock_guard<std::mutex> lock(engine.attributesLock);
		engine.*member = value;
	}
};

template <class E, class T> struct Getter {
	T E::*member;
	T operator()(const E& engine) const { return engine.read(member); }
};

template <class E> using PythonClass = py::class_<E, boost::shared_ptr<E>, py::bases<yade::GlobalEngine>, boost::noncopyable>;

// Registers one attribute with its documentation in the form YADE's inspector and manual read.
template <class E> struct PropertyMaker {
	PythonClass<E>& cls;
	const E& defaults;

	template <class T> void operator()(const char* name, T E::*member, Access access, const Range& range, const char* text) const
	{
		const py::object value(defaults.*member);
		const std::string initial = py::extract<std::string>(py::str(value));
		const std::string words = allowed(range);
		const std::string doc = std::string(text) + (words.empty() ? "" : " Must be " + words + ".") + " :ydefault:`" + initial
		    + "` :yattrtype:`" + typeName<T> + "` :yattrflags:`" + (access == Access::read ? "2" : "0") + "` ";
		const py::object getter = py::make_function(Getter<E, T> { member }, py::default_call_policies(), boost::mpl::vector2<T, const E&>());
		if (access == Access::internal)
			cls.add_property(("_" + std::string(name)).c_str(), getter, doc.c_str());
		else if (access == Access::read)
			cls.add_property(name, getter, doc.c_str());
		else
			cls.add_property(name, getter,
			    py::make_function(
				Setter<E, T> { member, name, range }, py::default_call_policies(), boost::mpl::vector3<void, E&, const T&>()),
			    doc.c_str());
	}
};

// E(name=value, ...): keyword attributes as with every engine of YADE's.
template <class E> boost::shared_ptr<E> construct(py::tuple& arguments, py::dict& keywords)
{
	const auto engine = boost::make_shared<E>();
	engine->pyHandleCustomCtorArgs(arguments, keywords);
	if (py::len(arguments) > 0)
		raise(PyExc_TypeError, std::string(E::name) + " takes keyword arguments only, for instance " + E::name + "(label='name')");
	if (py::len(keywords) > 0) {
		engine->pyUpdateAttrs(keywords);
		engine->callPostLoad();
	}
	return engine;
}

template <class E> py::object constructRaw(py::tuple arguments, py::dict keywords)
{
	py::object self = arguments[0];
	py::tuple rest(arguments.slice(1, py::_));
	return py::object(self.attr("__init__")(construct<E>(rest, keywords)));
}

// engine.name = value. Python would keep a misspelt name as an attribute of its own, which nothing reads.
template <class E> void setAttribute(const py::object& self, const std::string& name, const py::object& value)
{
	const py::object type = self.attr("__class__"), own = py::import("yade.wrapper").attr(E::name);
	// A class derived in Python may have attributes of its own.
	if (type.ptr() == own.ptr() && PyObject_HasAttrString(type.ptr(), name.c_str()) == 0) {
		const py::object near = py::import("difflib").attr("get_close_matches")(name, py::import("builtins").attr("dir")(type), 1);
		const std::string hint = py::len(near) ? "; did you mean " + std::string(py::extract<std::string>(near[0])) + "?" : "";
		raise(PyExc_AttributeError, std::string(E::name) + " has no attribute '" + name + "'" + hint);
	}
	py::import("builtins").attr("object").attr("__setattr__")(self, name, value);
}

template <class E> void RegisteredEngine<E>::pySetAttr(const std::string& key, const py::object& value)
{
	bool found = false;
	E::attributes([&](const char* name, auto member, Access access, const Range& range, const char*) {
		if (key != name || access == Access::internal)
			return;
		found = true;
		E& self = static_cast<E&>(*this);
		const std::string full = std::string(E::name) + "." + key;
		if (access == Access::read)
			raise(PyExc_AttributeError, full + " is a result and cannot be set");
		using T = std::decay_t<decltype(self.*member)>;
		py::extract<T> extracted(value);
		if (!extracted.check())
			raise(PyExc_TypeError, full + " must be of type " + typeName<T> + ", not " + Py_TYPE(value.ptr())->tp_name);
		Setter<E, T> { member, name, range }(self, extracted());
	});
	if (!found)
		GlobalEngine::pySetAttr(key, value);
}

template <class E> py::dict RegisteredEngine<E>::pyDict() const
{
	py::dict all;
	const E& self = static_cast<const E&>(*this);
	E::attributes([&](const char* name, auto member, Access access, const Range&, const char*) {
		if (access != Access::internal)
			all[name] = self.read(member);
	});
	all.update(pyDictCustom());
	all.update(GlobalEngine::pyDict());
	return all;
}

// Documentation of a class: what it is, then the names of its settings and of its results. help() itself lists them alphabetically.
template <class E> std::string documentation()
{
	std::string settings, results;
	E::attributes([&](const char* name, auto, Access access, const Range&, const char*) {
		std::string& names = access == Access::set ? settings : results;
		if (access != Access::internal)
			names += (names.empty() ? "" : ", ") + std::string(name);
	});
	return std::string(E::documentation) + (settings.empty() ? "" : "\n\nTo set: " + settings) + "\n\nTo read after a step: " + results;
}

template <class E> void RegisteredEngine<E>::pyRegisterClass(py::object scope)
{
	checkPyClassRegistersItself(E::name);
	const py::scope inside(scope);
	py::docstring_options options;
	options.disable_signatures();
	PythonClass<E> cls(E::name, documentation<E>().c_str());
	cls.def("__init__", py::raw_function(constructRaw<E>, 1));
	cls.def("__init__", py::make_constructor(+[](const boost::shared_ptr<E>& e) { return e; }));
	cls.def("__setattr__", &setAttribute<E>);
	E::attributes(PropertyMaker<E> { cls, static_cast<const E&>(*this) });
	E::methods(cls);
}

// Registers E with YADE's class factory and with Python. BOOST_CLASS_EXPORT registers it with Boost.Serialization.
template <class E> void registerEngine()
{
	Singleton<yade::ClassFactory>::instance().registerFactorable(
	    E::name, []() -> yade::Factorable* { return new E; }, []() -> boost::shared_ptr<yade::Factorable> { return boost::make_shared<E>(); },
	    []() -> void* { return nullptr; });
	E().pyRegisterClass(py::import("yade.wrapper"));
}

} // namespace cd_engine
