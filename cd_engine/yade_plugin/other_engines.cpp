#include "other_engines.hpp"
#include "kind.hpp"
#include "plate_loads.hpp"
#include "scene_error.hpp"
#include "waiting.hpp"

#include <algorithm>
#include <utility>

namespace cd_engine {
namespace {

	Kind isPeriodic { "PeriodicEngine" };
	enum class Does {
		nothing,
		drives,
		loads,
		moves,
		pushes,
		conflicts
	}; // drives: only sets velocities, by the positions of its bodies; loads: also forces

	const std::string remove = ". Remove it or set its dead=True";
	const std::string servo = " moves walls until springs carry their loads; rigid bodies have no springs" + remove
	    + ", free the walls in the directions of their loads (state.blockedDOFs, state.mass) and load them by cd_engine.PlateLoads";

	// What YADE's engines do to a scene, by the first of these classes that is theirs or a base of theirs. No engine says whether it writes to
	// interactions, and those that do overwrite the forces of rigid contacts. So an engine of any other class conflicts.
	const struct Known {
		Does does;
		std::vector<const char*> classes;
		std::string why {}; // it conflicts, and what to do
	} known[] = {
		// No advice to set this one dead: utils.unbalancedForce() adds its gravity to forces that contain the weights.
		{ Does::conflicts, { "NewtonIntegrator" }, " is also among O.engines and would move the bodies a second time. Remove it" },
		{ Does::conflicts, { "ContactDynamics" }, " is also among O.engines and would move the bodies a second time" + remove },
		{ Does::conflicts, { "InteractionLoop" },
		    " is also among O.engines and would add spring forces to the bodies a second time" + remove },
		{ Does::conflicts, { "ParallelEngine" },
		    " hides the engines in it, some of which may not work with Contact Dynamics. Put them into O.engines, one after the other" },
		{ Does::conflicts, { "TimeStepper" }, " sets O.dt by the stiffness of springs, which rigid bodies do not have" + remove },
		{ Does::conflicts, { "BoundaryController", "ServoPIDController" }, servo },
		{ Does::moves, { "HelixEngine" } },
		{ Does::drives, { "RotationEngine", "TranslationEngine", "HarmonicMotionEngine" } },
		{ Does::loads, { PlateLoads::name } },
		{ Does::moves, { "KinematicEngine", "CombinedKinematicEngine" } },
		{ Does::pushes,
		    { "ForceEngine", "HarmonicForceEngine", "TorqueEngine", "RadialForceEngine", "FieldApplier", "DragEngine", "LinearDragEngine",
			"HydroForceEngine", "HydrodynamicsLawLBM", "FoamCoupling", "FlowEngineT", "FlowEngine_PeriodicInfo", "TwoPhaseFlowEngineT",
			"PartialSatClayEngineT" } },
		{ Does::nothing, // as far as it can be known: PyRunner, a PeriodicEngine, does what the user wants
		    { "PeriodicEngine", "Collider", "BoundDispatcher", "ForceResetter", "SpheresFactory", "StepDisplacer", "TimeAverager",
			"TesselationWrapper", "MicroMacroAnalyser", "FacetTopologyAnalyzer" } },
		{ Does::conflicts, { "Engine" },
		    " may write to contacts, as laws of springs do, and so overwrite the forces of rigid contacts" + remove },
	};

	const Known& find(const std::string& name)
	{
		return *std::find_if(std::begin(known), std::end(known) - 1, [&](const Known& of) {
			return std::any_of(of.classes.begin(), of.classes.end(), [&](const char* base) { return isA(name, base); });
		});
	}

	const std::vector<int>* drivenBy(yade::Engine* engine, Does does)
	{
		return does == Does::drives ? &partial_ids(engine) : does == Does::loads ? &static_cast<PlateLoads*>(engine)->looksAt() : nullptr;
	}

	// Why an engine cannot be used with Contact Dynamics, and what to do; empty if it can. before: it stands before ContactDynamics. reset: a
	// ForceResetter stands before it. weighs: Contact Dynamics adds the weights.
	std::string refusal(const std::string& name, const Known& of, bool before, bool reset, bool weighs)
	{
		if (of.does == Does::conflicts)
			return name + of.why;
		const bool doubled = name == "GravityEngine" && weighs;
		if (of.does == Does::pushes && (!before || !reset))
			return name + " stands " + (before ? "before ForceResetter" : "after ContactDynamics")
			    + " in O.engines, so ForceResetter clears its forces before they act. "
			    + (doubled ? "Remove it, because the attribute `gravity` acts in its place"
				       : "Put it between ForceResetter and ContactDynamics");
		return doubled ? "both GravityEngine and the attribute `gravity` would act on the bodies, so that each would weigh twice" + remove
			+ ", or set gravity=(0, 0, 0)"
			       : "";
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
	integrator = needed = false;
	const Shared<yade::Engine> found = colliderOf(scene);
	for (const auto& engine : engines) {
		const std::string name = engine->getClassName();
		const Known& of = find(name);
		Other other { engine.get(), engine->dead, engine.get() == self || engine == found, before, drivenBy(engine.get(), of.does) };
		needed = needed || isA(name, "SpheresFactory");
		if (engine.get() == self) {
			if (!std::exchange(before, false))
				problem = "it stands twice in O.engines and would move the bodies a second time. Remove one of the two";
		} else if (engine->dead) {
			integrator = integrator || (weighs && name == "NewtonIntegrator");
		} else if (engine != found) {
			other.ignored = name == "ForceResetter";
			resets = resets || (before && other.ignored);
			if (!before && (of.does == Does::drives || of.does == Does::moves))
				late = name;
			if (const std::string reason = refusal(name, of, before, resets, weighs); !reason.empty())
				problem = reason;
		}
		seen.push_back(other);
	}
	if (!resets)
		problem = "there is no ForceResetter before it, so forces would add up over the steps. Use O.engines=cd_engine.engines()";
	if (!problem.empty())
		throw SceneError("ContactDynamics: " + problem);
	wake();
	collider = found;
	others = std::move(seen);
}

void OtherEngines::restCollider(yade::Scene* scene, const std::vector<uint8_t>& still)
{
	if (!awaited() && scene_stopAtIter(scene) <= scene_iter(scene) + 1)
		return wakeAfterRun(still);
	if (!collider || needed)
		return;
	rested = resting ? rested + 1 : 1;
	collider->dead = resting = true;
}

void OtherEngines::wake()
{
	if (collider && resting)
		collider->dead = false;
	resting = false;
}

void OtherEngines::wakeAfterRun(const std::vector<uint8_t>& still)
{
	constexpr long many = 1000, few = 50; // bodies; steps, in which they hardly pass each other, and beside which a sort costs little
	if (resting && rested > few && std::count(still.begin(), still.end(), 0) > many)
		wakeUnsorted();
	wake();
}

void OtherEngines::wakeUnsorted()
{
	wake();
	if (collider && className(collider.get()) == "InsertionSortCollider")
		collider_doSort(collider) = true;
}

bool OtherEngines::observe(yade::Scene* scene) const
{
	const long iteration = scene_iter(scene);
	const double time = scene_time(scene);
	if (changedAt == iteration)
		return true;
	for (const Other& other : others) {
		if (other.ignored || other.drives)
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
		if (other.drives && !other.dead)
			driven.insert(driven.end(), other.drives->begin(), other.drives->end());
	return driven;
}

} // namespace cd_engine
