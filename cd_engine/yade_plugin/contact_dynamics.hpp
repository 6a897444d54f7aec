// The engine that YADE sees.
#pragma once

#include "other_engines.hpp"
#include "registered_engine.hpp"
#include "scene_link.hpp"

#include <array>
#include <atomic>
#include <mutex>

namespace cd_engine {

class ContactDynamics : public RegisteredEngine<ContactDynamics> {
    public:
	static constexpr const char* name = "ContactDynamics";
	static const char* const documentation;

	~ContactDynamics() override;

#define CD_ATTRIBUTE(type, name, initial, ...) type name = initial;
#include "attributes.inl"
#undef CD_ATTRIBUTE

	template <class Visitor> static void attributes(Visitor&& visit); // see RegisteredEngine
	static std::string wordFault(const char* attribute, const std::string& value);
	void checkLoaded() const;
	void assigned(const std::string& attribute);

	// Whether its contacts have a stiffness.
	bool isCompliant() const { return !stiffnessSettings().rigid(); }

	void action() override;
	// Throws SceneError if it cannot work with the other engines, before one of them runs.
	void checkEngines();
	// Brings the scene up to date, by the engine that has made the last step.
	static void settleLatest();
	// What exportProblem (engine_methods.py) writes: the fields of a BodyProblem in their order, as bytes.
	py::tuple nextProblem();

    private:
	double nextTolerance() const;
	void noteUnrest(const cd::StepReport&);
	cd::StepSettings<cd::Plane> settings(yade::Scene*) const;
	StiffnessSettings stiffnessSettings() const;
	double leastTolerance() const;
	PairValues pairValues() const;
	PairValues readPairValues() const;
	void recallRest();
	void show();
	void takeOver();
	void release();
	void giveUp();
	void advance();
	void repeatIdleStep(const Vector3r& weighs);
	void leaveSprings();
	void takeOverlaps();
	cd::StepReport solve(const Vector3r& weighs, const cd::StepSettings<cd::Plane>&);
	StiffnessSettings readStiffness() const;
	void report(const cd::StepReport&, const cd::StepSettings<cd::Plane>&, bool takesOver);
	bool sleepGoesOn(const cd::StepSettings<cd::Plane>&) const;
	Memory memory() { return { { referenceIds, referenceOverlaps }, { bodyOrder, bodyOrderLength }, attributesLock }; }
	bool checksOrder() const { return steps % 64 == 0; }
	template <class... Facts> std::string words(const char* function, const Facts&...);
	void warnBeforeStep(double dt);
	void warnOfLostBody();
	void warnOfSpeed(double dt);
	void warnOfShortStep(double dt);
	void warnOfUnsolved();
	void warnOfPenetration(double before, bool takesOver);

	// The scene from step to step; all of it can be rebuilt. Only the engine that has made the last step keeps it.
	SceneLink link;
	cd::TimeStep<cd::Plane> step;
	static std::atomic<ContactDynamics*> latest; // the engine that has made the last step
	std::mutex stepping; // held during a step: O.pause() may return while the last step still runs
	OtherEngines others;
	bool warnedOfUnsolved = false, warnedOfUnsolvable = false, warnedOfLost = false, warnedOfSpeed = false;
	cd::StepSettings<cd::Plane> last; // settings of the last step
	bool idle = false; // the last step changed nothing, nor will the next one unless somebody changes something
	bool moved = false; // the step under way has moved the bodies
	long known = 0; // attributes set before the last step
};

// Where the attributes are.
extern template class RegisteredEngine<ContactDynamics>;

} // namespace cd_engine
