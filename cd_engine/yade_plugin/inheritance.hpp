// Whether an object of YADE's is of a class or derived from it, at the price of a comparison once its class has been seen.
#pragma once

namespace cd_engine {

enum class Base { FrictMat, ScGeom, NormShearPhys, FrictPhys, FrictViscoPhys, Sphere, PeriodicEngine };

// Asks YADE's class factory; remembers every class it has been asked about.
bool looksUpInheritance(const void* serializable, Base);

inline bool inherits(const void* serializable, Base base)
{
	static const void* latest[7] = {}; // vtable last found to be derived
	const void* const vtable = *static_cast<const void* const*>(serializable);
	if (vtable == latest[static_cast<int>(base)])
		return true;
	if (!looksUpInheritance(serializable, base))
		return false;
	latest[static_cast<int>(base)] = vtable;
	return true;
}

} // namespace cd_engine
