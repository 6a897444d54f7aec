// Where YADE's classes keep their members, established when the module loads and refused when in doubt.
//
// Three kinds of evidence, in this order:
//   vtable     the order of GlobalEngine's virtual functions, compared by symbol name
//   published  YADE exposes the member to Python by its pointer-to-member: class, type and offset are read from that registration
//   declared   not published; the offset is written here once and confirmed by writing through YADE and reading at the offset
//              (or the reverse) on objects made for the purpose
#pragma once

#include "abi.hpp"

#include <initializer_list>
#include <string>
#include <vector>

namespace cd_engine {

namespace py = boost::python;
template <class T> using Shared = boost::shared_ptr<T>;
using yade::Vector3r;

// A member of a class of YADE's.
struct AnyMember {
	const char *const owner, *const name, *const type;
	const bool published;
	long offset; // in bytes from the start of the object; if it is published, known only once it is confirmed

	operator long() const { return offset; }
	static inline std::vector<AnyMember*> all; // members list themselves, so that what is declared below is also what is confirmed
};

// member(object) is the member of an object.
template <class T> struct Member : AnyMember {
	// declared: the offset, -1 if YADE publishes the member.
	Member(const char* owner, const char* name, long declared = -1)
	    : AnyMember { owner, name, py::type_id<T>().name(), declared < 0, declared }
	{
		all.push_back(this);
	}
	T& operator()(void* object) const { return *reinterpret_cast<T*>(static_cast<char*>(object) + offset); }
	template <class U> T& operator()(const Shared<U>& object) const { return (*this)(object.get()); }
};

// Hidden from other libraries, so that an access looks up no symbol.
#pragma GCC visibility push(hidden)
inline Member<double> scene_dt { "Scene", "dt" }, scene_time { "Scene", "time" };
inline Member<long> scene_iter { "Scene", "iter" }, scene_stopAtIter { "Scene", "stopAtIter" };
inline Member<bool> scene_isPeriodic { "Scene", "isPeriodic" }, scene_trackEnergy { "Scene", "trackEnergy" }, scene_doSort { "Scene", "doSort" };
inline Member<yade::ForceContainer> scene_forces { "Scene", "forces", 32 };
inline Member<std::vector<Shared<yade::Engine>>> scene_engines { "Scene", "engines", 552 };
inline Member<Shared<yade::BodyContainer>> scene_bodies { "Scene", "bodies", 600 };
inline Member<Shared<yade::InteractionContainer>> scene_interactions { "Scene", "interactions", 616 };
inline Member<std::vector<Shared<yade::Interaction>>> interactions_linear { "InteractionContainer", "linear", 24 };

inline Member<int> body_id { "Body", "id" }, body_clumpId { "Body", "clumpId" }, body_flags { "Body", "flags" };
inline Member<int> body_groupMask { "Body", "groupMask" };
inline Member<Shared<yade::Material>> body_material { "Body", "material" };
inline Member<Shared<yade::State>> body_state { "Body", "state" };
inline Member<Shared<yade::Shape>> body_shape { "Body", "shape" };
inline Member<Shared<yade::Bound>> body_bound { "Body", "bound" };
inline Member<Vector3r> bound_min { "Bound", "min" }, bound_max { "Bound", "max" };

inline Member<Vector3r> state_pos { "State", "pos", 88 };
inline Member<double> state_ori { "State", "ori", 112 }; // the first of a quaternion's x, y, z, w
inline Member<Vector3r> state_vel { "State", "vel" }, state_angVel { "State", "angVel" }, state_inertia { "State", "inertia" };
inline Member<double> state_mass { "State", "mass" };
inline Member<unsigned> state_blockedDOFs { "State", "blockedDOFs", 304 };

inline Member<int> material_id { "Material", "id" };
inline Member<double> sphere_radius { "Sphere", "radius" }, frictMat_frictionAngle { "FrictMat", "frictionAngle" };
inline Member<double> elastMat_young { "ElastMat", "young" }, elastMat_poisson { "ElastMat", "poisson" };
inline Member<double> cohMat_etaRoll { "CohFrictMat", "etaRoll" }, cohMat_alphaKr { "CohFrictMat", "alphaKr" };
inline Member<bool> cohMat_momentRotationLaw { "CohFrictMat", "momentRotationLaw" };
inline Member<Vector3r> box_extents { "Box", "extents" };
inline Member<std::vector<Vector3r>> facet_vertices { "Facet", "vertices" };
inline Member<int> wall_sense { "Wall", "sense" }, wall_axis { "Wall", "axis" };

inline Member<int> interaction_id1 { "Interaction", "id1" }, interaction_id2 { "Interaction", "id2" };
inline Member<long> interaction_iterMadeReal { "Interaction", "iterMadeReal" };
inline Member<Shared<yade::IGeom>> interaction_geom { "Interaction", "geom" };
inline Member<Shared<yade::IPhys>> interaction_phys { "Interaction", "phys" };

inline Member<Vector3r> geom_normal { "GenericSpheresContact", "normal" }, geom_contactPoint { "GenericSpheresContact", "contactPoint" };
inline Member<double> geom_refR1 { "GenericSpheresContact", "refR1" }, geom_refR2 { "GenericSpheresContact", "refR2" };
inline Member<double> geom_penetrationDepth { "ScGeom", "penetrationDepth" };
inline Member<Vector3r> geom_shearInc { "ScGeom", "shearInc" };

inline Member<double> phys_kn { "NormPhys", "kn" }, phys_ks { "NormShearPhys", "ks" }, phys_cn { "FrictViscoPhys", "cn" };
inline Member<double> phys_tangensOfFrictionAngle { "FrictPhys", "tangensOfFrictionAngle" };
inline Member<Vector3r> phys_normalForce { "NormPhys", "normalForce" }, phys_shearForce { "NormShearPhys", "shearForce" };
inline Member<Vector3r> phys_normalViscous { "FrictViscoPhys", "normalViscous" };

inline Member<Vector3r> cohPhys_moment { "CohFrictPhys", "moment_bending" };
inline Member<double> cohPhys_kr { "RotStiffFrictPhys", "kr" }, cohPhys_maxRollPl { "CohFrictPhys", "maxRollPl" };
inline Member<bool> cohPhys_momentRotationLaw { "CohFrictPhys", "momentRotationLaw" };

inline Member<std::vector<int>> partial_ids { "PartialEngine", "ids" };
inline Member<int> collider_avoidSelfInteractionMask { "Collider", "avoidSelfInteractionMask" };
inline Member<bool> collider_doSort { "InsertionSortCollider", "doSort" };
inline Member<double> periodic_virtPeriod { "PeriodicEngine", "virtPeriod" }, periodic_virtLast { "PeriodicEngine", "virtLast" };
inline Member<double> periodic_realPeriod { "PeriodicEngine", "realPeriod" };
inline Member<long> periodic_iterPeriod { "PeriodicEngine", "iterPeriod" }, periodic_iterLast { "PeriodicEngine", "iterLast" };
inline Member<long> periodic_nDo { "PeriodicEngine", "nDo" }, periodic_nDone { "PeriodicEngine", "nDone" };
#pragma GCC visibility pop

// The interactions of a scene, real ones and others.
inline const std::vector<Shared<yade::Interaction>>& interactionsOf(yade::Scene* scene) { return interactions_linear(scene_interactions(scene)); }

// Confirms all members and returns each "Class.member" with its offset (vtable slots: the slot's number). Raises ImportError naming class, member,
// what was expected and what was found. claims: what a test claims falsely about a member to see the claim refused, {"State.vel": 136} (an offset)
// or {"State.vel": "int"} (a type).
py::list establishLayout(const py::dict& claims = {});

// Asks for the lines of memory of members ahead of their use.
inline void prefetch(void* object, std::initializer_list<long> members)
{
	for (const long member : members)
		__builtin_prefetch(static_cast<char*>(object) + member, 1);
}

} // namespace cd_engine
