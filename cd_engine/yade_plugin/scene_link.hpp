// Between YADE's scene graph and the core's world: reads bodies, forces and near pairs, writes motion and contact forces back.
#pragma once

#include "../core/time_step.hpp"
#include "layout.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace cd_engine {

using yade::Vector3r;

// What a scene asks that the engine cannot do, or a quantity that is no number; the text names the body and the remedy.
class SceneError : public std::runtime_error {
	using std::runtime_error::runtime_error;
};

// Overlap kept as touching, of the pair of ids (first < second).
struct ReferenceOverlap {
	int    id1, id2;
	double overlap; // [m]
};

class SceneLink {
public:
	cd::World world; // bodies: at their ids (erased ids stand as immobile bodies without pairs)

	// Reads the scene. `impulses`: whether contact forces present become the first guess (times dt).
	void gather(yade::Scene*, const Vector3r& gravity, double dt, bool impulses, const std::vector<ReferenceOverlap>& known);
	// Makes the overlaps present now the reference ones.
	void takeOverlaps();
	// Writes positions, velocities, interactions and O.forces for impulses over dt. O.forces then holds the total on each body, gravity
	// and contacts included, as YADE's own laws leave it, so that utils.unbalancedForce finds the resultant.
	void scatter(yade::Scene*, double dt);

	std::vector<ReferenceOverlap> referenceOverlaps() const;

private:
	struct KnownBody {
		void *      body = nullptr, *shape = nullptr, *material = nullptr; // as last looked at
		char*       state    = nullptr;
		bool        exists   = false;
		bool        inPlane  = false; // takes part in contacts
		bool        boundary = false;
		double      frictionAngle = 0, friction = 0; // [rad] and its tangent
		cd::ShapeKind kind   = cd::ShapeKind::disk;
	};
	struct KnownPair {
		yade::Interaction* interaction;
		int                id1, id2;
	};

	void gatherBodies(yade::Scene*, const Vector3r& gravity);
	void findLayer(yade::BodyContainer&);
	void inspect(int id, void* body);
	void inspectMotion(int id) const;
	void readShape(int id, cd::Body&);
	void readMotion(int id, cd::Body&, yade::ForceContainer&, const Vector3r& gravity) const;
	void gatherPairs(yade::Scene*, double dt, bool impulses, const std::vector<ReferenceOverlap>& known);
	bool pairsUnchanged(yade::InteractionContainer*) const;
	void rebuildPairs(yade::InteractionContainer*, const std::vector<ReferenceOverlap>& known);
	void readImpulse(std::size_t pair, double dt);
	void writePair(std::size_t pair, long iteration, double dt);
	void writeMotion(std::size_t id);

	std::vector<KnownBody> bodies;
	std::vector<KnownPair> listed;              // the scene's interactions in its own order, to notice changes
	std::vector<yade::Interaction*> interactions; // of world.pairs
	Vector3r gravity = Vector3r::Zero();
	double   layer   = 0;       // z of the disks
	void*    layerBody = nullptr; // the disk it was taken from
	int      layerId = -1;
	std::vector<std::array<double, 3>> total; // scratch: force and torque added to each body
};

} // namespace cd_engine
