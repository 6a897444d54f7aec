// Exports the problem of the next step to a file: it is assembled here and written by cd_engine/core.
#include "../bindings/python.hpp"
#include "../core/delassus_system.hpp"
#include "contact_dynamics.hpp"

namespace cd_engine {
namespace {

	// Whether a run in the background changes the scene meanwhile. Code that an engine of the run calls (PyRunner) blocks the run, so it is safe.
	// It runs in a thread of YADE's own, which Python's threading module knows only as a dummy.
	bool runsBesides()
	{
		if (!py::extract<bool>(py::import("yade").attr("O").attr("running")))
			return false;
		const py::object threading = py::import("threading");
		const py::object here = threading.attr("current_thread")();
		return PyObject_IsInstance(here.ptr(), py::object(threading.attr("_DummyThread")).ptr()) != 1;
	}

	// Writes the system as it is, without contacts whose bodies cannot move along the normal.
	void writeBodies(const std::string& path, const cd::ContactSystem& system)
	{
		std::vector<double> masses, velocities, normals, arms, bias, mu, impulses;
		std::vector<int32_t> pairs;
		for (const cd::BodyVelocity& b : system.bodies) {
			masses.insert(masses.end(), b.w, b.w + 3);
			velocities.insert(velocities.end(), b.v, b.v + 3);
		}
		for (const int32_t row : cd::solvableRows(system)) {
			const cd::ContactRow& c = system.contacts[row];
			pairs.insert(pairs.end(), { c.a, c.b });
			normals.insert(normals.end(), { c.nx, c.ny });
			arms.insert(arms.end(), { c.an, c.at, c.bn, c.bt });
			bias.push_back(c.bias);
			mu.push_back(c.mu);
			impulses.insert(impulses.end(), { c.pn, c.pt });
		}
		py::import("cd_engine.core.export")
		    .attr("write_bodies")(
			path, bytes(masses), bytes(velocities), bytes(pairs), bytes(normals), bytes(arms), bytes(bias), bytes(mu), bytes(impulses));
	}

} // namespace

void ContactDynamics::exportProblem(const std::string& path, bool bodies)
{
	if (runsBesides())
		throw SceneError(
		    "ContactDynamics.exportProblem: a run goes on and changes the scene meanwhile. Call O.pause() first, or export from an "
		    "engine of the run (PyRunner)");
	std::unique_lock<std::mutex> betweenSteps(stepping, std::defer_lock);
	{
		const WithoutInterpreterLock unlocked; // the step that runs now may need it
		betweenSteps.lock();
	}
	yade::Scene* const now = Singleton<yade::Omega>::instance().getScene().get();
	// Whatever has a memory is a copy here: this engine and the scene do not change.
	const cd::StepSettings settings = this->settings(now);
	std::mutex alone;
	std::vector<int> ids = referenceIds, order = bodyOrder;
	std::vector<double> overlaps = referenceOverlaps;
	double length = bodyOrderLength;
	SceneLink look;
	look.world.apart = others.maskApart();
	look.inspectScene(now, gravity, settings.dt, { { ids, overlaps }, { order, length }, alone }, looksAtOrder());
	if (handover)
		look.takeOverlaps();
	cd::TimeStep next;
	const cd::ContactSystem& system = next.assemble(look.world, settings);
	if (bodies)
		return writeBodies(path, system);
	const cd::DelassusSystem problem = cd::assembleDelassus(system);
	std::vector<int> pairs;
	for (const int32_t row : cd::solvableRows(system)) {
		pairs.insert(pairs.end(), { system.contacts[row].a, system.contacts[row].b });
	}
	const std::vector<int64_t> start(problem.start.begin(), problem.start.end());
	py::import("cd_engine.core.export")
	    .attr("write_step")(path, bytes(start), bytes(problem.column), bytes(problem.blocks), bytes(problem.q), bytes(problem.mu), bytes(pairs));
}

} // namespace cd_engine
