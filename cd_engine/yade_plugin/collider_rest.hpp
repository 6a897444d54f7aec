// Lets the collider rest while no body has moved far enough to matter.
#pragma once

#include "../core/time_step.hpp"
#include "layout.hpp"

#include <vector>

namespace cd_engine {

// The bounds of disks are larger than the disks by `margin` times their radius, so the pairs found stay complete until the
// displacements since then use the margin up. Until then the collider is dead to YADE's loop; when they have, it is run here,
// at once, before any pair is read. It rests only within O.run(n) and is given back at its last step or by a refusal, so that
// whoever uses it next, perhaps with springs, finds it awake. (Not after O.pause() in mid-run, while the
// engine lives.) Which further pairs the list holds changes no result (see sweepKey in read_pairs.cpp).
class ColliderRest {
    public:
	~ColliderRest() { wake(); }

	// bounds: the functor that makes the disks' bounds, whose aabbEnlargeFactor is this class's to set; null: nobody's, nothing is done.
	void attach(boost::shared_ptr<yade::Engine> collider, boost::shared_ptr<yade::Factorable> bounds);
	// To be called with the bodies as they are now, before the pairs are read.
	// listChanged: somebody has changed the list of pairs since the last step.
	// leastMargin: as a fraction of the radius; bodies faster than that allows for get a wider one. dt [s]: of the step.
	// Whether it has run the collider.
	bool refresh(const cd::World&, yade::Scene*, double dt, double leastMargin, bool listChanged);
	const yade::Engine* engine() const { return collider.get(); }
	// Gives the collider back to YADE's loop.
	void wake();

    private:
	struct Place {
		double x, y, radius;
	};
	bool stillComplete(const cd::World&, const cd::Reach&) const;
	bool widen(const cd::Reach&, double leastMargin);

	boost::shared_ptr<yade::Engine> collider;
	boost::shared_ptr<yade::Factorable> bounds;
	double margin = 0;
	bool resting = false;
	std::vector<Place> seen; // the bodies when the collider ran last
	std::vector<cd::Shape> seenShapes; // those of boundaries
};

} // namespace cd_engine
