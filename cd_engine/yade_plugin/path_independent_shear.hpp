// Tangential springs between disks that store no path: McNamara, Garcia-Rojo and Herrmann, Phys. Rev. E 77, 031304 (2008).
#pragma once

#include "registered_engine.hpp"

namespace cd_engine {

// Two disks of radii R1, R2 with centres d = R1 + R2 - delta apart, the line of centres at the angle theta, turned by phi1 and phi2.
// The spring is stretched by
//     d xi = (R1 + R2) d theta - R1 d phi1 - R2 d phi2,
// an exact differential, so T = k_t xi depends on where the disks are and not on how they came there, until it slips at
// |T| = mu |R_n|. By virtual work the energy T^2/(2 k_t) pushes the disks apart sideways with alpha T, alpha = (R1 + R2)/d, and turns
// them with the arms R1 and R2. (The usual law has d instead of R1 + R2 and R_i - delta/2 instead of R_i in the stretch; that is no
// differential, and a closed path leaves a force behind.)
//
// Signs: n points from the first to the second disk, t is n turned by +90 degrees, phys.shearForce = S t acts on the second disk:
// S = -T. As everywhere in this project phys.shearForce is the force in the spring; what acts on the disks is alpha times that.
class PathIndependentShear : public RegisteredEngine<PathIndependentShear> {
    public:
	static constexpr const char* name = "PathIndependentShear";
	static const char* const documentation;

	// Left by the last step.
	int contacts = 0;
	int slidingContacts = 0;
	double frictionDissipation = 0; // since the start [J]
	// The memory of the springs, in the order of the scene's list of interactions: it survives O.save.
	std::vector<int> pairIds; // two a pair
	std::vector<double> pairNormals; // n_x, n_y
	std::vector<double> pairForces; // S [N]
	long lastStep = -1; // of the memory

	template <class Visitor> static void attributes(Visitor&& visit); // see RegisteredEngine

	void action() override;

    private:
	struct Disk {
		void* shape = nullptr; // null: not a disk
		double turn = 0; // since the step before [rad]
		double force[2] = { 0, 0 }, torque = 0; // to be added to O.forces
		bool touched = false;
	};

	void checkScene() const;
	void readBodies();
	void forget();
	bool exchange(yade::Interaction*);
	std::size_t recall(int id1, int id2);

	std::vector<Disk> disks; // at their bodies' ids
	// The memory being written while the old one is read; where the next pair is expected in it; its order by ids, made when needed.
	std::vector<int> newIds;
	std::vector<double> newNormals, newForces;
	std::size_t expected = 0;
	std::vector<std::size_t> sorted;
};

inline const char* const PathIndependentShear::documentation
    = "Makes the tangential springs between disks path-independent (McNamara, Garcia-Rojo and Herrmann, Phys. Rev. E 77, 031304, 2008). It "
      "stands "
      "behind InteractionLoop and before NewtonIntegrator, and replaces what the law functor has found for phys.shearForce of each contact of "
      "two "
      "spheres by T = ks xi with d xi = (R1+R2) d theta - R1 d phi1 - R2 d phi2, clipped at tan(phi)|normalForce|; the force on the disks is "
      "(R1+R2)/d T at the arms R1 and R2, d the distance of their centres. O.forces then holds this instead of the functor's force. "
      "A contact seen for the first time takes over the functor's shear force, so a packing made with the usual law goes on from its forces. "
      "For Law2_ScGeom_FrictPhys_CundallStrack and Law2_ScGeom_FrictViscoPhys_CundallStrackVisco and for spheres in one plane of constant z. "
      "Contacts with walls and boxes keep the functor's force. O.dt may change between steps only where nothing turns.";

template <class Visitor> void PathIndependentShear::attributes(Visitor&& visit)
{
	using C = PathIndependentShear;
	const Range any;
	visit("contacts", &C::contacts, Access::read, any, "Contacts between two disks that the last step has dealt with [1].");
	visit(
	    "slidingContacts", &C::slidingContacts, Access::read, any, "Of these, the ones that slipped at the Coulomb limit in the last step [1].");
	visit("frictionDissipation", &C::frictionDissipation, Access::set, any,
	    "Energy dissipated by the slips of these contacts since the start [J].");
	visit("pairIds", &C::pairIds, Access::internal, any, "Ids of the bodies of these contacts, two a contact; the memory of the springs.");
	visit(
	    "pairNormals", &C::pairNormals, Access::internal, any, "Their normals in the last step, from the first body to the second: x and y [1].");
	visit("pairForces", &C::pairForces, Access::internal, any,
	    "Their spring's forces on the second body along the normal turned by +90 degrees [N].");
	visit("lastStep", &C::lastStep, Access::internal, any, "O.iter of the last step; after a pause of this engine the memory starts anew.");
}

} // namespace cd_engine
