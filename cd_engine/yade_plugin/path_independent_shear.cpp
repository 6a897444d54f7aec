#include "path_independent_shear.hpp"
#include "inheritance.hpp"
#include "layout.hpp"
#include "scene_error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cd_engine {
namespace {

	[[noreturn]] void refuse(const std::string& what, const std::string& remedy)
	{
		throw SceneError("PathIndependentShear: " + what + ". " + remedy);
	}

	std::string pairName(int id1, int id2) { return "the contact of bodies #" + std::to_string(id1) + " and #" + std::to_string(id2); }

	// Whether a law functor of linear springs has made this phys. Of exactly these classes: derived ones have springs of another kind,
	// whose stiffness varies or whose shearForce holds a dashpot's part.
	bool linearSprings(const void* phys)
	{
		static const void* known = nullptr; // vtable last found to be one of them
		const void* const vtable = *static_cast<const void* const*>(phys);
		if (vtable == known)
			return true;
		const std::string name = static_cast<const yade::Serializable*>(phys)->getClassName();
		if (name != "FrictPhys" && name != "FrictViscoPhys")
			return false;
		known = vtable;
		return true;
	}

} // namespace

void PathIndependentShear::forget()
{
	pairIds.clear();
	pairNormals.clear();
	pairForces.clear();
}

// The forces to be replaced must have been found in this step and not yet have moved the bodies.
void PathIndependentShear::checkScene() const
{
	if (at<bool>(scene, layout.scene_isPeriodic))
		refuse("the scene is periodic, which is not supported", "Set O.periodic=False and use walls");
	bool found = false, used = false;
	for (const auto& engine : at<std::vector<boost::shared_ptr<yade::Engine>>>(scene, layout.scene_engines)) {
		if (engine.get() == this)
			break;
		if (engine->dead)
			continue;
		const std::string other = engine->getClassName();
		found = found || other == "InteractionLoop";
		used = used || other == "NewtonIntegrator";
		if (other == name)
			refuse("there is another one before it, and forces would be replaced twice", "Remove one of them from O.engines");
	}
	if (!found)
		refuse(
		    "there is no InteractionLoop before it, so there are no forces to replace", "Put it right behind InteractionLoop in O.engines");
	if (used)
		refuse("a NewtonIntegrator before it has used the forces already", "Put it right behind InteractionLoop in O.engines");
}

// NewtonIntegrator's leapfrog has turned each sphere by angVel dt since the forces were last found.
void PathIndependentShear::readBodies()
{
	auto& container = *at<boost::shared_ptr<yade::BodyContainer>>(scene, layout.scene_bodies);
	const double dt = at<double>(scene, layout.scene_dt);
	disks.assign(container.size(), Disk());
	for (std::size_t id = 0; id < disks.size(); id++) {
		char* const body = reinterpret_cast<char*>(container[id].get());
		void* const shape = body ? pointer<yade::Shape>(body, layout.body_shape) : nullptr;
		if (!shape || !inherits(shape, Base::Sphere))
			continue;
		const Vector3r& spin = at<Vector3r>(pointer<yade::State>(body, layout.body_state), layout.state_angVel);
		if (spin[0] != 0 || spin[1] != 0)
			refuse("body #" + std::to_string(id) + " turns out of the plane",
			    "Set blockedDOFs='zXY' and its x and y angular velocities to 0");
		disks[id].shape = shape;
		disks[id].turn = spin[2] * dt;
	}
}

// Where the pair stands in the memory, or its length. Almost always next to the pair before, else found by bisection.
std::size_t PathIndependentShear::recall(int id1, int id2)
{
	const std::size_t count = pairForces.size();
	const auto ids = [&](std::size_t k) { return std::make_pair(pairIds[2 * k], pairIds[2 * k + 1]); };
	const auto wanted = std::make_pair(id1, id2);
	if (expected < count && ids(expected) == wanted)
		return expected++;
	if (sorted.empty()) {
		sorted.resize(count);
		std::iota(sorted.begin(), sorted.end(), 0);
		std::sort(sorted.begin(), sorted.end(), [&](std::size_t j, std::size_t k) { return ids(j) < ids(k); });
	}
	const auto place = std::lower_bound(sorted.begin(), sorted.end(), wanted, [&](std::size_t k, const auto& value) { return ids(k) < value; });
	if (place == sorted.end() || ids(*place) != wanted)
		return count;
	expected = *place + 1;
	return *place;
}

// Replaces the shear force of one contact; false where there is none between two disks.
bool PathIndependentShear::exchange(yade::Interaction* interaction)
{
	void* const geom = at<boost::shared_ptr<yade::IGeom>>(interaction, layout.interaction_geom).get();
	void* const phys = at<boost::shared_ptr<yade::IPhys>>(interaction, layout.interaction_phys).get();
	if (!geom || !phys)
		return false;
	const int id1 = at<int>(interaction, layout.interaction_id1), id2 = at<int>(interaction, layout.interaction_id2);
	const int count = static_cast<int>(disks.size());
	if (id1 >= count || id2 >= count || !disks[id1].shape || !disks[id2].shape)
		return false;
	if (!inherits(geom, Base::ScGeom) || !linearSprings(phys))
		refuse(pairName(id1, id2) + " has " + static_cast<yade::Serializable*>(geom)->getClassName() + " and "
			+ static_cast<yade::Serializable*>(phys)->getClassName(),
		    "It needs ScGeom with FrictPhys (Law2_ScGeom_FrictPhys_CundallStrack) or FrictViscoPhys "
		    "(Law2_ScGeom_FrictViscoPhys_CundallStrackVisco)");
	const Vector3r& n = at<Vector3r>(geom, layout.geom_normal);
	if (n[2] != 0)
		refuse(pairName(id1, id2) + " has a normal out of the plane", "Put all disks at one z");

	const double r1 = at<double>(geom, layout.geom_refR1), r2 = at<double>(geom, layout.geom_refR2);
	const double overlap = at<double>(geom, layout.geom_penetrationDepth);
	Vector3r& shear = at<Vector3r>(phys, layout.phys_shearForce);
	const Vector3r old = shear;
	const double oldForce = n[0] * old[1] - n[1] * old[0];

	double force = oldForce; // a spring not known from the step before begins with what the law functor has found
	// A contact made in this step is new, even if the same pair had one in the step before. (O.resetTime() may leave iterMadeReal in the future.)
	const std::size_t known = recall(id1, id2);
	const bool isNew = at<long>(interaction, layout.interaction_iterMadeReal) == at<long>(scene, layout.scene_iter);
	if (known < pairForces.size() && !isNew) {
		const double mx = pairNormals[2 * known], my = pairNormals[2 * known + 1];
		const double theta = std::atan2(mx * n[1] - my * n[0], mx * n[0] + my * n[1]);
		const double stretch = (r1 + r2) * theta - r1 * disks[id1].turn - r2 * disks[id2].turn;
		force = pairForces[known] - at<double>(phys, layout.phys_ks) * stretch;
	}
	const double limit = at<double>(phys, layout.phys_tangensOfFrictionAngle) * at<Vector3r>(phys, layout.phys_normalForce).norm();
	if (std::abs(force) > limit) {
		frictionDissipation += limit * (std::abs(force) - limit) / at<double>(phys, layout.phys_ks);
		force = std::copysign(limit, force);
		slidingContacts += limit > 0; // without friction there is no limit to reach
	}

	shear = Vector3r(-n[1] * force, n[0] * force, 0);
	newIds.insert(newIds.end(), { id1, id2 });
	newNormals.insert(newNormals.end(), { n[0], n[1] });
	newForces.push_back(force);

	const double alpha = (r1 + r2) / (r1 + r2 - overlap);
	const double fx = alpha * shear[0] - old[0], fy = alpha * shear[1] - old[1];
	Disk &one = disks[id1], &two = disks[id2];
	one.force[0] -= fx;
	one.force[1] -= fy;
	two.force[0] += fx;
	two.force[1] += fy;
	one.torque -= r1 * force - (r1 - overlap / 2) * oldForce;
	two.torque -= r2 * force - (r2 - overlap / 2) * oldForce;
	one.touched = two.touched = true;
	return true;
}

void PathIndependentShear::action()
{
	checkScene();
	readBodies();
	const long step = at<long>(scene, layout.scene_iter);
	if (step != lastStep + 1)
		forget();
	expected = 0;
	sorted.clear();
	newIds.clear();
	newNormals.clear();
	newForces.clear();
	contacts = slidingContacts = 0;
	void* const list = at<boost::shared_ptr<yade::InteractionContainer>>(scene, layout.scene_interactions).get();
	for (const auto& interaction : at<std::vector<boost::shared_ptr<yade::Interaction>>>(list, layout.interactions_linear))
		contacts += exchange(interaction.get());
	pairIds.swap(newIds);
	pairNormals.swap(newNormals);
	pairForces.swap(newForces);
	lastStep = step;

	// Added as the law functors add theirs: NewtonIntegrator sums up what is pending.
	auto& forces = at<yade::ForceContainer>(scene, layout.scene_forces);
	for (std::size_t id = 0; id < disks.size(); id++) {
		if (!disks[id].touched)
			continue;
		forces.addForce(static_cast<int>(id), Vector3r(disks[id].force[0], disks[id].force[1], 0));
		forces.addTorque(static_cast<int>(id), Vector3r(0, 0, disks[id].torque));
	}
}

} // namespace cd_engine
