#include "contact_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace cd_engine {
namespace {

	// Of the smallest radius: an overlap beyond it is no error of a time step any more.
	constexpr double deep = 0.01;

	// Steps between two trials of rest, and sweeps in one: about one for each step since the last, less than an island at rest costs while it is
	// awake. Those that come to rest in a thousand sweeps mostly do so in a hundred, and others by chance in the next trial.
	constexpr int shortestPause = 16, longestPause = 2048, fewestTrialSweeps = 64, mostTrialSweeps = 1024;

	// Another random order in every step, the same in every repeat of a run.
	unsigned stepSeed(int seed, long iteration)
	{
		return seed > 0 ? static_cast<unsigned>(seed) * 2654435761u + static_cast<unsigned>(iteration) + 1 : 0;
	}

} // namespace

std::atomic<ContactDynamics*> ContactDynamics::latest { nullptr };

ContactDynamics::~ContactDynamics()
{
	ContactDynamics* self = this;
	latest.compare_exchange_strong(self, nullptr);
}

// YADE never destroys an engine that was in O.engines: its setter takes a reference to each that it does not give back. With every O.reset() and new
// list of engines the memory of a scene would be lost, so an engine gives it back when the next one begins to work.
void ContactDynamics::takeOver()
{
	ContactDynamics* const before = latest.exchange(this);
	if (before && before != this)
		before->forget();
}

void ContactDynamics::forget()
{
	const PyGILState_STATE gil = PyGILState_Ensure(); // the last to hold an object made in Python gives that back, too
	link = SceneLink();
	rest.emplace();
	step = cd::TimeStep();
	checkedEngines = {};
	last.iteration = -1;
	PyGILState_Release(gil);
}

void ContactDynamics::action()
{
	const std::lock_guard<std::mutex> lock(stepping);
	try {
		takeOver();
		advance();
	} catch (...) {
		rest->wake(); // whoever goes on from here must not find a sleeping collider
		last.iteration = -1;
		throw;
	}
}

cd::StepSettings ContactDynamics::settings(yade::Scene* of) const
{
	cd::StepSettings s;
	s.dt = at<double>(of, layout.scene_dt);
	s.restitution = restitution;
	s.gapCorrection = gapCorrection;
	s.reduce = reduce;
	s.trial = steps >= restTrialAt ? std::clamp(restTrialPause, fewestTrialSweeps, mostTrialSweeps) : 0;
	s.loadsBefore = &loadsBeforeTrial;
	s.notesLoads = steps + 1 == restTrialAt;
	s.solve = cd::findSolver(method);
	s.solver = { tolerance, maxIterations, fixedIterations, stepSeed(seed, at<long>(of, layout.scene_iter)) };
	if (!s.solve)
		throw SceneError("ContactDynamics: there is no method '" + method + "'. See cd_engine.methods()");
	if (gravity[2] != 0)
		throw SceneError("ContactDynamics: gravity has a component out of the plane. Set its z component to 0");
	return s;
}

void ContactDynamics::advance()
{
	if (enginesChanged())
		checkEngines();
	const cd::StepSettings settings = this->settings(scene);
	if (!sleepGoesOn(settings))
		step.sleepers.wakeAll(link.world);
	last = { settings, at<long>(scene, layout.scene_iter), at<long>(scene, layout.scene_stopAtIter) };
	link.gather(scene, gravity, settings.dt, warmStart, memory(), looksAtOrder(), *rest, colliderMargin, step.sleepers);
	if (handover) {
		link.takeOverlaps();
		link.collectOverlaps(memory().overlaps);
		handoverOverlap = referenceOverlaps.empty() ? 0 : *std::max_element(referenceOverlaps.begin(), referenceOverlaps.end());
		handover = false;
	}

	const cd::StepReport report = step(link.world, settings);
	if (report.solver.status == cd::Status::diverged)
		throw SceneError("ContactDynamics: the solver met a number that is not finite at step "
		    + std::to_string(at<long>(scene, layout.scene_iter))
		    + "; no body has been moved. Look for disks with one centre, extreme masses or forces, or take a smaller O.dt");
	link.scatter(scene, step, settings.dt);
	if (!step.overlapsForgotten().empty())
		memory().overlaps.forget(link.world.pairs, step.overlapsForgotten());

	iterations = report.solver.iterations;
	residual = report.solver.residual;
	residualMax = report.solver.residualMax;
	bodyError = report.solver.bodyError;
	worstBody = report.solver.body;
	unsolvableContact.clear();
	if (report.unsolvable[0] >= 0)
		unsolvableContact.assign(report.unsolvable.begin(), report.unsolvable.end());
	converged = report.solver.status == cd::Status::converged || (fixedIterations > 0 && report.solver.error <= tolerance);
	status = cd::name(report.solver.status);
	solvedBy = cd::solvedBy(method, report.solver);
	contacts = report.contacts;
	unknowns = report.effort.unknowns;
	islands = report.effort.islands;
	resting = report.effort.resting;
	loadsBeforeTrial.clear();
	if (settings.notesLoads || report.effort.stoppedMoving)
		loadsBeforeTrial = step.loads();
	planRestTrial(report.effort, settings.trial > 0);
	sleeping = report.effort.sleeping;
	loadedContacts = report.loadedContacts;
	slidingContacts = report.slidingContacts;
	maxPenetration = report.maxPenetration;
	if (maxPenetration > deepestPenetration)
		watchPenetration();
	dissipatedEnergy += report.dissipated;
	steps++;
	totalIterations += iterations;
	solveTime += report.solveSeconds;
	if (!converged && fixedIterations == 0) {
		unconvergedSteps++;
		warn();
	}
}

// Whether this step is like the last one, so that what left everything as it was then does so again. Forces are not read while their island sleeps
// on; what somebody has made of them before a run is looked at when it begins, and within a run, or where it goes on after a pause, now and then.
bool ContactDynamics::sleepGoesOn(const cd::StepSettings& now) const
{
	return steps % 256 != 0 && at<long>(scene, layout.scene_iter) == last.iteration + 1 && at<long>(scene, layout.scene_stopAtIter) == last.stop
	    && now.dt == last.settings.dt && now.restitution == last.settings.restitution && now.gapCorrection == last.settings.gapCorrection
	    && now.solver.tolerance == last.settings.solver.tolerance && now.reduce && now.solver.fixedIterations == 0 && now.solver.seed == 0
	    && warmStart && !handover;
}

// A trial that fails is repeated later; what has been woken may soon be at rest again.
void ContactDynamics::planRestTrial(const cd::Effort& effort, bool tried)
{
	const bool woken = effort.sleeping < sleeping;
	if (!tried && !woken)
		return;
	if (woken || (effort.notAtRest == 0 && effort.provenAtRest > 0))
		restTrialPause = shortestPause;
	else if (effort.notAtRest > 0)
		restTrialPause = std::min(2 * restTrialPause, longestPause);
	restTrialAt = steps + (effort.stoppedMoving ? 1 : restTrialPause);
}

// One line a run; the count goes on in unconvergedSteps and is shown once more when YADE ends (cd_engine/__init__.py).
void ContactDynamics::warn()
{
	if (warned)
		return;
	warned = true;
	std::cerr << "ContactDynamics: step " << at<long>(scene, layout.scene_iter) << " is not solved (" << status << " after " << iterations
		  << " iterations): ";
	if (!unsolvableContact.empty())
		std::cerr << "no velocities keep bodies #" << unsolvableContact[0] << " and #" << unsolvableContact[1]
			  << " from overlapping. Look for boundaries that move towards each other with disks between them.";
	else {
		std::cerr << "the contact law is missed by " << residual << " of all impulses";
		if (worstBody >= 0)
			std::cerr << ", and the velocity change of body #" << worstBody << " may be wrong by " << bodyError << " of what acts on it";
		std::cerr << "; the tolerance is " << tolerance << ". Raise maxIterations or tolerance, or take a smaller O.dt.";
	}
	std::cerr << " Further such steps are counted in unconvergedSteps.\n";
}

// One line a run where disks sink into each other: e, relative to all impulses, is small long before a heavy body on a light one is carried,
// fixedIterations ask for no error, and a step may be too long for the ways that bodies turn in it.
void ContactDynamics::watchPenetration()
{
	const double before = deepestPenetration;
	deepestPenetration = maxPenetration;
	const double smallest = cd::reach(link.world, 0).smallestRadius;
	if (deepestPenetration <= deep * smallest || before > deep * smallest)
		return;
	std::cerr << "ContactDynamics: step " << at<long>(scene, layout.scene_iter) << ": two bodies overlap by " << maxPenetration << " m, "
		  << maxPenetration / smallest
		  << " of the smallest radius, and more than when they were taken over. The forces that hold them apart are "
		  << "too small: lower tolerance (heavy bodies on light ones need about the ratio of their masses less), raise maxIterations or "
		  << "fixedIterations, or take a smaller O.dt. deepestPenetration tells how far it goes.\n";
}

// Whether the list of engines is another than at the last check; remembers it. The collider's own rest is no change.
bool ContactDynamics::enginesChanged()
{
	const auto& engines = at<std::vector<boost::shared_ptr<yade::Engine>>>(scene, layout.scene_engines);
	bool changed = engines.size() != checkedEngines.size();
	for (std::size_t i = 0; !changed && i < engines.size(); i++)
		changed = checkedEngines[i].first != engines[i].get()
		    || (checkedEngines[i].second != engines[i]->dead && engines[i].get() != rest->engine());
	if (!changed)
		return false;
	checkedEngines.clear();
	for (const auto& engine : engines)
		checkedEngines.emplace_back(engine.get(), engine->dead);
	return true;
}

// The company the engine needs, and the company that would move or push the bodies a second time.
void ContactDynamics::checkEngines()
{
	std::string problem;
	bool resets = false, finds = false, before = true; // before: the engine at hand stands before this one
	for (const auto& engine : at<std::vector<boost::shared_ptr<yade::Engine>>>(scene, layout.scene_engines)) {
		const std::string name = engine->getClassName();
		if (engine.get() == this)
			before = false;
		if (name.find("Collider") != std::string::npos && before && !finds) {
			// Dead without a margin is somebody's choice; with one it is this engine's own, from before a save.
			finds = !engine->dead || colliderMargin > 0;
			rest->attach(engine);
			continue;
		}
		if (engine.get() == this || engine->dead)
			continue;
		resets = resets || (before && name == "ForceResetter");
		if (name == "NewtonIntegrator" || name == "InteractionLoop" || name == "ContactDynamics")
			problem = name + " is also among O.engines and would " + (name == "InteractionLoop" ? "add spring forces to" : "move")
			    + " the bodies a second time. Remove it or set its dead=True";
	}
	if (!resets)
		problem = "there is no ForceResetter before it, so forces would add up over the steps. Use O.engines=cd_engine.engines()";
	if (!finds)
		problem = "there is no collider before it, so no contact would ever be found. Use O.engines=cd_engine.engines()";
	if (!problem.empty()) {
		checkedEngines.clear(); // asked again at the next step
		throw SceneError("ContactDynamics: " + problem);
	}
}

void ContactDynamics::checkText(const char* attribute, const std::string& value)
{
	if (std::string(attribute) != "method" || cd::findSolver(value))
		return;
	std::string known;
	for (const std::string& m : cd::solverNames())
		known += (known.empty() ? "'" : ", '") + m + "'";
	throw std::invalid_argument("ContactDynamics.method='" + value + "' is not known; there is " + known);
}

} // namespace cd_engine
