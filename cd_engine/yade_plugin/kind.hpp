// Tells the class of an object of YADE's. Once a class has been seen, this costs one comparison.
#pragma once

#include "abi.hpp"

#include <map>

namespace cd_engine {

inline std::string className(const void* serializable) { return static_cast<const yade::Serializable*>(serializable)->getClassName(); }

// Whether the class of this name is `base` or derived from it, by YADE's class factory.
inline bool isA(const std::string& name, const char* base)
{
	return name == base || Singleton<yade::Omega>::instance().isInheritingFrom_recursive(name, base);
}

// Tells the objects of one class. The vtable identifies the class of an object, whose name is asked for once.
struct Kind {
	enum Which { withDerived, exactly };
	const char* base;
	Which which = withDerived;
	const void* latest = nullptr; // the vtable of the last object of this kind
	std::map<const void*, bool> seen {}; // by vtable

	bool operator()(const void* serializable)
	{
		const void* const vtable = *static_cast<const void* const*>(serializable);
		if (vtable == latest)
			return true;
		auto known = seen.find(vtable);
		if (known == seen.end()) {
			const std::string name = className(serializable);
			known = seen.emplace(vtable, which == exactly ? name == base : isA(name, base)).first;
		}
		if (known->second)
			latest = vtable;
		return known->second;
	}
};

inline Kind isScGeom { "ScGeom" }, isFrictPhys { "FrictPhys" }, isCohFrictPhys { "CohFrictPhys" };

} // namespace cd_engine
