// The other engines of O.engines: which of them cannot be used with Contact Dynamics, and when one of them reads the scene.
#pragma once

#include "layout.hpp"

#include <cstdint>
#include <vector>

namespace cd_engine {

// The other engines of the scene. An engine with a period, such as PyRunner, reads the scene when its period is over, any other in every step.
//
// YADE's collider is switched off during a run, since ContactDynamics finds its pairs itself (core/pair_search.hpp): it is dead to YADE's loop during
// O.run(n). It is switched on again at the last step or after a refusal, so that the next user, perhaps with springs, finds it awake. (Not after an
// O.pause() by another engine of the run: then it stays off until the next run ends.)
class OtherEngines {
    public:
	~OtherEngines() { wake(); }

	// Checks the list of engines if it has changed since the last check. Throws SceneError for engines that cannot be used with Contact Dynamics.
	// weighs: it adds the weights itself.
	void check(const yade::Engine* self, yade::Scene*, bool weighs);
	// Whether one of them runs between this step of `self` and the next one, or has run before `self` in this step; what that one has added to
	// O.forces ends with this step.
	// Engines that only set velocities of boundaries, or push them, do not count; `drivenBodies` has them.
	bool observe(yade::Scene*) const;
	// The boundaries whose velocities or forces other engines set in every step, by the boundaries' positions alone.
	const std::vector<int>& drivenBodies();

	// The class of an engine that sets motions but stands after `self`; empty: there is none.
	const std::string& lateDriver() const { return late; }
	bool deadIntegrator() const { return integrator; }

	// Switches the collider off until the last step of O.run(n), or while somebody waits for the end of the run (waiting.hpp). still: by body,
	// whether nothing has moved it.
	void restCollider(yade::Scene*, const std::vector<uint8_t>& still);
	// Switches it on again.
	void wake();
	// The same after steps. Where many bodies have moved, its lists are far from sorted, and its insertion sort takes a time that grows with the
	// square of their number; therefore it sorts them from the beginning.
	void wakeAfterRun(const std::vector<uint8_t>& still);
	// The same after a refusal. The refused scene may have given the collider NaN bounds. They spoil the order of its sorted lists, so that it
	// misses pairs for ever; therefore it sorts them anew.
	void wakeUnsorted();
	// The avoidSelfInteractionMask (cd::World::apart) of the collider at the last check, and of any; 0 without one.
	int32_t maskApart() const { return maskOf(collider); }
	static int32_t maskOf(const Shared<yade::Engine>& collider) { return collider ? collider_avoidSelfInteractionMask(collider) : 0; }
	// The first collider in the scene's list of engines; null: there is none.
	static Shared<yade::Engine> colliderOf(yade::Scene*);

    private:
	struct Other {
		yade::Engine* engine;
		bool dead;
		bool ignored; // `self`, or changes only what every step makes anew, or acts only on request
		bool before; // it stands before `self`
		const std::vector<int>* drives; // the bodies of which it only sets velocities, or on which it only pushes; null: it does more
	};
	bool changed(const std::vector<Shared<yade::Engine>>&) const;

	std::vector<Other> others; // all engines, at the last check
	bool weighed = false; // whether Contact Dynamics added the weights then
	std::string late;
	bool integrator = false; // whether there is a dead NewtonIntegrator
	std::vector<int> driven;
	long changedAt = -1; // iteration of the last check that found a changed list
	Shared<yade::Engine> collider;
	bool needed = false; // whether an engine queries the collider for free space
	bool resting = false; // whether the collider is switched off
	long rested = 0; // steps since then
};

} // namespace cd_engine
