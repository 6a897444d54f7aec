#include "contact_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace cd_engine {

namespace py = boost::python;

void ContactDynamics::action()
{
	if (!enginesChecked)
		checkEngines();
	cd::StepSettings settings;
	settings.dt = at<double>(scene, layout.scene_dt);
	settings.restitution = restitution;
	settings.solve = cd::findSolver(method);
	settings.solver = { tolerance, maxIterations, fixedIterations, static_cast<unsigned>(seed) };
	if (!settings.solve)
		throw SceneError("ContactDynamics: there is no method '" + method + "'. See cd_engine.methods()");
	if (gravity[2] != 0)
		throw SceneError("ContactDynamics: gravity has a component out of the plane. Set its z component to 0");

	link.gather(scene, gravity, settings.dt, warmStart, { referenceIds, referenceOverlaps }, rest);
	if (handover) {
		link.takeOverlaps();
		rememberOverlaps();
		handoverOverlap = referenceOverlaps.empty() ? 0 : *std::max_element(referenceOverlaps.begin(), referenceOverlaps.end());
		handover = false;
	}

	const cd::StepReport report = step(link.world, settings);
	if (report.solver.status == cd::Status::diverged)
		throw SceneError("ContactDynamics: the solver met a number that is not finite at step "
		    + std::to_string(at<long>(scene, layout.scene_iter))
		    + "; the scene is as before the step. Look for extreme masses or forces, or take a smaller O.dt");
	link.scatter(scene, settings.dt);
	if (report.overlapsForgotten > 0)
		rememberOverlaps();

	iterations = report.solver.iterations;
	residual = report.solver.residual;
	residualMax = report.solver.residualMax;
	converged = residual <= tolerance;
	status = cd::name(report.solver.status);
	contacts = report.contacts;
	loadedContacts = report.loadedContacts;
	slidingContacts = report.slidingContacts;
	maxPenetration = report.maxPenetration;
	dissipatedEnergy += report.dissipated;
	steps++;
	totalIterations += iterations;
	solveTime += report.solveSeconds;
	if (!converged && fixedIterations == 0) {
		unconvergedSteps++;
		warn();
	}
}

// One line a run; the count goes on in unconvergedSteps and is shown once more when YADE ends (cd_engine/__init__.py).
void ContactDynamics::warn()
{
	if (warned)
		return;
	warned = true;
	std::cerr << "ContactDynamics: step " << at<long>(scene, layout.scene_iter) << " not solved: error " << residual << " after " << iterations
		  << " sweeps, tolerance " << tolerance << " (" << status
		  << "). Further such steps are counted in unconvergedSteps; raise maxIterations or tolerance, or take a smaller O.dt.\n";
}

void ContactDynamics::rememberOverlaps() { link.collectOverlaps({ referenceIds, referenceOverlaps }); }

// The company the engine needs, and the company that would move or push the bodies a second time.
void ContactDynamics::checkEngines()
{
	const PyGILState_STATE gil = PyGILState_Ensure();
	std::string problem;
	try {
		const py::object engines = py::import("yade").attr("O").attr("engines");
		bool resets = false, finds = false;
		for (py::ssize_t i = 0; i < py::len(engines); i++) {
			yade::Engine& engine = py::extract<yade::Engine&>(engines[i]);
			const std::string name = engine.getClassName();
			if (name.find("Collider") != std::string::npos && !finds) {
				// Dead without a margin is somebody's choice; with one it is this engine's own, from before a save.
				finds = !engine.dead || colliderMargin > 0;
				rest.attach(boost::static_pointer_cast<yade::Engine>(engine.shared_from_this()), colliderMargin);
				continue;
			}
			if (&engine == this || engine.dead)
				continue;
			resets = resets || name == "ForceResetter";
			if (name == "NewtonIntegrator" || name == "InteractionLoop" || name == "ContactDynamics")
				problem = name + " is also among O.engines and would " + (name == "InteractionLoop" ? "add spring forces to" : "move")
				    + " the bodies a second time. Remove it or set its dead=True";
		}
		if (!resets)
			problem = "there is no ForceResetter before it, so forces would add up over the steps. Use O.engines=cd_engine.engines()";
		if (!finds)
			problem = "there is no collider before it, so no contact would ever be found. Use O.engines=cd_engine.engines()";
	} catch (const py::error_already_set&) {
		PyErr_Clear();
		problem = "O.engines could not be read";
	}
	PyGILState_Release(gil);
	if (!problem.empty())
		throw SceneError("ContactDynamics: " + problem);
	enginesChecked = true;
}

void ContactDynamics::callPostLoad() { GlobalEngine::callPostLoad(); }

} // namespace cd_engine
