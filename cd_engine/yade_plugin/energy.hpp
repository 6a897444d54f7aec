// Energies for O.energy, if O.trackEnergy is set.
#pragma once

#include "../core/world.hpp"
#include "layout.hpp"

namespace cd_engine {

using yade::Vector3r;

inline bool tracksEnergy(yade::Scene* scene) { return at<bool>(scene, layout.scene_trackEnergy); }

// Kinetic energy of all free motions [J].
double kineticEnergy(const cd::World&);
// Potential energy of all free bodies in this gravity [J], relative to the origin.
double weightEnergy(const cd::World&, const Vector3r& gravity);

// Writes O.energy, under YADE's names. kinetic replaces the value there; gravWork and plastDissip are added to it. total() then stays the same if
// neither boundaries nor other forces do work.
void track(double kinetic, double gravWork, double plastDissip);

} // namespace cd_engine
