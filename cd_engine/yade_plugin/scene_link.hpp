// Between YADE's scene graph and the core's world: reads bodies, forces and near pairs, writes motion and contact forces back.
#pragma once

#include "../core/time_step.hpp"
#include "collider_rest.hpp"
#include "layout.hpp"
#include "scene_error.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace cd_engine {

using yade::Vector3r;

// Overlaps kept as touching, sorted by ids: two ids a pair (the smaller first), one overlap [m] a pair.
struct ReferenceOverlaps {
	std::vector<int>& ids;
	std::vector<double>& overlaps;

	double of(int id1, int id2) const; // 0 if the pair has none
};

class SceneLink {
    public:
	cd::World world; // bodies: at their ids (erased ids stand as immobile bodies without pairs)

	// Reads the scene. `impulses`: whether contact forces present become the first guess (times dt). `known`: overlaps of pairs that
	// are new to the list. Runs the collider if it rests and the bodies have moved too far for that.
	void gather(yade::Scene*, const Vector3r& gravity, double dt, bool impulses, const ReferenceOverlaps& known, ColliderRest&, double margin);
	// The same without a trace in the scene: with the pairs present, and only the lasting external forces. For a link of its own.
	void inspectScene(yade::Scene*, const Vector3r& gravity, double dt, bool impulses, const ReferenceOverlaps& known);
	// Makes the overlaps present now the reference ones.
	void takeOverlaps();
	// Writes positions, velocities, interactions and O.forces for impulses over dt. O.forces then holds the total on each body, gravity
	// and contacts included, as YADE's own laws leave it, so that utils.unbalancedForce finds the resultant.
	void scatter(yade::Scene*, double dt);

	void collectOverlaps(const ReferenceOverlaps& into) const;

    private:
	struct KnownBody {
		void *body = nullptr, *shape = nullptr, *material = nullptr; // as last looked at
		char* state = nullptr;
		bool exists = false;
		bool inPlane = false; // takes part in contacts
		bool boundary = false;
		double frictionAngle = 0, friction = 0; // [rad] and its tangent
		cd::ShapeKind kind = cd::ShapeKind::disk;
	};
	struct KnownPair {
		yade::Interaction* interaction;
		int id1, id2;
	};

	void checkScene(yade::Scene*, double dt) const;
	void gatherBodies(yade::Scene*, const Vector3r& gravity);
	void findLayer(yade::BodyContainer&);
	void inspect(int id, void* body);
	void inspectMotion(int id) const;
	void readShape(int id, cd::Body&);
	void readMotion(int id, cd::Body&, yade::ForceContainer&, const Vector3r& gravity) const;
	void setForce(int id, cd::Body&, const Vector3r& force, const Vector3r& torque, const Vector3r& gravity) const;
	void gatherPairs(yade::Scene*, double dt, bool impulses, const ReferenceOverlaps& known);
	bool pairsUnchanged(yade::InteractionContainer*) const;
	void rebuildPairs(yade::InteractionContainer*, const ReferenceOverlaps& known);
	void findForces();
	void readImpulse(std::size_t pair, double dt);
	void makeReal(std::size_t pair, long iteration);
	void makeUnreal(std::size_t pair);
	void writeContact(std::size_t pair, double rate); // rate: 1/dt
	void writeMotion(std::size_t id);

	std::vector<KnownBody> bodies;
	std::vector<KnownPair> listed; // the scene's interactions in its own order, to notice changes
	std::vector<yade::Interaction*> interactions; // of world.pairs
	bool inspecting = false; // the scene is only looked at
	struct Spare {
		boost::shared_ptr<yade::IGeom> geom;
		boost::shared_ptr<yade::IPhys> phys;
	};
	struct Forces {
		void *geom, *phys; // null: none, or not of a class that can hold a contact's force
		bool any; // whether there is any object at all
	};
	std::vector<Forces> forces; // of world.pairs, as found by this step's gather
	std::vector<Spare> spare; // of world.pairs: kept while a contact is unloaded, since making new ones costs more than all else
	Vector3r gravity = Vector3r::Zero();
	double layer = 0; // z of the disks
	void* layerBody = nullptr; // the disk it was taken from
	int layerId = -1;
	std::vector<std::array<double, 3>> total; // scratch: force and torque added to each body
};

} // namespace cd_engine
