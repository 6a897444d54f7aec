// Switches YADE's collider off during a run. This engine finds its pairs itself (core/pair_search.hpp) and does not need the collider.
#pragma once

#include "layout.hpp"

#include <cstdint>

namespace cd_engine {

// The collider is dead to YADE's loop during O.run(n). It is switched on again at the last step or after a refusal, so that the next user, perhaps
// with springs, finds it awake. (Exception: after O.pause() in mid-run, as long as the engine exists.)
class ColliderRest {
    public:
	~ColliderRest() { wake(); }

	void attach(boost::shared_ptr<yade::Engine> collider);
	// Switches the collider off until the last step of O.run(n), or while somebody waits for the end of the run (waiting.hpp).
	void rest(yade::Scene*);
	const yade::Engine* engine() const { return collider.get(); }
	// The collider's avoidSelfInteractionMask (cd::World::apart).
	int32_t maskApart() const;
	// Switches the collider on again.
	void wake();
	// The same after a refusal. The refused scene may have given the collider NaN bounds. They spoil the order of its sorted lists, so that it
	// misses pairs for ever; therefore it sorts them anew.
	void wakeUnsorted();

    private:
	boost::shared_ptr<yade::Engine> collider;
	bool resting = false;
};

} // namespace cd_engine
