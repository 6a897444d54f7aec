// Whether an object of YADE's is of a class or derived from it, at the price of a comparison once its class has been seen.
#pragma once

namespace cd_engine {

enum class Base { FrictMat, ScGeom, NormShearPhys, FrictPhys };

bool inherits(const void* serializable, Base);

} // namespace cd_engine
