// What makes a C++ class an engine like YADE's own: a base class that derives everything from one list of attributes.
#pragma once

#include "abi.hpp"
#include "scene_error.hpp"

#include <boost/serialization/base_object.hpp>
#include <boost/serialization/nvp.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>

#include <limits>
#include <mutex>
#include <string>
#include <vector>

namespace cd_engine {

using yade::Vector3r;

// What an attribute is to a user: a setting, a result, or what an engine remembers from step to step. The last kind (internal) is saved like the
// others, but help(), the inspector and .dict() do not show it. Python reads it with an underscore before its name.
enum class Access { set, read, internal };

struct Range {
	double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
	bool openLow = false; // low itself is excluded
};

// An engine E : RegisteredEngine<E> has
//   name            of the class in YADE
//   documentation   of the class
//   attributes(v)   calls v(name, member, Access, Range, documentation) for every attribute, in the order in which a user reads them. Keyword
//                   arguments, .dict(), saving, properties and documentation are all made from this list
//   checkText(attribute, value)   only if it has attributes of type string that can be set
//   checkLoaded()   only if there is something to refuse: throws SceneError if a file has left invalid values in the attributes
//   methods(c)      only if it has functions for Python: defines them on its class c
// and a line in module.cpp. python_registration.hpp defines the members.
template <class E> class RegisteredEngine : public yade::GlobalEngine {
    public:
	std::string getClassName() const override { return E::name; }
	std::string getBaseClassName(unsigned i = 0) const override { return i == 0 ? "GlobalEngine" : ""; }
	int getBaseClassNumber() const override { return 1; }
	void pySetAttr(const std::string& key, const boost::python::object& value) override;
	boost::python::dict pyDict() const override;
	void callPostLoad() override { GlobalEngine::callPostLoad(); }
	void pyRegisterClass(boost::python::object scope) override;
	template <class Class> static void methods(Class&) { }
	void checkLoaded() const { }

	template <class Archive> void serialize(Archive& archive, unsigned version)
	{
		if (version == 0)
			throw SceneError(std::string(E::name)
			    + ": the scene was saved by a version of this engine that did not yet name its attributes. Build it anew.");
		// Of E itself: Boost.Serialization learns here how to cast between E and its registered base.
		E& self = static_cast<E&>(*this);
		const std::lock_guard<std::mutex> lock(attributesLock);
		archive& boost::serialization::make_nvp("GlobalEngine", boost::serialization::base_object<yade::GlobalEngine>(self));
		checkAttributes(archive);
		E::attributes([&](const char* name, auto member, Access, const Range&, const char*) {
			archive& boost::serialization::make_nvp(name, self.*member);
		});
		if (Archive::is_loading::value)
			self.checkLoaded();
	}

	// Python may read attributes while a run continues in the background, so every read or write of one holds this lock. A thread that holds it
	// must not ask for Python's own lock, which a reader already has.
	mutable std::mutex attributesLock;
	template <class T> T read(T E::*member) const
	{
		const std::lock_guard<std::mutex> lock(attributesLock);
		return static_cast<const E&>(*this).*member;
	}

    private:
	// A scene holds the values one after the other. Read into other attributes, they would be nonsense or ask for endless memory.
	template <class Archive> static void checkAttributes(Archive& archive)
	{
		std::string names;
		E::attributes([&](const char* name, auto, Access, const Range&, const char*) { names += std::string(name) + ' '; });
		std::string saved = names;
		archive& boost::serialization::make_nvp("attributes", saved);
		if (saved != names)
			throw SceneError(std::string(E::name) + ": the scene was saved by another version of this engine, whose attributes were: "
			    + saved + "\nLoad it with that version, set O.engines = [] and save it again; or build the scene anew.");
	}
};

} // namespace cd_engine
