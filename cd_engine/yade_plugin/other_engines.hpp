// The other engines of O.engines: which of them cannot be used with Contact Dynamics, and when one of them looks at the scene.
#pragma once

#include "collider_rest.hpp"

#include <vector>

namespace cd_engine {

// The other engines of the scene. An engine with a period, such as PyRunner, looks at the scene when its period is over, any other in every step.
class OtherEngines {
    public:
	// Checks the list of engines if it has changed since the last check. Passes the collider that it finds to `rest`. Throws SceneError for
	// engines that cannot be used with Contact Dynamics.
	void check(const yade::Engine* self, yade::Scene*, ColliderRest& rest);
	// Whether one of them runs between this step of `self` and the next one, or has run before `self` in this step; what that one has added to
	// O.forces ends with this step.
	bool looks(long iteration) const;

    private:
	struct Other {
		yade::Engine* engine;
		bool dead;
		bool self, ours; // ours: changes only what every step makes anew, or acts only on request
		bool before; // it stands before `self`
	};
	bool changed(const std::vector<boost::shared_ptr<yade::Engine>>&, const yade::Engine* collider) const;

	std::vector<Other> others; // all engines, at the last check
	long changedAt = -1; // iteration of the last check that found a changed list
};

} // namespace cd_engine
