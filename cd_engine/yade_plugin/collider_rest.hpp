// Lets YADE's collider rest during a run. This engine finds its pairs itself (core/pair_search.hpp) and does not need it.
#pragma once

#include "layout.hpp"

#include <cstdint>

namespace cd_engine {

// The collider is dead to YADE's loop within O.run(n). It is given back at the last step or by a refusal, so that whoever uses it next, perhaps with
// springs, finds it awake. (Not after O.pause() in mid-run, while the engine lives.)
class ColliderRest {
    public:
	~ColliderRest() { wake(); }

	void attach(boost::shared_ptr<yade::Engine> collider);
	// Lets it rest until the last step of O.run(n), or while somebody waits for the end of the run (waiting.hpp).
	void rest(yade::Scene*);
	const yade::Engine* engine() const { return collider.get(); }
	// Its avoidSelfInteractionMask (cd::World::apart).
	int32_t maskApart() const;
	// Gives the collider back to YADE's loop.
	void wake();
	// The same after a refusal: what was refused may have given the collider bounds that are no numbers. These spoil the order of its lists, by
	// which it then misses pairs for ever; so it sorts them anew.
	void wakeUnsorted();

    private:
	boost::shared_ptr<yade::Engine> collider;
	bool resting = false;
};

} // namespace cd_engine
