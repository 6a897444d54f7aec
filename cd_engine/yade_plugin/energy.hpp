// Energies for O.energy, where O.trackEnergy asks for them.
#pragma once

#include "../core/world.hpp"
#include "layout.hpp"

namespace cd_engine {

using yade::Vector3r;

inline bool tracksEnergy(yade::Scene* scene) { return at<bool>(scene, layout.scene_trackEnergy); }

// Of all free motions [J].
double kineticEnergy(const cd::World&);
// Of all free bodies in this gravity [J], from the origin.
double weightEnergy(const cd::World&, const Vector3r& gravity);

// Into O.energy, under YADE's names: kinetic as it is, gravWork and plastDissip added to what is there, so that total() stays the same where
// neither boundaries nor other forces do work.
void track(double kinetic, double gravWork, double plastDissip);

} // namespace cd_engine
