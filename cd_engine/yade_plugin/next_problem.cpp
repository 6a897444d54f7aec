// Assembles the problem of the next step for exportProblem (cd_engine/engine_methods.py).
#include "../bindings/python.hpp"
#include "contact_dynamics.hpp"

namespace cd_engine {
namespace {

	// The numbers of the contacts of a problem, as its row has them.
	struct Contacts {
		std::vector<int32_t> pairs;
		std::vector<double> normals, arms, bias, mu, impulses, compliances, slipBias;

		void add(const cd::ContactRow<cd::Plane>& c)
		{
			normals.insert(normals.end(), { c.nx, c.ny });
			arms.insert(arms.end(), { c.an, c.at, c.bn, c.bt });
			impulses.insert(impulses.end(), { c.pn, c.pt });
			slipBias.push_back(c.slipBias);
		}
		void add(const cd::ContactRow<cd::Space3>& c)
		{
			normals.insert(normals.end(), { c.nx, c.ny, c.nz });
			arms.insert(arms.end(), { c.at, c.bt });
			impulses.insert(impulses.end(), { c.pn, c.px, c.py, c.pz });
			slipBias.insert(slipBias.end(), { c.slipX, c.slipY, c.slipZ });
		}
	};

	// The numbers of a problem, without contacts whose bodies cannot move along the normal.
	template <class Space> py::tuple bodyArrays(const cd::ContactSystem<Space>& system)
	{
		std::vector<double> masses, velocities;
		for (const cd::BodyVelocity<Space>& b : system.bodies) {
			masses.insert(masses.end(), b.w, b.w + Space::freedoms);
			velocities.insert(velocities.end(), b.v, b.v + Space::freedoms);
		}
		Contacts of;
		for (const cd::ContactRow<Space>& c : system.contacts) {
			if (!(c.wnn > 0))
				continue;
			of.pairs.insert(of.pairs.end(), { c.a, c.b });
			of.bias.push_back(c.bias);
			of.compliances.insert(of.compliances.end(), { c.cn, c.ct });
			of.mu.push_back(c.mu);
			of.add(c);
		}
		return py::make_tuple(bytes(masses), bytes(velocities), bytes(of.pairs), bytes(of.normals), bytes(of.arms), bytes(of.bias),
		    bytes(of.mu), bytes(of.impulses), bytes(of.compliances), bytes(of.slipBias));
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
	if (!inSpace)
		try {
			return nextProblemIn<cd::Plane>(now);
		} catch (const LeavesPlane&) { // as the next step will find, too
		}
	return nextProblemIn<cd::Space3>(now);
}

// Whatever has a memory is a copy here: this engine and the scene do not change.
template <class Space> py::tuple ContactDynamics::nextProblemIn(yade::Scene* now) const
{
	const cd::StepSettings<Space> settings = this->settings<Space>(now);
	std::mutex alone;
	std::vector<int> ids = referenceIds, order = bodyOrder;
	std::vector<double> overlaps = referenceOverlaps;
	double length = bodyOrderLength;
	SceneLink<Space> copy;
	copy.stiffness = stiffnessSettings();
	copy.mask = mask;
	copy.world.apart = OtherEngines::maskOf(OtherEngines::colliderOf(now)); // `others` knows the list of the last step
	copy.setValues(readPairValues());
	copy.inspectScene(now, gravity, settings.dt, { { ids, overlaps }, { order, length }, alone }, checksOrder());
	if (copy.world.rolls())
		throw SceneError(
		    "ContactDynamics: a file cannot hold the rolling resistance of a CohFrictMat. Set etaRoll to 0 to export the problem "
		    "without it");
	if (copy.world.compliant())
		copy.forgetOverlaps();
	else if (handover)
		copy.takeOverlaps(storedEnergy > 0);
	cd::TimeStep<Space> next;
	return bodyArrays<Space>(next.assemble(copy.world, settings));
}

} // namespace cd_engine
