// What the normal dashpots of Molecular Dynamics dissipate, which YADE's law functor does not sum.
#pragma once

#include "registered_engine.hpp"

namespace cd_engine {

// A dashpot of coefficient c pushes with f = c alpha v, v being the speed at which the centres approach and alpha = (R1 + R2)/d the factor by which
// YADE scales it, d their distance. It dissipates f v = f^2/(c alpha) a second. In leapfrog v is that of half a step before. What this leaves out is
// (omega dt)^2/4 of the sum, omega being the frequency of the springs, and a difference of two kinetic energies times c dt/m.
class DashpotWork : public RegisteredEngine<DashpotWork> {
    public:
	static constexpr const char* name = "DashpotWork";
	static const char* const documentation;

	double work = 0; // [J]

	template <class Visitor> static void attributes(Visitor&& visit); // see RegisteredEngine

	void action() override;
};

inline const char* const DashpotWork::documentation
    = "Sums the energy that the normal dashpots of the contacts dissipate. It stands behind InteractionLoop and looks at the contacts that "
      "Law2_ScGeom_FrictViscoPhys_CundallStrackVisco has made, whose own plasticDissipation() has only the friction.";

template <class Visitor> void DashpotWork::attributes(Visitor&& visit)
{
	visit("work", &DashpotWork::work, Access::set, Range(), "Energy dissipated since the start [J].");
}

} // namespace cd_engine
