// What a C++ class needs to be an engine of YADE's like its own: a base that makes all of it from one list of attributes.
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

// What an attribute is to a user: a setting, a result, or what an engine remembers from step to step. The last is saved like the others, but neither
// shown by help() and the inspector nor in .dict(); Python reads it with an underscore before its name.
enum class Access { set, read, internal };

struct Range {
	double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
	bool openLow = false; // low itself is excluded
};

// An engine E : RegisteredEngine<E> has
//   name            of the class in YADE
//   documentation   of the class
//   attributes(v)   calls v(name, member, Access, Range, documentation) for every attribute, in the order a user reads them: the one
//                   list from which keyword arguments, .dict(), saving, properties and documentation are made
//   checkText(attribute, value)   only if it has attributes of type string that can be set
//   checkLoaded()   only if there is something to refuse: throws SceneError where a file has left in the attributes what cannot be
//   methods(c)      only if it has functions for Python: defines them on its class c
// and a line in module.cpp. The members are defined in python_registration.hpp.
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
		// Of E itself: Boost.Serialization learns here how E and its registered base are cast into one another.
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

	// Python reads attributes while a run goes on in the background: whoever reads or writes one holds this. Nobody who holds it asks for
	// Python's own lock, which a reader has.
	mutable std::mutex attributesLock;
	template <class T> T read(T E::*member) const
	{
		const std::lock_guard<std::mutex> lock(attributesLock);
		return static_cast<const E&>(*this).*member;
	}

    private:
	// A scene holds its values one after the other; read into other attributes they would be nonsense, or ask for endless memory.
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
