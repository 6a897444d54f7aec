// What the normal dashpots of Molecular Dynamics dissipate, which YADE's law functor does not sum.
#include "spring_engines.hpp"

namespace cd_engine {

// A dashpot of coefficient c pushes with f = c alpha v, v being the speed at which the centres approach and alpha = (R1 + R2)/d the factor by which
// YADE scales it, d their distance. It dissipates f v = f^2/(c alpha) a second. In leapfrog v is that of half a step before. What this leaves out is
// (omega dt)^2/4 of the sum, omega being the frequency of the springs, and a difference of two kinetic energies times c dt/m.
class DashpotWork : public SpringEngine<DashpotWork> {
    public:
	static constexpr const char* name = "DashpotWork";
	static constexpr const char* documentation
	    = "Sums the energy that the normal dashpots of the contacts dissipate. It stands right after InteractionLoop and reads the contacts of "
	      "Law2_ScGeom_FrictViscoPhys_CundallStrackVisco, whose own plasticDissipation() sums only the friction.";

	double work = 0; // [J]

	template <class Visitor> static void attributes(Visitor&& visit)
	{
		visit("work", &DashpotWork::work, setting, "Energy dissipated since the start [J].");
	}

	void step()
	{
		double power = 0;
		eachDashpot([&](yade::Interaction*, void* geom, void* phys) {
			const double radii = geom_refR1(geom) + geom_refR2(geom), alpha = radii / (radii - geom_penetrationDepth(geom));
			power += phys_normalViscous(phys).squaredNorm() / (phys_cn(phys) * alpha);
		});
		work += power * scene_dt(scene);
	}
};

} // namespace cd_engine

CD_ENGINE_REGISTER(DashpotWork)
