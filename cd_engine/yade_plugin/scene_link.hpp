// Connects YADE's scene graph with the core's world: reads bodies, forces and near pairs, and writes motion and contact forces back.
#pragma once

#include "search/search.hpp"
#include "step/step.hpp"
#include "matches.hpp"
#include "scene_error.hpp"
#include "scene_plane.hpp"

#include <boost/weak_ptr.hpp>

#include <array>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace cd_engine {

// Overlaps kept as touching, sorted by ids: two ids a pair (the smaller first), one overlap [m] a pair.
struct ReferenceOverlaps {
	std::vector<int>& ids;
	std::vector<double>& overlaps;

	double of(int id1, int id2) const; // 0 if the pair has none
	void forget(const std::vector<cd::Pair>&, const std::vector<int32_t>& which) const;

    private:
	std::pair<int, int> pair(std::size_t i) const { return { ids[2 * i], ids[2 * i + 1] }; }
};

// What the engine keeps about the pairs from step to step, and saves.
struct Memory {
	ReferenceOverlaps overlaps;
	cd::SpaceOrder order;
	std::mutex& lock; // held while they change, since other threads may read them
};

// A body of this step. Its addresses are valid in this step only. Before the next step reads them again, it only prefetches from them.
struct KnownBody {
	boost::weak_ptr<yade::Body> identity;
	void *body = nullptr, *shape = nullptr, *state = nullptr; // no body: the id is erased
	long came = -1; // step in which it was first read
	int placed = 0; // number of steps in a row before which somebody has set its position
	long placedAt = 0; // the last of them
	double frictionAngle = 0; // [rad]; its tangent is in world.bodies
	double young = 0, poisson = 0; // of its material [Pa], [1]
	int material = -1; // its id in O.materials
	double etaRoll = 0, alphaKr = 0; // of a CohFrictMat with momentRotationLaw [1]; else 0
};
void prefetchBody(const KnownBody&);

// The objects that hold the force of a contact. They are kept while it is unloaded, since making new ones costs more than all else.
struct ForceObjects {
	Shared<yade::IGeom> geom {}; // null: none, or of a class that cannot hold a contact's force
	Shared<yade::IPhys> phys {};
	bool real = false; // whether the interaction has objects now: these, or others if geom is null
	bool holdMoment = false; // phys is a CohFrictPhys

	bool inUse() const { return real && geom; }
};

// Of the contacts: rigid if kn is infinite, unless the materials determine it.
struct StiffnessSettings {
	bool ofMaterials = false;
	double kn = cd::endless, kt = cd::endless; // [N/m]

	bool rigid() const { return !ofMaterials && kn == cd::endless; }
};

// What the settings say of pairs, by their materials.
struct PairValues {
	Matches en, frictAngle;
	double restitution = 0; // of pairs that `en` does not know

	// Throws SceneError for values out of range.
	void check() const;
	double largestRestitution() const;
	bool operator==(const PairValues& o) const { return en == o.en && frictAngle == o.frictAngle && restitution == o.restitution; }
};

template <class Space> class SceneLink {
	using World = cd::WorldOf<Space>;
	using Body = cd::BodyOf<Space>;
	using Shape = cd::ShapeOf<Space>;
	using Vector = cd::VectorOf<Space>;
	using Carried = typename Space::Carried;
	using Sleepers = cd::Sleepers<Space>;
	using Touch = cd::TouchOf<Space>;
	using TimeStep = cd::TimeStep<Space>;

    public:
	World world; // bodies: at their ids; erased ids are immobile bodies without pairs

	StiffnessSettings stiffness; // to be set before the scene is read,
	int mask = 0; // like this: ContactDynamics::mask

	// What holds for pairs from the next gather on. Returns whether it is new. Throws SceneError for values out of range.
	bool setValues(const PairValues&);
	// Reads the scene, unless the scene is out of date. checksOrder: whether this step checks that the order of the bodies is still good.
	// `margin`: the searchMargin. `outran`: StepReport::outran if a step is repeated, else empty.
	void gather(yade::Scene*, const Vector3r& gravity, double dt, const Memory&, bool checksOrder, double margin, TimeStep&,
	    const std::vector<double>& outran);
	// The same without changing the scene, and with only the permanent external forces. Needs a link of its own.
	void inspectScene(yade::Scene*, const Vector3r& gravity, double dt, const Memory&, bool checksOrder);
	// Makes the overlaps present now the reference ones, the deepest only if this engine's own springs have left them. Returns the largest one of
	// two bodies of which one can move [m].
	double takeOverlaps(bool ofOwnSprings);
	// Forgets all reference overlaps: springs count gaps from geometric contact.
	void forgetOverlaps();
	// Turns the bodies by a step of dt. From then on the scene is out of date, until it is published.
	void finishStep(TimeStep&, double dt);
	// Writes positions, velocities, interactions and O.forces after such a step. O.forces then holds the total on each body, gravity
	// and contacts included, as YADE's own laws leave it, so that utils.unbalancedForce finds the resultant.
	void publish(yade::Scene*, TimeStep&);
	// Writes positions and velocities of boundaries whose velocities others will set, and reads these before the next step.
	void publishMotion(const std::vector<int>& ids);
	bool areBoundaries(const std::vector<int>& ids) const;
	bool cameIn(long step, int id) const { return bodies[id].came == step; }
	// Like publish, without O.forces, if the scene is out of date. For a step that is given up.
	void catchUp(yade::Scene*, TimeStep&);
	// Writes positions and velocities only, if the scene is out of date; needs no memory.
	void saveMotion();
	std::size_t bodyCount() const { return bodies.size(); }
	// Its longestWay() tells how fast bodies are.
	const cd::PairSearchOf<Space>& pairSearch() const { return search; }
	int lost() { return search.lost(world); }
	// Whether the scene is out of date: steps have been made that are not published.
	bool isUnpublished() const { return unpublished; }
	// Whether all positions and velocities after the last step are finite. If not, the next step refuses them when it reads them.
	bool isFinite() const { return finite; }

	void collectOverlaps(const ReferenceOverlaps& into) const;
	// Whether somebody moves a boundary by its position.
	bool boundariesPlaced() const { return placesBoundaries; }
	// The pair that overlapped most in a step, beyond its reference overlap. The step must have had contacts.
	const cd::Pair& deepest(const TimeStep&) const;
	// If it is a disk behind a Wall that has only one side: a sentence for the user that says so. Else empty.
	std::string behindWall(const cd::Pair&) const;

	// The heaviest body over the lightest, of those that move [1].
	double massRatio() const;

	void warnOnce(const std::string& what, const std::string& remedy);
	// Where a body is, for a message.
	std::string placeOf(const Body&) const;
	// A vector of space as the core sees it, after the first step.
	Vector3r toCore(const Vector3r& v) const { return frame.toCore(v); }

    private:
	void checkScene(yade::Scene*, double dt);
	void gatherBodies(yade::Scene*);
	void findFrame(yade::BodyContainer&);
	void findPlane(yade::BodyContainer&);
	void findLayer(yade::BodyContainer&);
	void readBody(int id, const Shared<yade::Body>&, yade::ForceContainer&, long step);
	void checkMotion(int id);
	void readVelocity(int id, Body&);
	void readOrientation(int id);
	bool readShape(int id, Body&);
	bool readDisk(int id, Body&);
	bool readBox(int id, Shape&);
	bool readWall(int id, Shape&);
	void readFriction(int id, void* mat);
	void readRolling(int id, void* mat);
	void warnOfPlacing(int id, const Vector& before, long step);
	void readMotion(int id, Body&, yade::ForceContainer&);
	void gatherPairs(yade::Scene*, const Memory&, bool read, bool searched, bool reordered, Sleepers&);
	void warnOfUnheldBoundaries(double dt);
	void keepPairs();
	void takePairs(yade::Scene*);
	void forget(yade::Interaction*) const;
	void turn(std::size_t pair) const;
	void takeReferences(const Memory&, bool all);
	bool readForces(Sleepers*);
	bool holdsForce(std::size_t pair, bool turned);
	Carried readForce(std::size_t pair, bool turned);
	void setFriction(cd::Threads&);
	void setStiffness(Sleepers&);
	double firstRadius(const cd::Pair&) const;
	cd::Stiffness stiffnessOf(const cd::Pair&) const;
	void setRolling(Sleepers&);
	cd::Rolling rollingOf(const cd::Pair&) const;
	bool rolls(std::size_t pair) const { return world.rolls() && world.rollings[pair].bound > 0; }
	Touch touchAfterStep(std::size_t pair) const;
	void setPairFriction();
	void setRestitution();
	void recycle(ForceObjects&&);
	void makeReal(std::size_t pair);
	void orient(int id);
	void publishScene(yade::Scene*, const TimeStep&);
	void insert(yade::InteractionContainer&, std::size_t pair);
	void eraseParted(yade::Scene*);
	void writeContact(std::size_t pair, const Touch&);
	void writeVectors(std::size_t pair, const Touch&) const;
	void writePlace(std::size_t id) const;
	bool rotate(std::size_t id);
	void addForces(yade::ForceContainer&, int id, const typename cd::Account<Space>::Impulse&) const;
	void writeMotion(std::size_t id);

	PairValues values;
	bool newValues = false; // whether the pairs have other values
	// A class of materials that has been met, by its vtable.
	struct MaterialClass {
		const void* vtable;
		bool rolls; // it is a CohFrictMat
	};
	std::vector<MaterialClass> materials;
	bool anyRolls = false; // whether a body of the scene has a material that resists rolling
	std::vector<KnownBody> bodies;
	std::vector<std::array<double, 4>> orientations; // of the bodies: quaternions x, y, z, w
	std::vector<std::array<cd::Vector3, 3>> corners; // of the facets, in their own axes [m]; empty if there are none
	std::vector<int> gone; // ids whose body of the last step no longer exists or has been replaced
	std::vector<Shared<yade::Interaction>> listed; // the scene's interactions in its own order, to notice changes
	cd::PairSearchOf<Space> search;
	std::vector<yade::Interaction*> interactions; // of world.pairs; null: the pair has carried nothing yet
	std::vector<ForceObjects> objects; // of world.pairs, as last read or published
	std::vector<ForceObjects> pool, momentPool; // of pairs that no longer exist, for reuse; the second ones hold moments
	std::vector<yade::Interaction*> parted; // of pairs that no longer exist, until the scene is published
	bool inspecting = false; // the scene is only inspected, not changed
	std::set<std::string> warned; // warnings that have been printed
	bool placesBoundaries = false;
	bool unpublished = false; // whether the scene is out of date
	std::vector<int> driven; // boundaries whose velocities in the scene are up to date nevertheless
	int maskBefore = 0; // when the bodies were last read
	bool newSurfaces = false; // whether a surface has another velocity
	bool finite = true; // whether the motion after the last step is finite
	double lastDt = 0; // length of the last step [s]
	Vector3r gravity = Vector3r::Zero(), pull = Vector3r::Zero(); // pull: gravity in the plane
	typename FrameOf<Space>::Type frame;
	double layer = 0; // where the plane of the disks is along its normal [m]
	int layerId = -1; // the disk from which it was taken
	bool outdated = true; // whether the pairs must be listed anew even if the scene's list is the same
};

// By hand for each space.
#define CD_ENGINE_OF_SPACE(Space)                                                                                                                    \
	template <> void SceneLink<Space>::findFrame(yade::BodyContainer&);                                                                          \
	template <> void SceneLink<Space>::checkMotion(int);                                                                                         \
	template <> void SceneLink<Space>::readOrientation(int);                                                                                     \
	template <> bool SceneLink<Space>::readShape(int, cd::BodyOf<Space>&);                                                                       \
	template <> void SceneLink<Space>::readMotion(int, cd::BodyOf<Space>&, yade::ForceContainer&);                                               \
	template <> std::string SceneLink<Space>::placeOf(const cd::BodyOf<Space>&) const;                                                           \
	template <> void SceneLink<Space>::orient(int);                                                                                              \
	template <> Space::Carried SceneLink<Space>::readForce(std::size_t, bool);                                                                   \
	template <> void SceneLink<Space>::writeVectors(std::size_t, const cd::TouchOf<Space>&) const;                                               \
	template <> void SceneLink<Space>::writePlace(std::size_t) const;                                                                            \
	template <> bool SceneLink<Space>::rotate(std::size_t);                                                                                      \
	template <> void SceneLink<Space>::addForces(yade::ForceContainer&, int, const cd::Account<Space>::Impulse&) const;                          \
	template <> void SceneLink<Space>::setRolling(cd::Sleepers<Space>&);                                                                         \
	template <> cd::TouchOf<Space> SceneLink<Space>::touchAfterStep(std::size_t) const;
CD_ENGINE_OF_SPACE(cd::Plane)
CD_ENGINE_OF_SPACE(cd::Space3)
#undef CD_ENGINE_OF_SPACE

} // namespace cd_engine
