// Assembles the problem of the next step for exportProblem (cd_engine/engine_methods.py).
#include "../bindings/python.hpp"
#include "contact_dynamics.hpp"

namespace cd_engine {
namespace {

	const char* const inSpaceOnly
	    = "ContactDynamics.exportProblem: the scene is solved in space, and only problems in the plane are written. Build the "
	      "problem by cd_engine.core.SpaceBodyProblem";

	// The fields of a BodyProblem, without contacts whose bodies cannot move along the normal.
	py::tuple bodyArrays(const cd::ContactSystem<cd::Plane>& system)
	{
		std::vector<double> masses, velocities, normals, arms, bias, mu, impulses, compliances, slipBias;
		std::vector<int32_t> pairs;
		for (const cd::BodyVelocity<cd::Plane>& b : system.bodies) {
			masses.insert(masses.end(), b.w, b.w + 3);
			velocities.insert(velocities.end(), b.v, b.v + 3);
		}
		for (const cd::ContactRow<cd::Plane>& c : system.contacts) {
			if (!(c.wnn > 0))
				continue;
			pairs.insert(pairs.end(), { c.a, c.b });
			normals.insert(normals.end(), { c.nx, c.ny });
			arms.insert(arms.end(), { c.an, c.at, c.bn, c.bt });
			bias.push_back(c.bias);
			compliances.insert(compliances.end(), { c.cn, c.ct });
			slipBias.push_back(c.slipBias);
			mu.push_back(c.mu);
			impulses.insert(impulses.end(), { c.pn, c.pt });
		}
		return py::make_tuple(bytes(masses), bytes(velocities), bytes(pairs), bytes(normals), bytes(arms), bytes(bias), bytes(mu),
		    bytes(impulses), bytes(compliances), bytes(slipBias));
	}

} // namespace

py::tuple ContactDynamics::nextProblem()
{
	std::unique_lock<std::mutex> betweenSteps(stepping, std::defer_lock);
	{
		const WithoutInterpreterLock unlocked; // the step that runs now may need it
		betweenSteps.lock();
	}
	yade::Scene* const now = Singleton<yade::Omega>::instance().getScene().get();
	// Whatever has a memory is a copy here: this engine and the scene do not change.
	if (inSpace)
		throw SceneError(inSpaceOnly);
	const cd::StepSettings<cd::Plane> settings = this->settings<cd::Plane>(now);
	std::mutex alone;
	std::vector<int> ids = referenceIds, order = bodyOrder;
	std::vector<double> overlaps = referenceOverlaps;
	double length = bodyOrderLength;
	SceneLink<cd::Plane> copy;
	copy.stiffness = stiffnessSettings();
	copy.mask = mask;
	copy.world.apart = OtherEngines::maskOf(OtherEngines::colliderOf(now)); // `others` knows the list of the last step
	copy.setValues(readPairValues());
	try {
		copy.inspectScene(now, gravity, settings.dt, { { ids, overlaps }, { order, length }, alone }, checksOrder());
	} catch (const LeavesPlane&) {
		throw SceneError(inSpaceOnly);
	}
	if (copy.world.rolls())
		throw SceneError(
		    "ContactDynamics: a file cannot hold the rolling resistance of a CohFrictMat. Set etaRoll to 0 to export the problem "
		    "without it");
	if (copy.world.compliant())
		copy.forgetOverlaps();
	else if (handover)
		copy.takeOverlaps(storedEnergy > 0);
	cd::TimeStep<cd::Plane> next;
	return bodyArrays(next.assemble(copy.world, settings));
}

} // namespace cd_engine
