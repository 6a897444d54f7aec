#include "other_engines.hpp"
#include "kind.hpp"
#include "scene_error.hpp"
#include "waiting.hpp"

#include <algorithm>
#include <utility>

namespace cd_engine {
namespace {

	Kind isPeriodic { "PeriodicEngine" };

	// Why an engine cannot be used with Contact Dynamics, and what to do; empty if it can. before: it stands before ContactDynamics. reset: a
	// ForceResetter stands before it. weighs: Contact Dynamics adds the weights.
	std::string refusal(const std::string& name, bool before, bool reset, bool weighs)
	{
		const std::string remove = " Remove it or set its dead=True";
		// No advice to set this one dead: utils.unbalancedForce() adds its gravity to forces that contain the weights.
		if (name == "NewtonIntegrator")
			return "NewtonIntegrator is also among O.engines and would move the bodies a second time. Remove it";
		if (name == "InteractionLoop" || name == "ContactDynamics")
			return name + " is also among O.engines and would " + (name == "InteractionLoop" ? "add spring forces to" : "move")
			    + " the bodies a second time." + remove;
		if (isA(name, "ParallelEngine"))
			return name
			    + " hides the engines in it, some of which may not work with Contact Dynamics. Put them into O.engines, one after the "
			      "other";
		if (isA(name, "TimeStepper"))
			return name + " sets O.dt by the stiffness of springs, which rigid bodies do not have." + remove;
		if (isA(name, "BoundaryController") || isA(name, "ServoPIDController"))
			return name + " moves walls until springs carry their loads; rigid bodies have no springs." + remove
			    + ", free the walls in the directions of their loads (state.blockedDOFs, state.mass) and load them by O.forces.setPermF";
		for (const char* const pushing : { "ForceEngine", "HarmonicForceEngine", "TorqueEngine", "RadialForceEngine", "FieldApplier",
			 "DragEngine", "LinearDragEngine", "HydroForceEngine" })
			if ((!before || !reset) && isA(name, pushing))
				return name + " stands " + (before ? "before ForceResetter" : "after ContactDynamics")
				    + " in O.engines, so ForceResetter clears its forces before they act. "
				    + (name == "GravityEngine" && weighs ? "Remove it, because the attribute `gravity` acts in its place"
									 : "Put it between ForceResetter and ContactDynamics");
		if (name == "GravityEngine" && weighs)
			return "both GravityEngine and the attribute `gravity` would act on the bodies, so that each would weigh twice." + remove
			    + ", or set gravity=(0, 0, 0)";
		return "";
	}

	// Whether an engine only sets velocities, by the positions of its bodies.
	bool onlyDrives(const std::string& name)
	{
		return name == "RotationEngine" || name == "TranslationEngine" || name == "HarmonicMotionEngine" || name == "HarmonicRotationEngine";
	}

	// Whether an engine runs, or may run, in the step `iteration`, which begins at `time`. As in YADE's PeriodicEngine::isActivated.
	bool isDue(yade::Engine* engine, long iteration, double time)
	{
		if (!isPeriodic(engine))
			return true;
		const long done = periodic_nDone(engine), most = periodic_nDo(engine), period = periodic_iterPeriod(engine);
		const double span = periodic_virtPeriod(engine);
		if (done == 0 || iteration < periodic_iterLast(engine)) // before its first call the period has not begun to count
			return true;
		return (most < 0 || done < most)
		    && (periodic_realPeriod(engine) > 0 || (span > 0 && time - periodic_virtLast(engine) >= span)
			|| (period > 0 && iteration - periodic_iterLast(engine) >= period));
	}

} // namespace

// If the collider has been switched on or off, the list has not changed.
bool OtherEngines::changed(const std::vector<Shared<yade::Engine>>& engines) const
{
	const auto same = [this](const Shared<yade::Engine>& now, const Other& known) {
		return known.engine == now.get() && (known.dead == now->dead || now == collider);
	};
	return !std::equal(engines.begin(), engines.end(), others.begin(), others.end(), same);
}

Shared<yade::Engine> OtherEngines::colliderOf(yade::Scene* scene)
{
	const auto& engines = scene_engines(scene);
	const auto found = std::find_if(engines.begin(), engines.end(), [](const auto& engine) { return isA(engine->getClassName(), "Collider"); });
	return found == engines.end() ? nullptr : *found;
}

void OtherEngines::check(const yade::Engine* self, yade::Scene* scene, bool weighs)
{
	const auto& engines = scene_engines(scene);
	if (weighs == weighed && !changed(engines))
		return;
	weighed = weighs;
	changedAt = scene_iter(scene);
	others.clear(); // until all is known, so that after an error the next step checks again
	std::vector<Other> seen;
	std::string problem;
	bool resets = false, before = true;
	late.clear();
	integrator = false;
	const Shared<yade::Engine> found = colliderOf(scene);
	for (const auto& engine : engines) {
		const std::string name = engine->getClassName();
		Other other { engine.get(), engine->dead, engine.get() == self, before, onlyDrives(name) };
		if (other.ours) {
			if (!std::exchange(before, false))
				problem = "it stands twice in O.engines and would move the bodies a second time. Remove one of the two";
		} else if (engine == found) {
			other.ours = true;
		} else if (!engine->dead) {
			resets = resets || (before && name == "ForceResetter");
			other.ours = name == "ForceResetter";
			if (!before && isA(name, "KinematicEngine"))
				late = name;
			if (const std::string reason = refusal(name, before, resets, weighs); !reason.empty())
				problem = reason;
		} else
			integrator = integrator || (weighs && name == "NewtonIntegrator");
		seen.push_back(other);
	}
	if (!resets)
		problem = "there is no ForceResetter before it, so forces would add up over the steps. Use O.engines=cd_engine.engines()";
	if (!problem.empty())
		throw SceneError("ContactDynamics: " + problem);
	asked = std::any_of(engines.begin(), engines.end(), [](const auto& engine) { return isA(engine->getClassName(), "SpheresFactory"); });
	wake();
	collider = found;
	others = std::move(seen);
}

void OtherEngines::restCollider(yade::Scene* scene)
{
	if (collider && !asked)
		collider->dead = resting = awaited() || scene_stopAtIter(scene) > scene_iter(scene) + 1;
}

void OtherEngines::wake()
{
	if (collider && resting)
		collider->dead = false;
	resting = false;
}

void OtherEngines::wakeUnsorted()
{
	wake();
	if (collider && className(collider.get()) == "InsertionSortCollider")
		collider_doSort(collider) = true;
}

int32_t OtherEngines::maskApart() const { return maskOf(collider); }

int32_t OtherEngines::maskOf(const Shared<yade::Engine>& collider) { return collider ? collider_avoidSelfInteractionMask(collider) : 0; }

bool OtherEngines::looks(yade::Scene* scene) const
{
	const long iteration = scene_iter(scene);
	const double time = scene_time(scene);
	if (changedAt == iteration)
		return true;
	for (const Other& other : others) {
		if (other.ours || other.drives)
			continue;
		// A periodic engine that has run before may have set itself dead in that step.
		const bool hasRun = other.before && isPeriodic(other.engine) && periodic_iterLast(other.engine) == iteration;
		const int later = other.before ? 1 : 0; // its turn comes in the next step
		if (hasRun || (!other.dead && isDue(other.engine, iteration + later, time + later * scene_dt(scene))))
			return true;
	}
	return false;
}

const std::vector<int>& OtherEngines::drivenBodies()
{
	driven.clear();
	for (const Other& other : others)
		if (other.drives && !other.dead) {
			const std::vector<int>& ids = partial_ids(other.engine);
			driven.insert(driven.end(), ids.begin(), ids.end());
		}
	return driven;
}

} // namespace cd_engine
