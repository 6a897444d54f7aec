// Lets the collider rest while no body has moved far enough to matter.
#pragma once

#include "../core/world.hpp"
#include "layout.hpp"

#include <vector>

namespace cd_engine {

// The bounds of disks are larger than the disks by `margin` times their radius, so the pairs found stay complete until the
// displacements since then use the margin up. Until then the collider is dead to YADE's loop; when they have, it is run here,
// at once, before any pair is read. It rests only within O.run(n) and is given back at its last step, so that whoever uses it next,
// perhaps with springs, finds it awake. Which further pairs the list holds changes no result (see sweepKey in read_pairs.cpp).
class ColliderRest {
    public:
	~ColliderRest() { wake(); }

	void attach(boost::shared_ptr<yade::Engine> collider, double margin);
	// To be called with the bodies as they are now, before the pairs are read. reach [m]: gaps up to this matter in the step.
	void refresh(const cd::World&, yade::Scene*, double reach);
	// Gives the collider back to YADE's loop.
	void wake();

    private:
	struct Place {
		double x, y;
		cd::Shape shape;
	};
	bool stillComplete(const cd::World&, double reach) const;

	boost::shared_ptr<yade::Engine> collider;
	double margin = 0;
	bool resting = false;
	std::vector<Place> seen; // the bodies when the collider ran last
};

} // namespace cd_engine
