#include "../bindings/python.hpp"
#include "body_checks.hpp"
#include "contact_dynamics.hpp"
#include "waiting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <tuple>

extern "C" [[gnu::weak]] int omp_get_max_threads(); // of the OpenMP library that YADE's own loops use; null if YADE was built without it

namespace cd_engine {
namespace {

	constexpr const char* noMemory = "ContactDynamics: no memory is left for this step; it has not been made";
	constexpr const char* noMemoryToShow
	    = "ContactDynamics: no memory is left to show this step: the bodies have moved, but the forces of their contacts are lost";

	struct Energy {
		double kinetic = 0; // of all free motions [J]
		double weight = 0; // potential energy of all free bodies in gravity [J], relative to the origin
	};

	template <class Space> Energy energyOf(const cd::WorldOf<Space>& world, const Vector3r& gravity)
	{
		Energy sum;
		for (const cd::BodyOf<Space>& b : world.bodies)
			for (int k = 0; k < Space::freedoms; k++)
				if (b.inverseMass[k] > 0) {
					sum.kinetic += 0.5 * b.v[k] * b.v[k] / b.inverseMass[k];
					sum.weight -= k < Space::components ? gravity[k] * centreOf(b)[k] / b.inverseMass[k] : 0;
				}
		return sum;
	}

	// Writes O.energy, under YADE's names. kinetic replaces the value there; gravWork and plastDissip are added to it. total() then stays the
	// same if neither boundaries nor other forces do work.
	void track(double kinetic, double gravWork, double plastDissip)
	{
		const WithInterpreterLock locked;
		py::object energy = py::import("yade").attr("O").attr("energy");
		const py::dict known(energy.attr("items")());
		energy["kinetic"] = kinetic;
		energy["gravWork"] = known.get("gravWork", 0.) + gravWork;
		energy["plastDissip"] = known.get("plastDissip", 0.) + plastDissip;
	}

	// The same of springs. elastPotential replaces the value there.
	void trackSprings(double elastPotential, double viscDissip, double numDissip)
	{
		const WithInterpreterLock locked;
		py::object energy = py::import("yade").attr("O").attr("energy");
		const py::dict known(energy.attr("items")());
		energy["elastPotential"] = elastPotential;
		energy["viscDissip"] = known.get("viscDissip", 0.) + viscDissip;
		energy["numDissip"] = known.get("numDissip", 0.) + numDissip;
	}

	// The settings which must be those of the last step, so that islands which did not change then do not change now.
	template <class Space> std::array<double, 7> sleepSettings(const cd::StepSettings<Space>& s)
	{
		return { s.dt, s.restitution, s.gapCorrection, s.overlapCorrection, s.allowedOverlap, s.restTolerance, s.dampingRatio };
	}

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
	if (!before || before == this)
		return;
	const WithInterpreterLock locked; // needed to release objects made in Python, if these references are the last
	const std::unique_lock<std::mutex> settled(before->stepping, std::try_to_lock);
	if (!settled)
		return; // it makes a step or publishes one, so it needs its memory
	before->release();
	before->others.wake();
	before->others = OtherEngines();
}

void ContactDynamics::settleLatest()
{
	ContactDynamics* const engine = latest;
	if (!engine)
		return;
	const WithoutInterpreterLock unlocked; // the last step of the run may need it
	const std::lock_guard<std::mutex> lock(engine->stepping);
	engine->onCourse([engine](auto& now) {
		if (now.link.isUnpublished())
			now.link.publish(engine->scene, now.step);
		engine->others.wakeAfterRun(now.link.world.still);
	});
}

void ContactDynamics::action()
{
	std::unique_lock<std::mutex> lock(stepping, std::try_to_lock);
	if (!lock && PyGILState_Check()) {
		const WithoutInterpreterLock unlocked; // the step that runs now may need it
		lock.lock();
	} else if (!lock)
		lock.lock();
	moved = false;
	try {
		takeOver();
		chooseSpace();
		try {
			inSpace ? advance<cd::Space3>() : advance<cd::Plane>();
		} catch (const LeavesPlane& body) {
			takeToSpace(body);
			advance<cd::Space3>();
		}
	} catch (const std::bad_alloc&) { // arrays may be half filled: all but the motion is given up
		onCourse([](auto& now) { now.link.saveMotion(); });
		if (moved) { // YADE does not count a step that ends by an error
			scene_time(scene) += scene_dt(scene);
			scene_iter(scene)++;
		}
		release();
		others.wakeUnsorted();
		const std::string error = moved ? noMemoryToShow : noMemory;
		exchangeError(error);
		scene_forces(scene).sync(); // as below; last, since it may need memory itself
		throw SceneError(error);
	} catch (const std::exception& error) {
		exchangeError(error.what());
		giveUp();
		throw;
	} catch (...) {
		giveUp();
		throw;
	}
}

// After an error in a step: the scene is that of the last step that was made.
void ContactDynamics::giveUp()
{
	onCourse([this](auto& now) { now.link.catchUp(scene, now.step); });
	scene_forces(scene).sync(); // else ForceResetter would leave what other engines have added in this step
	others.wakeUnsorted(); // whoever continues from here must not find a sleeping collider
	last = {};
}

// The memory of a scene.
void ContactDynamics::release()
{
	courseInPlane = {};
	courseInSpace = {};
	last = {};
	idle = false;
}

// A scene is solved in the plane if its bodies keep one. Looks at all bodies only where some have come or gone; else reading them notices.
void ContactDynamics::chooseSpace()
{
	auto& bodies = *scene_bodies(scene);
	const SceneLink<cd::Plane>& link = courseInPlane.link;
	if (inSpace || link.isUnpublished() || link.bodyCount() == bodies.size())
		return;
	bool kept = false; // whether a disk is kept in a plane; a plate that moves along an axis stands in scenes in space, too
	int leaves = -1;
	bool isFacet = false;
	for (int id = 0; id < static_cast<int>(bodies.size()); id++) {
		const Shared<yade::Body>& body = bodies[id];
		if (!body || !body_state(body))
			continue;
		const unsigned blocked = state_blockedDOFs(body_state(body));
		const auto kind = body_shape(body) ? kindOf(body_shape(body).get()) : std::nullopt;
		if (leaves < 0 && (keepsNoPlane(blocked) || kind == cd::ShapeKind::facet)) {
			leaves = id;
			isFacet = kind == cd::ShapeKind::facet;
		}
		kept = kept || (kind == cd::ShapeKind::disk && !keepsNoPlane(blocked) && (blocked & 63) != 63);
	}
	if (leaves < 0)
		return;
	takeToSpace(kept ? LeavesPlane::of(leaves, isFacet) : LeavesPlane {});
}

void ContactDynamics::takeToSpace(const LeavesPlane& body)
{
	if (!body.what.empty())
		courseInPlane.link.warnOnce(body.what + '.', body.remedy);
	courseInPlane = {};
	last = {};
	idle = false;
	const std::lock_guard<std::mutex> lock(attributesLock);
	inSpace = true;
}

cd::StepTolerance ContactDynamics::tolerances() const { return { stiffnessSettings().rigid(), tolerance, flowTolerance }; }

template <class Space> cd::StepSettings<Space> ContactDynamics::settings(yade::Scene* of) const
{
	const std::lock_guard<std::mutex> lock(attributesLock);
	cd::StepSettings<Space> s;
	s.dt = scene_dt(of);
	s.restitution = en.given() ? pairValues().largestRestitution() : restitution;
	(gapVelocity ? s.gapCorrection : s.overlapCorrection) = gapCorrection;
	s.dampingRatio = dampingRatio;
	s.allowedOverlap = allowedOverlap;
	s.warmStart = warmStart && !unbounded; // impulses that have grown without a bound hold nothing
	s.iteration = scene_iter(of);
	s.reduce = reduce;
	s.threads = threads > 0 ? threads : omp_get_max_threads ? omp_get_max_threads() : 1;
	s.solve = cd::findSolver<Space>(method);
	s.solveRolling = cd::findSolver<cd::RollingPlane>(method);
	if (!s.solve)
		throw SceneError("ContactDynamics: the method '" + method + "' solves planar scenes only. In space set method to 'auto'");
	s.restTolerance = tolerances().ofRest();
	s.solver = { tolerances().next(unrest), maxIterations, fixedIterations };
	if (seed > 0) // a different random order in every step, but the same in every repetition of a run
		s.solver.seed = static_cast<unsigned>(seed) * 2654435761u + static_cast<unsigned>(s.iteration) + 1;
	return s;
}

StiffnessSettings ContactDynamics::stiffnessSettings() const { return { materialStiffness, stiffness, tangentialStiffness }; }

// Refuses settings that contradict each other.
StiffnessSettings ContactDynamics::readStiffness() const
{
	const std::lock_guard<std::mutex> lock(attributesLock);
	const StiffnessSettings s = stiffnessSettings();
	const bool finite = std::isfinite(s.kn) || std::isfinite(s.kt);
	if (s.ofMaterials && finite)
		throw SceneError("ContactDynamics: materialStiffness takes the stiffnesses from the materials. Set it to False, or stiffness and "
				 "tangentialStiffness to inf");
	if (s.rigid() && (finite || dampingRatio > 0))
		throw SceneError(
		    text("ContactDynamics: ", finite ? "tangentialStiffness" : "dampingRatio", " needs a stiffness: set stiffness, too"));
	if (!s.rigid() && (restitution > 0 || en.given()))
		throw SceneError("ContactDynamics: contacts with a stiffness rebound by their springs. Set restitution to 0; a dampingRatio of "
				 "-ln(e)/sqrt(pi^2 + ln(e)^2) gives the restitution e");
	if (!s.rigid() && gapCorrection > 0)
		throw SceneError("ContactDynamics: springs need their overlaps. Set gapCorrection to 0, or stiffness to inf");
	return s;
}

PairValues ContactDynamics::pairValues() const { return { en, frictAngle, restitution }; }

PairValues ContactDynamics::readPairValues() const
{
	const std::lock_guard<std::mutex> lock(attributesLock);
	return pairValues();
}

// Gives the step what is saved of rest.
void ContactDynamics::recallRest(cd::Rest& rest)
{
	const std::lock_guard<std::mutex> lock(attributesLock);
	std::tie(rest.steps, rest.trialAt, rest.pause, rest.islands, rest.sleeping, rest.withoutSweep, rest.loadsBefore)
	    = std::tie(steps, restTrialAt, restTrialPause, islands, sleeping, rested, loadsBeforeTrial);
}

// Writes to the scene what others read before the next step.
template <class Space> void ContactDynamics::show()
{
	auto& [link, step] = course<Space>();
	const std::vector<int>& driven = others.drivenBodies();
	const bool ends = scene_stopAtIter(scene) == scene_iter(scene) + 1;
	if (ends || !awaited() || !link.isFinite() || read(&ContactDynamics::publish) == "always" || others.observe(scene)
	    || !link.areBoundaries(driven))
		link.publish(scene, step);
	else
		link.publishMotion(driven);
}

void ContactDynamics::checkEngines()
{
	try {
		others.check(this, Singleton<yade::Omega>::instance().getScene().get(), gravity != Vector3r::Zero());
	} catch (const std::bad_alloc&) {
		throw SceneError(noMemory);
	}
}

template <class Space> void ContactDynamics::advance()
{
	auto& [link, step] = course<Space>();
	const long now = changes(); // first: what Python sets from here on is looked at in the next step, too
	const Vector3r weighs = read(&ContactDynamics::gravity);
	const bool changed = std::exchange(known, now) != now;
	if (idle && !changed && link.isUnpublished() && !checksOrder() && others.drivenBodies().empty())
		return repeatIdleStep<Space>(weighs);
	others.check(this, scene, weighs != Vector3r::Zero());
	cd::StepSettings<Space> settings = this->settings<Space>(scene);
	link.stiffness = readStiffness();
	link.mask = read(&ContactDynamics::mask);
	if (link.setValues(readPairValues()))
		step.sleepers.wakeAll(link.world, { "settings have changed", -1 });
	const std::array<double, 7> keeping = sleepSettings(settings);
	if (keeping != last || settings.solver.fixedIterations > 0 || settings.solver.seed > 0 || !settings.reduce || !warmStart || handover)
		step.sleepers.wakeAll(link.world, { "settings have changed", -1 });
	leaveSprings<Space>();
	last = keeping;
	link.world.apart = others.maskApart();
	others.restCollider(scene, link.world.still);
	link.gather(scene, weighs, settings.dt, memory(), checksOrder(), searchMargin, step, {});
	if (link.world.rolls() && !settings.solveRolling)
		throw SceneError("ContactDynamics: the method newton does not know the rolling resistance of a CohFrictMat. Set method='auto', or "
				 "etaRoll to 0");
	// Impulses are known to their round-off, which is an error of a light body under a heavy one (residual.hpp).
	constexpr double roundOff = 32 * std::numeric_limits<double>::epsilon();
	if (link.world.compliant())
		settings.solver.tolerance = std::max(settings.solver.tolerance, roundOff * link.massRatio());
	const bool takesOver = handover || (link.world.compliant() && !referenceOverlaps.empty());
	if (takesOver)
		takeOverlaps<Space>();
	warnBeforeStep<Space>(settings.dt);

	const bool tracks = scene_trackEnergy(scene);
	const double height = tracks ? energyOf<Space>(link.world, link.toCore(weighs)).weight : 0;
	const cd::StepReport made = solve<Space>(weighs, settings);
	link.finishStep(step, settings.dt);
	moved = true;
	idle = made.idle;
	const double deepestBefore = deepestPenetration, dashpotsBefore = dashpotEnergy, dampedBefore = dampedEnergy;
	report<Space>(made, settings, takesOver);
	if (tracks) {
		const Energy after = energyOf<Space>(link.world, link.toCore(weighs));
		track(after.kinetic, after.weight - height, made.dissipated);
		if (link.world.compliant())
			trackSprings(storedEnergy, dashpotEnergy - dashpotsBefore, dampedEnergy - dampedBefore);
	}
	show<Space>();
	if (!converged && fixedIterations == 0)
		warnOfUnsolved();
	warnOfPenetration<Space>(deepestBefore, takesOver);
}

// A step in which nothing moves, as in the last one.
template <class Space> void ContactDynamics::repeatIdleStep(const Vector3r& weighs)
{
	SceneLink<Space>& link = course<Space>().link;
	{
		const std::lock_guard<std::mutex> lock(attributesLock);
		steps++;
		stepTolerance = tolerances().next(unrest);
		unrest = tolerances().unrest(unrest, {});
	}
	if (scene_trackEnergy(scene))
		track(energyOf<Space>(link.world, link.toCore(weighs)).kinetic, 0, 0);
	show<Space>();
}

// Where this engine has taken over from springs it also takes over from its own: their overlaps then count as touching.
template <class Space> void ContactDynamics::leaveSprings()
{
	constexpr double coarse = 1e-2; // a tolerance that rigid contacts are hardly meant to have
	const std::lock_guard<std::mutex> lock(attributesLock);
	if (isCompliant() || !(storedEnergy > 0))
		return;
	if (tolerance > coarse)
		course<Space>().link.warnOnce(
		    text("tolerance = ", tolerance, " was one for springs, relative to the motion of a step; the contacts are rigid now."),
		    "Set a tolerance relative to their impulses, such as 1e-6, and then, for flows, flowTolerance=1e-4.");
	handover = handover || handoverOverlap > 0;
}

template <class Space> void ContactDynamics::takeOverlaps()
{
	SceneLink<Space>& link = course<Space>().link;
	double largest = 0;
	if (link.world.compliant())
		link.forgetOverlaps();
	else
		largest = link.takeOverlaps(read(&ContactDynamics::storedEnergy) > 0);
	const std::lock_guard<std::mutex> lock(attributesLock);
	link.collectOverlaps(memory().overlaps);
	handoverOverlap = std::max(largest, std::numeric_limits<double>::min()); // not 0: it tells run_hooks.py that this engine takes over
	handover = false;
}

// Makes a step in the core's world. Repeats it with more pairs while bodies outran the list; a repeated step may need more.
template <class Space> cd::StepReport ContactDynamics::solve(const Vector3r& weighs, const cd::StepSettings<Space>& settings)
{
	auto& [link, step] = course<Space>();
	recallRest(step.rest);
	cd::StepReport made = step(link.world, settings);
	for (std::vector<double> needed; !made.outran.empty();) {
		needed.resize(made.outran.size());
		std::transform(needed.begin(), needed.end(), made.outran.begin(), needed.begin(), [](double a, double b) { return std::max(a, b); });
		link.gather(scene, weighs, settings.dt, memory(), false, searchMargin, step, needed);
		made = step(link.world, settings);
	}
	if (made.solver.status == cd::Status::diverged)
		throw SceneError(text("ContactDynamics: the solver met a number that is not finite at step ", scene_iter(scene),
		    "; no body has been moved. Look for disks with the same centre, extreme masses or forces, or take a smaller O.dt"));
	return made;
}

// Copies the report into the attributes.
template <class Space> void ContactDynamics::report(const cd::StepReport& report, const cd::StepSettings<Space>& settings, bool takesOver)
{
	auto& [link, step] = course<Space>();
	const std::lock_guard<std::mutex> lock(attributesLock);
	if (!step.overlapsForgotten().empty())
		memory().overlaps.forget(link.world.pairs, step.overlapsForgotten());

	stepTolerance = settings.solver.tolerance;
	unrest = tolerances().unrest(unrest, report);
	iterations = report.solver.iterations;
	residual = report.solver.residual;
	residualMax = report.solver.residualMax;
	bodyError = report.solver.bodyError;
	worstBody = report.solver.body;
	unsolvableContact.clear();
	unbounded = report.unsolvable[0] >= 0;
	if (unbounded && report.solver.status != cd::Status::converged)
		unsolvableContact.assign(report.unsolvable.begin(), report.unsolvable.end());
	const bool fixed = report.solver.status == cd::Status::fixed_iterations;
	converged = report.solver.status == cd::Status::converged || (fixed && report.solver.error <= stepTolerance);
	status = cd::name(report.solver.status);
	solvedBy = cd::solvedBy(method, report.solver);
	contacts = report.contacts;
	unknowns = report.effort.unknowns;
	islands = report.effort.islands;
	resting = report.effort.resting;
	std::tie(restTrialAt, restTrialPause, rested, loadsBeforeTrial)
	    = std::tie(step.rest.trialAt, step.rest.pause, step.rest.withoutSweep, step.rest.loadsBefore);
	sleeping = report.effort.sleeping;
	if (const cd::Cause& cause = step.sleepers.woken(); cause.what) {
		woken = text("step ", scene_iter(scene), ": ", cause.what, cause.body < 0 ? "" : text(" (body #", cause.body, ")"));
		step.sleepers.forgetWoken();
	}
	loadedContacts = report.loadedContacts;
	slidingContacts = report.slidingContacts;
	maxPenetration = report.maxPenetration;
	deepestPenetration = std::max(deepestPenetration, maxPenetration);
	largestResidual = residual <= largestResidual || std::isnan(largestResidual) ? largestResidual : residual; // a NaN stays
	dissipatedEnergy += report.dissipated;
	dashpotEnergy += report.dashpots;
	// What the springs absorb and do not keep, and what the geometry of a step changes in the energy that they kept.
	dampedEnergy += report.damped + report.absorbed - report.dashpots + (takesOver ? report.storedBefore : storedEnergy) - report.stored;
	storedEnergy = report.stored;
	steps++;
	totalIterations += iterations;
	solveTime += report.solveSeconds;
	if (!converged && fixedIterations == 0)
		unconvergedSteps++;
}

template cd::StepSettings<cd::Plane> ContactDynamics::settings(yade::Scene*) const; // for next_problem.cpp
template cd::StepSettings<cd::Space3> ContactDynamics::settings(yade::Scene*) const;

} // namespace cd_engine
