// Keeps the bounds of the bodies as wide as a step needs, and lets the collider rest while no body has moved far enough to matter.
#pragma once

#include "../core/time_step.hpp"
#include "layout.hpp"

#include <vector>

namespace cd_engine {

// Each body has a margin of its own, by which its bounds are larger than it is on every side. So a fast body widens no other's bounds. The pairs found
// stay complete until displacements since then have used a margin up. Until then the collider is dead to YADE's loop; when they have, it is run
// here, at once, before any pair is read. It rests only within O.run(n) and is given back at its last step or by a refusal, so that
// whoever uses it next, perhaps with springs, finds it awake. (Not after O.pause() in mid-run, while the
// engine lives.) Which further pairs the list holds changes no result (see sweepKey in read_pairs.cpp).
//
// YADE's collider makes bounds wider by what each body has moved since they were made before (targetInterv). So it is told, for each body, that it has
// moved by its margin. The factor of Bo1_Sphere_Aabb would not do: every shape keeps the first functor that ever
// bounded it, perhaps one of an earlier collider, whose factor nobody can set any more.
class ColliderRest {
    public:
	~ColliderRest() { wake(); }

	void attach(boost::shared_ptr<yade::Engine> collider);
	// Whether the collider has to run before this step, with the bodies as they are now.
	// listChanged: somebody has changed the list of pairs since the last step.
	// leastMargin: the margin of slow bodies as a fraction of the smallest radius. 0: nothing is done.
	// dt [s]: of the step. outran: StepReport::outran of a step that is made again; else empty. Fills World::listed.
	bool needed(cd::World&, yade::Scene*, double dt, double leastMargin, bool listChanged, const std::vector<double>& outran);
	// Runs it, with the bodies of the scene as they are here. Throws SceneError if a body's bounds stay too narrow, or missing, after it has run.
	void search(cd::World&, yade::Scene*);
	// Lets it rest until the last step of O.run(n), or while somebody waits for the end of the run (waiting.hpp).
	void rest(yade::Scene*);
	// The body that has left all others behind, -1: none.
	int lost(const cd::World&) const;
	const yade::Engine* engine() const { return collider.get(); }
	// Of the fastest body in this step, in radii of the smallest disk.
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
	void measure(const cd::World&, double dt, const std::vector<double>& outran);
	void chooseMargins(const cd::World&);
	double used(const cd::World&, std::size_t body) const;
	bool stillComplete(cd::World&) const;
	int narrowlyBound(const cd::World&, yade::Scene*) const;
	void askFor(yade::Scene*, bool each) const;
	void remember(cd::World&);

	boost::shared_ptr<yade::Engine> collider;
	bool widens = false; // whether the collider takes margins; of another one the bounds are only looked at
	bool works = false; // whether there is a collider, and anything for it to find
	bool resting = false;
	double least = 0; // margin [m]
	double fastest = 0, longest = 0; // way of a body in this step [m], and over the smallest radius
	std::vector<double> ways, needs; // of the bodies in this step, and how far from them pairs have to be listed [m]
	std::vector<std::size_t> quick; // the fastest disks
	std::vector<double> margins; // of the bodies when the collider ran last [m]
	std::vector<Place> seen; // the bodies then
	std::vector<cd::Shape> seenShapes; // those of boundaries
};

} // namespace cd_engine
