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
	// What exportProblem (engine_methods.py) writes: the numbers of bodies and contacts, as bytes (core/files/export.py).
	py::tuple nextProblem();

    private:
	// The scene from step to step; all of it can be rebuilt. Only the engine that has made the last step keeps it.
	template <class Space> struct Course {
		SceneLink<Space> link;
		cd::TimeStep<Space> step;
	};
	template <class Space> Course<Space>& course();
	// Calls use(course) with the one in use.
	template <class Use> auto onCourse(const Use& use) { return inSpace ? use(courseInSpace) : use(courseInPlane); }
	void chooseSpace();
	void takeToSpace(const LeavesPlane&);
	cd::StepTolerance tolerances() const;
	template <class Space> cd::StepSettings<Space> settings(yade::Scene*) const;
	StiffnessSettings stiffnessSettings() const;
	PairValues pairValues() const;
	PairValues readPairValues() const;
	void recallRest(cd::Rest&);
	template <class Space> py::tuple nextProblemIn(yade::Scene*) const;
	template <class Space> void show();
	void takeOver();
	void release();
	void giveUp();
	template <class Space> void advance();
	template <class Space> void repeatIdleStep(const Vector3r& weighs);
	template <class Space> void leaveSprings();
	template <class Space> void takeOverlaps();
	template <class Space> cd::StepReport solve(const Vector3r& weighs, const cd::StepSettings<Space>&);
	StiffnessSettings readStiffness() const;
	template <class Space> void report(const cd::StepReport&, const cd::StepSettings<Space>&, bool takesOver);
	Memory memory() { return { { referenceIds, referenceOverlaps }, { bodyOrder, bodyOrderLength }, attributesLock }; }
	bool checksOrder() const { return steps % 64 == 0; }
	template <class... Facts> std::string words(const char* function, const Facts&...);
	template <class Space> void warnBeforeStep(double dt);
	template <class Space> void warnOfLostBody();
	template <class Space> void warnOfSpeed(double dt);
	template <class Space> void warnOfShortStep(double dt);
	void warnOfUnsolved();
	template <class Space> void warnOfPenetration(double before, bool takesOver);

	Course<cd::Plane> courseInPlane;
	Course<cd::Space3> courseInSpace;
	static std::atomic<ContactDynamics*> latest; // the engine that has made the last step
	std::mutex stepping; // held during a step: O.pause() may return while the last step still runs
	OtherEngines others;
	bool warnedOfUnsolved = false, warnedOfLost = false, warnedOfSpeed = false;
	double toldPenetration = -1; // deepest of the steps whose overlaps a warning may tell [m]; negative: of none
	std::array<double, 7> last {}; // the settings of the last step on which sleep depends; a step of 0 s: none
	bool idle = false; // the last step changed nothing, nor will the next one unless somebody changes something
	bool moved = false; // the step under way has moved the bodies
	long known = 0; // attributes set before the last step
};

template <> inline auto ContactDynamics::course<cd::Plane>() -> Course<cd::Plane>& { return courseInPlane; }
template <> inline auto ContactDynamics::course<cd::Space3>() -> Course<cd::Space3>& { return courseInSpace; }

// Where the attributes are.
extern template class RegisteredEngine<ContactDynamics>;

} // namespace cd_engine
