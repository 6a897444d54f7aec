// Where YADE's classes keep their members, established when the module loads and refused when in doubt.
//
// Three kinds of evidence, in this order:
//   published  YADE exposes the member to Python by its pointer-to-member: class, type and offset are read from that registration
//   declared   not published; the offset is written here once and confirmed by writing through YADE and reading at the offset
//              (or the reverse) on objects made for the purpose
//   vtable     the order of GlobalEngine's virtual functions, compared by symbol name
#pragma once

#include "abi.hpp"

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace cd_engine {

struct Layout {
	// Offsets in bytes from the start of the object of the class named in the first part.
	long scene_dt, scene_iter, scene_stopAtIter, scene_isPeriodic, scene_trackEnergy, scene_forces, scene_engines, scene_bodies,
	    scene_interactions;
	long body_id, body_material, body_state, body_shape, body_bound, body_clumpId, body_flags, body_groupMask;
	long state_se3, state_orientation, state_vel, state_mass, state_angVel, state_inertia, state_blockedDOFs;
	long interaction_id1, interaction_id2, interaction_iterMadeReal, interaction_geom, interaction_phys;
	long interactions_linear;
	long geom_normal, geom_contactPoint, geom_refR1, geom_refR2, geom_penetrationDepth, geom_shearInc;
	long phys_kn, phys_normalForce, phys_ks, phys_shearForce, phys_tangensOfFrictionAngle, phys_cn, phys_normalViscous;
	long bound_min, bound_max;
	long collider_avoidSelfInteractionMask, collider_doSort;
	long periodic_virtPeriod, periodic_realPeriod, periodic_iterPeriod, periodic_nDone, periodic_iterLast;
	long sphere_radius, box_extents, wall_sense, wall_axis, frictMat_frictionAngle;
};

// Of the running YADE; valid after establishLayout().
extern Layout layout;

// What a test may claim falsely about a member ("State.vel") to see the claim refused: another offset, another type.
struct Lie {
	long offset = -1;
	std::string type;
};

class LayoutError : public std::runtime_error {
	using std::runtime_error::runtime_error;
};

// Fills `layout` (only if everything is confirmed). Throws LayoutError naming class, member, what was expected and what was found.
void establishLayout(const std::map<std::string, Lie>& lies = {});

// Every "Class.member" that establishLayout() confirms, with its offset (vtable slots: the slot's number).
std::vector<std::pair<std::string, long>> layoutEntries();

template <class T> T& at(void* object, long offset) { return *reinterpret_cast<T*>(static_cast<char*>(object) + offset); }

// Asks for the line of memory of a member ahead of its use.
inline void prefetch(void* object, long offset) { __builtin_prefetch(static_cast<char*>(object) + offset, 1); }

// What a shared_ptr member points to.
template <class T> void* pointer(char* object, long offset) { return at<boost::shared_ptr<T>>(object, offset).get(); }

} // namespace cd_engine
