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
	inspecting = true;
	checkScene(scene, dt);
	gravity = g;
	gatherBodies(scene);
	cd::renewOrder(world, memory.order, look);
	cd::Sleepers none;
	search.needed(world, dt, 0, {});
	search.find(world, pairs);
	gatherPairs(scene, memory, true, true, true, none);
	setFriction(nullptr);
}

} // namespace cd_engine
