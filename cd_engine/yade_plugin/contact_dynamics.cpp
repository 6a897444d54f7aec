#include "contact_dynamics.hpp"
#include "energy.hpp"
#include "waiting.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

extern "C" [[gnu::weak]] int omp_get_max_threads(); // of the OpenMP library that YADE's own loops use; null if YADE was built without it

namespace cd_engine {
namespace {

	// Share of the smallest radius from which an overlap is no longer just an error of a time step.
	constexpr double deep = 0.01;
	constexpr double loose = 1e-3; // tolerance above which pushing out the overlaps that it leaves would stir a packing
	constexpr double far = 4; // radii that a disk may move in a step without a warning

	// Steps between two trials of rest, and sweeps in one trial: about one sweep a step since the last trial. This costs less than an island at
	// rest that stays awake. Islands that come to rest in a thousand sweeps mostly do so in a hundred, the others by chance in a later trial.
	constexpr int shortestPause = 16, longestPause = 2048, fewestTrialSweeps = 64, mostTrialSweeps = 1024;

	// A different random order in every step, but the same in every repetition of a run.
	unsigned stepSeed(int seed, long iteration)
	{
		return seed > 0 ? static_cast<unsigned>(seed) * 2654435761u + static_cast<unsigned>(iteration) + 1 : 0;
	}

	int threadsOfYade() { return omp_get_max_threads ? omp_get_max_threads() : 1; }

} // namespace

std::atomic<ContactDynamics*> ContactDynamics::latest { nullptr };

ContactDynamics::~ContactDynamics()
{
	ContactDynamics* self = this;
	latest.compare_exchange_strong(self, nullptr);
}

// YADE never destroys an engine that was in O.engines: the setter takes a reference to each and never releases it. Every O.reset() with a new list of
// engines would leak the memory of a scene. Therefore an engine releases its memory when the next engine begins to work.
void ContactDynamics::takeOver()
{
	ContactDynamics* const before = latest.exchange(this);
	if (before && before != this)
		before->forget();
}

void ContactDynamics::forget()
{
	const PyGILState_STATE gil = PyGILState_Ensure(); // needed to release objects made in Python, if these references are the last
	link = SceneLink();
	rest.emplace();
	step = cd::TimeStep();
	others = OtherEngines();
	last = {};
	idle = false;
	PyGILState_Release(gil);
}

// Updates the scene when the code that waited for a run continues.
void ContactDynamics::settle()
{
	PyThreadState* const gil = PyEval_SaveThread(); // the last step of the run may need the Python lock
	{
		const std::lock_guard<std::mutex> lock(stepping);
		if (link.ahead())
			link.publish(scene, step);
		rest->wake();
	}
	PyEval_RestoreThread(gil);
}

void ContactDynamics::settleLatest()
{
	if (ContactDynamics* const engine = latest)
		engine->settle();
}

void ContactDynamics::action()
{
	const std::lock_guard<std::mutex> lock(stepping);
	try {
		takeOver();
		advance();
	} catch (...) {
		link.catchUp(scene, step);
		rest->wakeUnsorted(); // whoever continues from here must not find a sleeping collider
		last = {};
		try {
			throw;
		} catch (const std::exception& error) {
			keepError(error.what());
			throw;
		}
	}
}

cd::StepSettings ContactDynamics::settings(yade::Scene* of) const
{
	cd::StepSettings s;
	s.dt = at<double>(of, layout.scene_dt);
	s.restitution = restitution;
	s.gapCorrection = gapCorrection;
	s.allowedOverlap = allowedOverlap;
	s.warmStart = warmStart;
	s.iteration = at<long>(of, layout.scene_iter);
	s.reduce = reduce;
	s.threads = threads > 0 ? threads : threadsOfYade();
	const bool awake = sleeping < islands; // else there is nothing to try
	s.trial = awake && steps >= restTrialAt ? std::clamp(restTrialPause, fewestTrialSweeps, mostTrialSweeps) : 0;
	s.loadsBefore = &loadsBeforeTrial;
	s.notesLoads = awake && steps + 1 == restTrialAt;
	const std::string name = read(&ContactDynamics::method);
	s.solve = cd::findSolver(name);
	s.solver = { tolerance, maxIterations, fixedIterations, stepSeed(seed, at<long>(of, layout.scene_iter)) };
	s.solver.guessSolved = converged || steps == 0;
	s.solver.guessPressed = pressed;
	if (!s.solve)
		throw SceneError("ContactDynamics: there is no method '" + name + "'. See cd_engine.methods()");
	if (gravity[2] != 0)
		throw SceneError("ContactDynamics: gravity has a component out of the plane. Set its z component to 0");
	return s;
}

bool ContactDynamics::somebodyLooks() const
{
	const long iteration = at<long>(scene, layout.scene_iter);
	const bool ends = at<long>(scene, layout.scene_stopAtIter) == iteration + 1;
	return ends || !awaited() || !link.finite() || read(&ContactDynamics::publish) == "always" || others.looks(iteration);
}

void ContactDynamics::advance()
{
	if (idle && link.ahead() && !looksAtOrder()) {
		{
			const std::lock_guard<std::mutex> lock(attributesLock);
			steps++;
		}
		if (tracksEnergy(scene))
			track(kineticEnergy(link.world), 0, 0);
		if (somebodyLooks())
			link.publish(scene, step);
		return;
	}
	others.check(this, scene, *rest);
	const cd::StepSettings settings = this->settings(scene);
	if (!sleepGoesOn(settings))
		step.sleepers.wakeAll(link.world);
	last = settings;
	link.world.apart = rest->maskApart();
	rest->rest(scene);
	link.gather(scene, gravity, settings.dt, memory(), looksAtOrder(), searchMargin, step, {});
	if (handover) {
		link.takeOverlaps();
		const std::lock_guard<std::mutex> lock(attributesLock);
		link.collectOverlaps(memory().overlaps);
		handoverOverlap = referenceOverlaps.empty() ? 0 : *std::max_element(referenceOverlaps.begin(), referenceOverlaps.end());
		handover = false;
	}

	tellOfLost();
	tellOfSpeed(settings.dt);
	if (restitution > 0 && gapCorrection > 0)
		link.tell("restitution and gapCorrection together make energy: the velocity that pushes an overlap out bounces on.",
		    "Set one of them to 0, and take a smaller O.dt against overlaps.");
	const bool tracks = tracksEnergy(scene);
	const double height = tracks ? weightEnergy(link.world, gravity) : 0;
	cd::StepReport made = step(link.world, settings);
	for (std::vector<double> needed; !made.outran.empty();) { // a repeated step may need more
		needed.resize(made.outran.size());
		std::transform(needed.begin(), needed.end(), made.outran.begin(), needed.begin(), [](double a, double b) { return std::max(a, b); });
		link.gather(scene, gravity, settings.dt, memory(), false, searchMargin, step, needed);
		made = step(link.world, settings);
	}
	if (made.solver.status == cd::Status::diverged)
		throw SceneError("ContactDynamics: the solver met a number that is not finite at step "
		    + std::to_string(at<long>(scene, layout.scene_iter))
		    + "; no body has been moved. Look for disks with one centre, extreme masses or forces, or take a smaller O.dt");
	link.hold(step, settings.dt);
	idle = made.idle;
	if (tracks)
		track(kineticEnergy(link.world), weightEnergy(link.world, gravity) - height, made.dissipated);
	if (somebodyLooks())
		link.publish(scene, step);
	const double before = deepestPenetration;
	report(made, settings);
	if (!converged && fixedIterations == 0)
		warn();
	if (deepestPenetration > before)
		watchPenetration(before);
}

// Copies the report into the attributes.
void ContactDynamics::report(const cd::StepReport& report, const cd::StepSettings& settings)
{
	const std::lock_guard<std::mutex> lock(attributesLock);
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
	const bool fixed = report.solver.status == cd::Status::fixed_iterations;
	converged = report.solver.status == cd::Status::converged || (fixed && !report.solver.doubtful && report.solver.error <= tolerance);
	status = cd::name(report.solver.status);
	pressed = !converged && (pressed || !unsolvableContact.empty());
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
	if (const cd::Cause& cause = step.sleepers.woken(); cause.what) {
		woken = "step " + std::to_string(at<long>(scene, layout.scene_iter)) + ": " + cause.what
		    + (cause.body >= 0 ? " (body #" + std::to_string(cause.body) + ")" : "");
		step.sleepers.forgetWoken();
	}
	loadedContacts = report.loadedContacts;
	slidingContacts = report.slidingContacts;
	maxPenetration = report.maxPenetration;
	deepestPenetration = std::max(deepestPenetration, maxPenetration);
	dissipatedEnergy += report.dissipated;
	steps++;
	totalIterations += iterations;
	solveTime += report.solveSeconds;
	if (!converged && fixedIterations == 0)
		unconvergedSteps++;
}

// Whether this step has the settings of the last one, so that what left everything as it was then does so again.
bool ContactDynamics::sleepGoesOn(const cd::StepSettings& now) const
{
	return now.dt == last.dt && now.restitution == last.restitution && now.gapCorrection == last.gapCorrection
	    && now.allowedOverlap == last.allowedOverlap && now.solver.tolerance == last.solver.tolerance && now.reduce
	    && now.solver.fixedIterations == 0 && now.solver.seed == 0 && warmStart && !handover;
}

// After a failed trial, the next one comes later. After islands have been woken, it comes soon, because they may soon be at rest again.
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

// Describes why a step is not solved, and what to do.
std::string ContactDynamics::unsolved() const
{
	std::ostringstream s;
	s << "ContactDynamics: step " << at<long>(scene, layout.scene_iter) << " is not solved (" << status << " after " << iterations
	  << " iterations): ";
	if (!unsolvableContact.empty())
		s << "no velocities keep bodies #" << unsolvableContact[0] << " and #" << unsolvableContact[1]
		  << " from overlapping. Look for boundaries that move towards each other with disks between them; what follows this step is not to "
		     "be trusted.";
	else {
		s << "the contact law is missed by " << residual << " of all impulses";
		if (worstBody >= 0)
			s << ", and the velocity change of body #" << worstBody << " may be wrong by " << bodyError << " of what acts on it";
		s << "; the tolerance is " << tolerance << ". "
		  << (status == "stagnated" ? "More iterations do not help: raise tolerance" : "Raise maxIterations or tolerance")
		  << ", or take a smaller O.dt.";
	}
	return s.str();
}

// Prints one line a run. unconvergedSteps counts on and is shown once more when YADE ends (cd_engine/__init__.py).
void ContactDynamics::warn()
{
	if (stopUnsolved) {
		if (link.ahead())
			link.publish(scene, step);
		throw SceneError(unsolved() + " (stopUnsolved is set; the step has been made)");
	}
	if (warned)
		return;
	warned = true;
	toldOfUnsolvable = !unsolvableContact.empty();
	std::cerr << unsolved() << " Further such steps are counted in unconvergedSteps.\n";
}

// Prints one line a run, for the first body that leaves the scene.
void ContactDynamics::tellOfLost()
{
	const int id = toldOfLost ? -1 : link.pairSearch().lost(link.world);
	if (id < 0)
		return;
	toldOfLost = true;
	const cd::Body& body = link.world.bodies[id];
	std::cerr << "ContactDynamics: step " << at<long>(scene, layout.scene_iter) << ": body #" << id
		  << " has left all others far behind: it is at (" << body.x << ", " << body.y << ") m, at " << std::hypot(body.v[0], body.v[1])
		  << " m/s. Erase it (O.bodies.erase(" << id << ")) or give the scene a boundary that holds it. Others that do so are not named.\n";
}

// Prints one line a run if a disk with neighbours moves so far in a step that it may jump over a body that it would have met.
void ContactDynamics::tellOfSpeed(double dt)
{
	if (toldOfSpeed || !(link.pairSearch().longestWay() > far))
		return;
	const auto& bodies = link.world.bodies;
	const auto tooFar = [&](const cd::Body& b) { return b.radius > 0 && dt * std::hypot(b.v[0], b.v[1]) > far * b.radius; };
	const auto meets = [&](const cd::Pair& pair) { return tooFar(bodies[pair.a]) || tooFar(bodies[pair.b]); };
	const auto near = std::find_if(link.world.pairs.begin(), link.world.pairs.end(), meets);
	if (near == link.world.pairs.end())
		return;
	const auto fast = bodies.begin() + (tooFar(bodies[near->a]) ? near->a : near->b);
	toldOfSpeed = true;
	std::cerr << "ContactDynamics: step " << at<long>(scene, layout.scene_iter) << ": body #" << fast - bodies.begin() << " moves "
		  << dt * std::hypot(fast->v[0], fast->v[1]) / fast->radius << " of its radii in a step, which is rough. O.dt is " << dt
		  << " s; cd_engine.timeStep() proposes one. Others that do so are not named.\n";
}

// Prints one line a run if disks sink into each other. Reasons: e, relative to all impulses, is small long before a heavy body on a light one is
// carried; fixedIterations demand no error; small errors add up; and a step may be too long for the speed or rotation of the bodies.
void ContactDynamics::watchPenetration(double before) const
{
	const double smallest = cd::smallestRadius(link.world);
	if (deepestPenetration <= deep * smallest || before > deep * smallest || toldOfUnsolvable || link.boundariesPlaced())
		return; // an unsolvable step, or a boundary that is moved by its position, has its own warning
	const cd::Pair& deepest = link.deepest(step);
	std::string remedy;
	const bool atOnce = maxPenetration - before > 0.5 * deep * smallest, misses = !converged || fixedIterations > 0;
	const double way = 2 * link.pairSearch().longestWay() * smallest; // that two bodies can approach each other in the step
	if (atOnce && maxPenetration - before > way && link.isBehind(deepest))
		remedy = "No speed explains it: " + link.tellBehind(deepest);
	else if (atOnce && maxPenetration - before > way)
		remedy = std::string("No speed explains it: bodies were put there, moved, turned or resized, or have overlapped from the start "
				     "(handover=False). Move them apart")
		    + (gapCorrection == 0 && maxPenetration < smallest ? ", or set gapCorrection=0.1, which pushes overlaps out" : "");
	else if (atOnce && restitution > 0)
		remedy
		    = "It came in this one step: with restitution a contact that others close bounces in the next step only, and overlaps by up to "
		      "its speed times O.dt until then. Take a smaller O.dt";
	else if (atOnce && misses)
		remedy = "It came in this one step, which is not solved, or too long for the speed of the bodies: take a smaller O.dt "
			 "(cd_engine.timeStep() proposes one), or raise maxIterations or fixedIterations";
	else if (atOnce)
		remedy = "It came in this one step, which is too long for the speed of the bodies: take a smaller O.dt (cd_engine.timeStep() "
			 "proposes one)";
	else if (misses)
		remedy = "The forces that hold them apart are too small: raise maxIterations or fixedIterations";
	else if (tolerance > loose)
		remedy = "It grew step by step by what the tolerance leaves: lower it to 1e-4 or less";
	else if (gapCorrection == 0)
		remedy = "It grew step by step by what the tolerance leaves, or where a boundary changes its velocity: set gapCorrection=0.1, which "
			 "pushes overlaps out; heavy bodies on light ones need a tolerance smaller by about the ratio of their masses";
	else
		remedy
		    = "It grew step by step by more than gapCorrection pushes out: lower tolerance (heavy bodies on light ones need about the ratio "
		      "of their masses less) or take a smaller O.dt";
	std::cerr << "ContactDynamics: step " << at<long>(scene, layout.scene_iter) << ": bodies #" << deepest.a << " and #" << deepest.b
		  << " overlap by " << maxPenetration << " m, " << maxPenetration / smallest
		  << " of the smallest radius, and more than when they were taken over. " << remedy
		  << ". deepestPenetration tells how far it goes.\n";
}

// Checks loaded lists that steps use unchecked. bodyOrder is not checked: it is only a hint, and is made anew if it is invalid.
void ContactDynamics::checkLoaded() const
{
	const std::string damaged = "ContactDynamics: the file is damaged: ";
	const std::string remedy = " Load another one, or empty both lists in it, which makes the overlaps present now count as such";
	const std::size_t pairs = referenceOverlaps.size();
	if (referenceIds.size() != 2 * pairs)
		throw SceneError(damaged + "it has " + std::to_string(referenceIds.size()) + " referenceIds for " + std::to_string(pairs)
		    + " referenceOverlaps, not two for each." + remedy);
	for (std::size_t i = 0; i < pairs; i++) {
		const int *const now = &referenceIds[2 * i], *const before = i > 0 ? now - 2 : nullptr;
		const std::string pair = "of bodies #" + std::to_string(now[0]) + " and #" + std::to_string(now[1]);
		if (now[0] < 0 || now[0] >= now[1] || (before && !(std::make_pair(before[0], before[1]) < std::make_pair(now[0], now[1]))))
			throw SceneError(damaged + "the referenceIds " + pair + " are negative or not in order, the smaller first." + remedy);
		if (!(referenceOverlaps[i] > 0 && std::isfinite(referenceOverlaps[i])))
			throw SceneError(damaged + "the referenceOverlaps " + pair + " are " + std::to_string(referenceOverlaps[i]) + " m." + remedy);
	}
}

void ContactDynamics::summary(const boost::python::object& self)
{
	namespace py = boost::python;
	py::import("builtins").attr("print")(py::import("cd_engine.summary").attr("text")(self));
}

void ContactDynamics::checkText(const char* attribute, const std::string& value)
{
	if (std::string(attribute) == "publish" && value != "always" && value != "due")
		throw std::invalid_argument("ContactDynamics.publish='" + value + "' is not known; there is 'always' and 'due'");
	if (std::string(attribute) != "method" || cd::findSolver(value))
		return;
	std::string known;
	for (const std::string& m : cd::solverNames())
		known += (known.empty() ? "'" : ", '") + m + "'";
	throw std::invalid_argument("ContactDynamics.method='" + value + "' is not known; there is " + known);
}

} // namespace cd_engine
