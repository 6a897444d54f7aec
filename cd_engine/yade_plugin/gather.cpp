// How a step reads the scene: the bodies, the search for pairs, the pairs.
#include "scene_link.hpp"

#include <cmath>
#include <iostream>

namespace cd_engine {

void SceneLink::tell(const std::string& what, const std::string& remedy)
{
	if (!inspecting && told.insert(what).second)
		std::cerr << "ContactDynamics: " << what << " " << remedy << '\n';
}

void SceneLink::checkScene(yade::Scene* scene, double dt)
{
	if (scene_isPeriodic(scene))
		throw SceneError("ContactDynamics: the scene is periodic, which is not supported. Set O.periodic=False and use walls");
	if (dt == 1e-8)
		tell("O.dt is 1e-8 s, which YADE sets where nobody has.", "Rigid contacts take steps of about 1e-3 s: set O.dt.");
	if (!(dt > 0 && std::isfinite(dt)))
		throw SceneError(text("ContactDynamics: the time step O.dt is ", dt, " s. Set it to a positive number"));
}

void SceneLink::gather(yade::Scene* scene, const Vector3r& g, double dt, const Memory& memory, bool look, double margin, cd::TimeStep& step,
    const std::vector<double>& outran)
{
	checkScene(scene, dt);
	const bool read = !behind;
	if (read) {
		gravity = g;
		gatherBodies(scene);
	}
	bool reordered;
	{
		const std::lock_guard<std::mutex> lock(memory.lock);
		memory.overlaps.forgetBodies(gone);
		reordered = cd::renewOrder(world, memory.order, look);
	}
	gone.clear();
	if (behind && reordered)
		publishScene(scene, step); // the pairs are then read from it in their new order
	const bool searched = search.needed(world, dt, margin, outran, &step.threads);
	if (searched) {
		before.swap(pairs);
		search.find(world, pairs);
	}
	gatherPairs(scene, memory, read, searched, reordered, step.sleepers);
	if (read || searched || reordered)
		setFriction(&step.threads);
}

void SceneLink::inspectScene(yade::Scene* scene, const Vector3r& g, double dt, const Memory& memory, bool look)
{
	namespace py = boost::python;
	inspecting = true;
	checkScene(scene, dt);
	gravity = g;
	gatherBodies(scene);
	// O.forces still holds what the last step left, its contact forces included. A ForceResetter clears it before the next step.
	const py::object lasting = py::import("yade").attr("O").attr("forces");
	const bool any = py::extract<bool>(lasting.attr("getPermForceUsed")());
	for (int id = 0; id < static_cast<int>(world.bodies.size()); id++) {
		cd::Body& body = world.bodies[id];
		if (!bodies[id].exists || !(body.inverseMass[0] > 0 || body.inverseMass[1] > 0 || body.inverseMass[2] > 0))
			continue;
		Vector3r force = Vector3r::Zero(), torque = Vector3r::Zero();
		if (any) { // without permanent forces YADE reads past the end of its list
			force = py::extract<Vector3r>(lasting.attr("permF")(id));
			torque = py::extract<Vector3r>(lasting.attr("permT")(id));
		}
		setForce(id, body, force, torque);
	}
	cd::renewOrder(world, memory.order, look);
	cd::Sleepers none;
	search.needed(world, dt, 0, {});
	search.find(world, pairs);
	gatherPairs(scene, memory, true, true, true, none);
	setFriction(nullptr);
}

} // namespace cd_engine
