// Keeps the bounds of the bodies as wide as a step needs, and lets the collider rest while no body has moved far enough to matter.
#pragma once

#include "../core/alone.hpp"
#include "../core/time_step.hpp"
#include "layout.hpp"

#include <vector>

namespace cd_engine {

// The bounds of all bodies, boundaries too, are `width` larger on every side than the bodies, so the pairs found stay complete until the
// displacements since then use the width up. Until then the collider is dead to YADE's loop; when they have, it is run here,
// at once, before any pair is read. It rests only within O.run(n) and is given back at its last step or by a refusal, so that
// whoever uses it next, perhaps with springs, finds it awake. (Not after O.pause() in mid-run, while the
// engine lives.) Which further pairs the list holds changes no result (see sweepKey in read_pairs.cpp).
//
// The width is the collider's own verletDist. The factor of Bo1_Sphere_Aabb would not do: every shape keeps the first functor that ever
// bounded it, perhaps one of an earlier collider, whose factor nobody can set any more.
class ColliderRest {
    public:
	~ColliderRest() { wake(); }

	void attach(boost::shared_ptr<yade::Engine> collider);
	// Whether the collider has to run before this step, with the bodies as they are now.
	// listChanged: somebody has changed the list of pairs since the last step.
	// leastMargin: the width as a fraction of the smallest radius; bodies faster than that allows for get a wider one. 0: nothing is done.
	// dt [s]: of the step. Marks the bodies that are alone in it.
	bool needed(cd::World&, yade::Scene*, double dt, double leastMargin, bool listChanged);
	// Runs it, with the bodies of the scene as they are here. Throws SceneError if a body's bounds stay too narrow, or missing, after it has run.
	void search(const cd::World&, yade::Scene*);
	// Lets it rest until the last step of O.run(n), or while somebody waits for the end of the run (waiting.hpp).
	void rest(yade::Scene*);
	// The body that has left all others behind, -1: none.
	int lost(const cd::World& world) const { return alone.empty() ? -1 : cd::leftBehind(world, alone); }
	const yade::Engine* engine() const { return collider.get(); }
	// Of a body that is not alone, in this step, in radii of the smallest disk.
	double longestWay() const { return longest; }
	// Gives the collider back to YADE's loop.
	void wake();
	// The same after a refusal: what was refused may have given the collider bounds that are no numbers. These spoil the order of its lists, by
	// which it then misses pairs for ever; so it sorts them anew.
	void wakeUnsorted();

    private:
	struct Place {
		double x, y, radius;
	};
	void findAlone(cd::World&, double dt, double leastMargin);
	bool stillComplete(const cd::World&, const cd::Reach&) const;
	bool widen(const cd::Reach&, double leastMargin);
	int narrowlyBound(const cd::World&, yade::Scene*) const;
	void remember(const cd::World&);

	boost::shared_ptr<yade::Engine> collider;
	bool widens = false; // whether the collider takes a width; of another one the bounds are only looked at
	double longest = 0; // way of a body in this step over the smallest radius
	double width = 0; // of the bounds beyond the bodies [m]
	bool works = false; // whether there is a collider, and anything for it to find
	bool resting = false;
	cd::FastAndAlone fastAndAlone;
	std::vector<int> alone; // the bodies marked so
	std::vector<Place> seen; // the bodies when the collider ran last
	std::vector<cd::Shape> seenShapes; // those of boundaries
};

} // namespace cd_engine
