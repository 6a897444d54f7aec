// What makes a C++ class an engine like YADE's own: a base class that derives everything from one list of attributes.
#pragma once

// The archives come first: CD_ENGINE_REGISTER instantiates one serializer for each archive known by then.
#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/xml_iarchive.hpp>
#include <boost/archive/xml_oarchive.hpp>

#include "../bindings/python.hpp"
#include "layout.hpp"
#include "matches.hpp"
#include "scene_error.hpp"

#include <boost/make_shared.hpp>
#include <boost/python/raw_function.hpp>
#include <boost/serialization/base_object.hpp>
#include <boost/serialization/export.hpp>
#include <boost/serialization/nvp.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>

#include <cmath>
#include <iomanip>
#include <mutex>
#include <string>
#include <vector>

// Vector3r in an archive is YADE's: its serializer is the one already instantiated in the process.
namespace boost {
namespace serialization {
	template <class Archive> void serialize(Archive& archive, yade::Vector3r& v, unsigned)
	{
		archive& make_nvp("x", v[0]) & make_nvp("y", v[1]) & make_nvp("z", v[2]);
	}
}
}

namespace cd_engine {

// What an attribute is to a user: a setting, a result, or what an engine remembers from step to step. The last kind (internal) is saved like the
// others, but help(), the inspector and .dict() do not show it. Python reads it with an underscore before its name.
struct Access {
	enum Kind { set, read, remember } kind;
	double low = -INFINITY, high = INFINITY; // what a setting may be
	bool openLow = false; // low itself is excluded

	bool allows(double x) const { return x >= low && x <= high && !(openLow && x == low); }
	// The limits in words; empty if there are none.
	std::string words() const
	{
		if (!std::isfinite(low))
			return "";
		return text(openLow ? "above " : "at least ", low, std::setprecision(10), " and at most ", high); // ten digits for the largest int
	}
};
constexpr Access setting { Access::set }, result { Access::read }, internal { Access::remember };
constexpr Access within(double low, double high) { return { Access::set, low, high }; }

// A type as YADE's inspector names it, and as a message does.
struct TypeName {
	const char *yade, *words;
};
template <class T> inline constexpr TypeName typeName {};
template <> inline constexpr TypeName typeName<double> { "Real", "a number" };
template <> inline constexpr TypeName typeName<int> { "int", "a whole number" };
template <> inline constexpr TypeName typeName<long> { "long", "a whole number" };
template <> inline constexpr TypeName typeName<bool> { "bool", "True or False" };
template <> inline constexpr TypeName typeName<std::string> { "string", "a text" };
template <> inline constexpr TypeName typeName<Vector3r> { "Vector3r", "three numbers" };
template <> inline constexpr TypeName typeName<Matches> { "shared_ptr<MatchMaker>", "a MatchMaker, a number or None" };
template <> inline constexpr TypeName typeName<std::vector<int>> { "vector<int>", "a list of whole numbers" };
template <> inline constexpr TypeName typeName<std::vector<double>> { "vector<Real>", "a list of numbers" };

// An engine E : RegisteredEngine<E> has
//   name            of the class in YADE
//   documentation   of the class; Python adds the names of the attributes (engine_methods.py)
//   attributes(v)   calls v(name, member, Access, documentation) for every attribute, in the order in which a user reads them. Keyword
//                   arguments, .dict(), saving, properties and documentation are all made from this list
//   wordFault(attribute, value)   only if it has attributes of type string that can be set: what is wrong with the value, as fault() says it
//   checkLoaded()   only if there is something to refuse: throws SceneError if a file has left invalid values in the attributes
// and after its definition CD_ENGINE_REGISTER(E).
template <class E> class RegisteredEngine : public yade::GlobalEngine {
    public:
	std::string getClassName() const override { return E::name; }
	std::string getBaseClassName(unsigned i = 0) const override { return i == 0 ? "GlobalEngine" : ""; }
	int getBaseClassNumber() const override { return 1; }
	static std::string wordFault(const char*, const std::string&) { return ""; }
	void checkLoaded() const { }

	void pySetAttr(const std::string& key, const py::object& value) override;
	py::dict pyDict() const override;
	void pyRegisterClass(py::object scope) override;

	// With YADE's class factory and with Python. CD_ENGINE_REGISTER registers it with Boost.Serialization.
	static void registerClass()
	{
		Singleton<yade::ClassFactory>::instance().registerFactorable(
		    E::name, []() -> yade::Factorable* { return new E; }, []() -> Shared<yade::Factorable> { return boost::make_shared<E>(); },
		    []() -> void* { return nullptr; });
		E().pyRegisterClass(py::import("yade.wrapper"));
	}

	template <class Archive> void serialize(Archive& archive, unsigned)
	{
		using boost::serialization::make_nvp;
		const std::lock_guard<std::mutex> lock(attributesLock);
		// Of E itself: Boost.Serialization learns here how to cast between E and its registered base.
		archive& make_nvp("GlobalEngine", boost::serialization::base_object<yade::GlobalEngine>(self()));
		// A scene holds the values one after the other. Read into other attributes, they would be nonsense or ask for endless memory.
		std::string names;
		E::attributes([&](const char* name, auto, const Access&, const char*) { names += std::string(name) + ' '; });
		std::string saved = names;
		archive& make_nvp("attributes", saved);
		if (saved != names)
			throw SceneError(std::string(E::name)
			    + ": the scene was saved by another version of this engine, whose attributes were: " + saved
			    + "\nLoad it with that version, set O.engines = [] and save it again; or create the scene again with your script.");
		E::attributes([&](const char* name, auto member, const Access&, const char*) { archive& make_nvp(name, self().*member); });
		if (!Archive::is_loading::value)
			return;
		E::attributes([&](const char* name, auto member, const Access& access, const char*) {
			const std::string wrong = access.kind == Access::set ? fault(name, self().*member, access) : "";
			if (!wrong.empty())
				throw SceneError(
				    std::string(E::name) + ": the file is damaged: " + name + wrong + ". Correct it there or load another one");
		});
		self().checkLoaded();
	}

	// Python may read attributes while a run continues in the background, so every read or write of one holds this lock. A thread that holds it
	// must not ask for Python's own lock, which a reader already has.
	mutable std::mutex attributesLock;
	template <class T> T read(T E::*member) const
	{
		const std::lock_guard<std::mutex> lock(attributesLock);
		return static_cast<const E&>(*this).*member;
	}

	// How often somebody has set an attribute.
	long changes() const
	{
		const std::lock_guard<std::mutex> lock(attributesLock);
		return changed;
	}

	// Called after Python has set an attribute, with the lock held.
	void assigned(const std::string&) { }

    private:
	long changed = 0;

	E& self() { return static_cast<E&>(*this); }

	// Whether `key` is one of the engine's own attributes, which then has this value.
	bool setOwn(const std::string& key, const py::object& value)
	{
		bool found = false;
		E::attributes([&](const char* name, auto member, const Access& access, const char*) {
			if (key != name || access.kind != Access::set)
				return;
			found = true;
			const auto full = [&key] { return std::string(E::name) + "." + key; }; // for messages only: hooks set attributes in mid-run
			using T = std::decay_t<decltype(self().*member)>;
			// NumPy's numbers are no numbers to Boost.Python.
			const bool ofNumpy = std::is_arithmetic_v<T> && PyObject_HasAttrString(value.ptr(), "item");
			const py::object plain = ofNumpy ? value.attr("item")() : value;
			const py::extract<T> extracted(plain);
			if (!extracted.check())
				raise(PyExc_TypeError, full() + " must be " + typeName<T>.words + ", not of type " + Py_TYPE(value.ptr())->tp_name);
			if constexpr (std::is_same_v<T, double> || std::is_same_v<T, int>)
				if (plain < access.low || plain > access.high) // T itself may be too narrow for it
					raise(PyExc_ValueError, full() + outOfRange(py::extract<std::string>(py::str(plain)), access));
			const T checked = extracted();
			if (const std::string wrong = fault(name, checked, access); !wrong.empty())
				raise(PyExc_ValueError, full() + wrong);
			const std::lock_guard<std::mutex> lock(attributesLock);
			self().*member = checked;
			changed++;
			self().assigned(key);
		});
		return found;
	}

	static std::string outOfRange(const std::string& value, const Access& access)
	{
		const std::string words = access.words();
		return "=" + value + " is out of range: it must be " + (words.empty() ? "a number" : words);
	}

	// What is wrong with a value of an attribute, in words that follow its name; empty: nothing.
	template <class T> static std::string fault(const char* name, const T& value, const Access& access)
	{
		if constexpr (std::is_same_v<T, double> || std::is_same_v<T, int>) {
			if (!access.allows(value))
				return outOfRange(text(value), access);
		} else if constexpr (std::is_same_v<T, Vector3r>) {
			if (!value.allFinite())
				return " is not a vector of finite numbers";
		} else if constexpr (std::is_same_v<T, std::string>)
			return E::wordFault(name, value);
		return "";
	}

	// E(name=value, ...): keyword attributes as with every engine of YADE's.
	static py::object construct(py::tuple arguments, py::dict keywords)
	{
		const auto engine = boost::make_shared<E>();
		if (py::len(arguments) > 1)
			raise(PyExc_TypeError, std::string(E::name) + " takes keyword arguments only, for instance " + E::name + "(label='name')");
		if (py::len(keywords) > 0)
			engine->update(keywords);
		return py::object(arguments[0]).attr("__init__")(engine);
	}

	void update(const py::dict& attributes)
	{
		py::dict ordered; // as the engine names its attributes: one may set another
		E::attributes([&](const char* name, auto, const Access&, const char*) {
			if (attributes.has_key(name))
				ordered[name] = attributes[name];
		});
		ordered.update(attributes);
		this->pyUpdateAttrs(ordered);
		this->callPostLoad();
	}

	// Documentation of an attribute in the form YADE's inspector and manual read.
	template <class T> static std::string attributeText(const T& initial, const Access& access, const char* text)
	{
		const std::string value = py::extract<std::string>(py::str(py::object(initial))), words = access.words();
		return text + (words.empty() ? "" : " Must be " + words + ".") + " :ydefault:`" + value + "` :yattrtype:`" + typeName<T>.yade
		    + "` :yattrflags:`" + (access.kind == Access::read ? "2" : "0") + "` ";
	}
};

// Not in the class, where they would be inline: a file that does not define the attributes has them from another (extern template).
template <class E> void RegisteredEngine<E>::pySetAttr(const std::string& key, const py::object& value)
{
	if (setOwn(key, value))
		return;
	// Refuses a result, and a misspelt name with the right one. YADE would say only that there is no such attribute.
	py::import("cd_engine.engine_methods").attr("check_name")(py::object(py::import("yade.wrapper").attr(E::name)), key);
	GlobalEngine::pySetAttr(key, value);
}

template <class E> py::dict RegisteredEngine<E>::pyDict() const
{
	py::dict all;
	E::attributes([&](const char* name, auto member, const Access& access, const char*) {
		if (access.kind != Access::remember)
			all[name] = read(member);
	});
	all.update(pyDictCustom());
	all.update(GlobalEngine::pyDict());
	return all;
}

template <class E> void RegisteredEngine<E>::pyRegisterClass(py::object scope)
{
	checkPyClassRegistersItself(E::name);
	const py::scope inside(scope);
	py::docstring_options options;
	options.disable_signatures();
	py::class_<E, Shared<E>, py::bases<yade::GlobalEngine>, boost::noncopyable> cls(E::name, E::documentation);
	cls.def("__init__", py::raw_function(construct, 1));
	cls.def("__init__", py::make_constructor(+[](const Shared<E>& e) { return e; }));
	E::attributes([&](const char* name, auto member, const Access& access, const char* text) {
		using T = std::decay_t<decltype(self().*member)>;
		const py::object getter = py::make_function(
		    [member](const E& engine) { return engine.read(member); }, py::default_call_policies(), boost::mpl::vector2<T, const E&>());
		const auto set = [name](RegisteredEngine& engine, const py::object& value) { engine.setOwn(name, value); };
		const py::object setter = py::make_function(set, py::default_call_policies(), boost::mpl::vector3<void, E&, const py::object&>());
		const std::string doc = attributeText(self().*member, access, text);
		if (access.kind == Access::set)
			cls.add_property(name, getter, setter, doc.c_str());
		else
			cls.add_property(((access.kind == Access::remember ? "_" : "") + std::string(name)).c_str(), getter, doc.c_str());
	});
}

// What registers each of the plug-in's engines; called when the module is filled.
inline std::vector<void (*)()> registrations;

} // namespace cd_engine

// Version 1 of a saved engine begins with the names of its attributes. At the end of the engine's file, outside of any namespace.
#define CD_ENGINE_REGISTER(E)                                                                                                                        \
	BOOST_CLASS_VERSION(cd_engine::E, 1)                                                                                                         \
	BOOST_CLASS_EXPORT(cd_engine::E)                                                                                                             \
	[[maybe_unused]] static const auto& registered = cd_engine::registrations.emplace_back(cd_engine::E::registerClass);
