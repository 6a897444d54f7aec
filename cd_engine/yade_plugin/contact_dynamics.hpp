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

	// Set by the user.
	Vector3r gravity = Vector3r::Zero();
	double tolerance = 1e-6;
	double flowTolerance = 0;
	int maxIterations = 20000;
	int fixedIterations = 0;
	std::string method = "auto";
	bool warmStart = true;
	double restitution = 0;
	double gapCorrection = 0;
	double allowedOverlap = 1e-3;
	int seed = 0;
	bool reduce = true;
	bool handover = true;
	double searchMargin = 0.1;
	std::string publish = "due";
	bool stopUnsolved = false;
	int threads = 0;

	// Results of the last step.
	int iterations = 0;
	double residual = 0;
	double residualMax = 0;
	double bodyError = 0;
	int worstBody = -1;
	std::vector<int> unsolvableContact;
	bool converged = false;
	double stepTolerance = 0;
	std::string status = "no step yet";
	std::string solvedBy = "none";
	int contacts = 0;
	int unknowns = 0;
	int islands = 0;
	int resting = 0;
	int sleeping = 0;
	std::string woken;
	int loadedContacts = 0;
	int slidingContacts = 0;
	double maxPenetration = 0;
	double handoverOverlap = 0;

	// Over all steps.
	double deepestPenetration = 0;
	double largestResidual = 0;

	// The step of the next trial of rest, and the loads in the step before it. Saved, because a trial stops what it finds at rest.
	std::vector<int> loadsBeforeTrial;
	long restTrialAt = 0;
	int restTrialPause = 16;
	bool pressed = false;
	bool rested = false; // cd::StepReport::rested of the last step
	double unrest = 0; // of the last steps: energy dissipated over the sum of W_nn |p|^2; decides between the tolerances

	// Summed over the steps.
	double dissipatedEnergy = 0;
	long steps = 0;
	long unconvergedSteps = 0;
	long totalIterations = 0;
	double solveTime = 0;

	// The reference overlaps, so that they survive O.save.
	std::vector<int> referenceIds;
	std::vector<double> referenceOverlaps;

	// The order of the contacts. Saved, because it decides the last digits of a step.
	std::vector<int> bodyOrder;
	double bodyOrderLength = 0;

	template <class Visitor> static void attributes(Visitor&& visit); // see RegisteredEngine
	static std::string wordFault(const char* attribute, const std::string& value);
	void checkLoaded() const;
	void assigned(const std::string& attribute);

	void action() override;
	// Throws SceneError if it cannot work with the other engines, before one of them runs.
	void checkEngines();
	// Brings the scene up to date, by the engine that has made the last step.
	static void settleLatest();
	// What exportProblem (engine_methods.py) writes: the arguments of core/export.py's write_bodies, or of write_step, as bytes.
	py::tuple nextProblem(bool bodies);

    private:
	void noteUnrest(const cd::StepReport&);
	cd::StepSettings settings(yade::Scene*) const;
	bool somebodyLooks() const;
	void show();
	void takeOver();
	void advance();
	void report(const cd::StepReport&, const cd::StepSettings&);
	void planRestTrial(const cd::Effort&, bool tried);
	bool sleepGoesOn(const cd::StepSettings&) const;
	Memory memory() { return { { referenceIds, referenceOverlaps }, { bodyOrder, bodyOrderLength }, attributesLock }; }
	bool looksAtOrder() const { return steps % 64 == 0; }
	void warn();
	std::string unsolved() const;
	void tellOfLost();
	void tellOfSpeed(double dt);
	void tellOfShortStep(double dt);
	void watchPenetration(double before, bool takesOver) const;

	// The scene from step to step; all of it can be rebuilt. Only the engine that has made the last step keeps it.
	SceneLink link;
	cd::TimeStep step;
	static std::atomic<ContactDynamics*> latest; // the engine that has made the last step
	std::mutex stepping; // held during a step: O.pause() may return while the last step still runs
	OtherEngines others;
	bool warned = false, toldOfLost = false, toldOfSpeed = false, toldOfUnsolvable = false;
	cd::StepSettings last; // settings of the last step
	std::array<double, 2> lastTolerances {}; // `tolerance` and `flowTolerance` in it
	bool idle = false; // the last step changed nothing, nor will the next one unless somebody changes something
	long known = 0; // attributes set before the last step
};

// Where the attributes are.
extern template class RegisteredEngine<ContactDynamics>;

} // namespace cd_engine
