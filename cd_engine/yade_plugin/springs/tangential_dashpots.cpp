// The tangential dashpot of eq. 6 of Garcia-Rojo, McNamara and Herrmann (2004), which YADE's viscous law does not have.
#include "spring_engines.hpp"

namespace cd_engine {

// The candidate S - c v, S being the force of the tangential spring and v the speed of the slip at the contact point, is taken back to the Coulomb
// limit mu |R|, R with its dashpot. The law functor has applied S; what remains of the dashpot is added, with the functor's arms R_i - delta/2. As
// everywhere in this project phys.shearForce stays the force in the spring, and as YADE's normal dashpot it sees the velocity of half a step before.
class TangentialDashpots : public SpringEngine<TangentialDashpots> {
    public:
	static constexpr const char* name = "TangentialDashpots";
	static constexpr const char* documentation
	    = "Adds a tangential dashpot to contacts with springs. It stands right behind InteractionLoop, or behind PathIndependentShear if that is "
	      "used. It takes the contacts of Law2_ScGeom_FrictViscoPhys_CundallStrackVisco that have a normal dashpot (betan above 0), and leaves "
	      "others alone: the sum of spring and dashpot is at most tan(phi)|normalForce|, in which YADE includes the normal dashpot, so it does "
	      "nothing at a contact that slides. phys.shearForce stays the force in the spring. It shortens the stable time step, which "
	      "cd_engine.springs.limit() counts and GlobalStiffnessTimeStepper does not.";

	double ratio = 1;
	double work = 0; // [J]

	template <class Visitor> static void attributes(Visitor&& visit)
	{
		using C = TangentialDashpots;
		visit("ratio", &C::ratio, within(0, 1000), "Coefficient of the tangential dashpot over that of the normal one, phys.cn [1].");
		visit("work", &C::work, setting,
		    "Energy dissipated since the start [J]; with avoidGranularRatcheting too large by about the overlap over the radius.");
	}

	void step()
	{
		auto& forces = scene_forces(scene);
		const double dt = scene_dt(scene);
		if (ratio == 0 || dt == 0) // nothing moves in a step of no time, which only makes contacts
			return;
		eachDashpot([&](yade::Interaction* contact, void* geom, void* phys) {
			const Vector3r spring = phys_shearForce(phys), &slip = geom_shearInc(geom);
			const Vector3r candidate = spring - ratio * phys_cn(phys) / dt * slip;
			const double limit = phys_tangensOfFrictionAngle(phys) * phys_normalForce(phys).norm(), size = candidate.norm();
			const Vector3r force = (size > limit ? limit / size : 1) * candidate - spring; // on the second body
			if (force == Vector3r::Zero())
				return;
			const Vector3r torque = geom_normal(geom).cross(force);
			const double inside = geom_penetrationDepth(geom) / 2;
			const int id1 = interaction_id1(contact), id2 = interaction_id2(contact);
			forces.addForce(id1, -force);
			forces.addForce(id2, force);
			forces.addTorque(id1, -(geom_refR1(geom) - inside) * torque);
			forces.addTorque(id2, -(geom_refR2(geom) - inside) * torque);
			work -= force.dot(slip);
		});
	}
};

} // namespace cd_engine

CD_ENGINE_REGISTER(TangentialDashpots)
