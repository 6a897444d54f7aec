// The other engines of O.engines: which of them do not go with Contact Dynamics, and when one of them looks at the scene.
#pragma once

#include "collider_rest.hpp"

#include <vector>

namespace cd_engine {

// The other engines of the scene. An engine with a period (PyRunner and its like) looks at the scene when that is over; any other in every step.
class OtherEngines {
    public:
	// Looks at the list of engines if it is another one than the last time. Attaches the collider found to `rest`. Throws SceneError for engines
	// that do not go with Contact Dynamics.
	void check(const yade::Engine* self, yade::Scene*, ColliderRest& rest);
	// Whether one of them runs between this step of `self` and the next, or has run before it in this one: what it has added to O.forces then
	// ends with this step.
	bool looks(long iteration) const;

    private:
	struct Other {
		yade::Engine* engine;
		bool dead;
		bool self, ours; // ours: changes nothing that is not made anew in every step, or only when asked to
		bool before; // it stands before `self`
	};
	bool changed(const std::vector<boost::shared_ptr<yade::Engine>>&, const yade::Engine* collider) const;

	std::vector<Other> others; // all engines, at the last check
	long changedAt = -1; // iteration of the last check that found another list
};

} // namespace cd_engine
