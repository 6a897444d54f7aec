// Tangential springs between disks that store no path: McNamara, Garcia-Rojo and Herrmann, Phys. Rev. E 77, 031304 (2008).
#include "../kind.hpp"
#include "../scene_plane.hpp"
#include "spring_engines.hpp"

#include <algorithm>
#include <numeric>

namespace cd_engine {
namespace {

	// Whether a law functor of linear springs has made this phys. Of exactly these classes: derived ones have springs of another kind,
	// whose stiffness varies or whose shearForce holds a dashpot's part.
	bool linearSprings(const void* phys)
	{
		static Kind isFrictPhys { "FrictPhys", Kind::exactly }, isFrictViscoPhys { "FrictViscoPhys", Kind::exactly };
		return isFrictPhys(phys) || isFrictViscoPhys(phys);
	}

} // namespace

// Two disks of radii R1, R2 with centres d = R1 + R2 - delta apart, the line of centres at the angle theta, turned by phi1 and phi2.
// The spring is stretched by
//     d xi = (R1 + R2) d theta - R1 d phi1 - R2 d phi2,
// an exact differential, so T = k_t xi depends on where the disks are and not on how they came there, until it slips at
// |T| = mu |R_n|. By virtual work the energy T^2/(2 k_t) pushes the disks apart sideways with alpha T, alpha = (R1 + R2)/d, and turns
// them with the arms R1 and R2. (The usual law has d instead of R1 + R2 and R_i - delta/2 instead of R_i in the stretch; that is no
// differential, and a closed path leaves a force behind.)
//
// Signs: n points from the first to the second disk, t is n turned by +90 degrees, phys.shearForce = S t acts on the second disk:
// S = -T. As everywhere in this project phys.shearForce is the force in the spring; what acts on the disks is alpha times that.
class PathIndependentShear : public SpringEngine<PathIndependentShear> {
    public:
	static constexpr const char* name = "PathIndependentShear";
	static constexpr const char* documentation
	    = "Makes the tangential springs between disks path-independent (McNamara, Garcia-Rojo and Herrmann, Phys. Rev. E 77, 031304, 2008). It "
	      "stands behind InteractionLoop and before NewtonIntegrator, and replaces what the law functor has found for phys.shearForce of each "
	      "contact of two spheres by T = ks xi with d xi = (R1+R2) d theta - R1 d phi1 - R2 d phi2, clipped at tan(phi)|normalForce|; the force "
	      "on the disks is "
	      "(R1+R2)/d T at the arms R1 and R2, d the distance of their centres. O.forces then holds this instead of the functor's force. "
	      "A contact seen for the first time takes over the functor's shear force, so a packing made with the usual law goes on from its forces. "
	      "For Law2_ScGeom_FrictPhys_CundallStrack and Law2_ScGeom_FrictViscoPhys_CundallStrackVisco and for spheres in one plane, which their "
	      "blockedDOFs tell (x-y if they do not). "
	      "Contacts with walls and boxes keep the functor's force; the slip on them is counted, too. O.dt may change between steps only where "
	      "nothing "
	      "turns.";

	// Left by the last step.
	int contacts = 0;
	int slidingContacts = 0;
	double frictionDissipation = 0; // since the start [J]
	// The memory of the springs, in the order of the scene's list of interactions: it survives O.save.
	std::vector<int> pairIds; // two a pair
	std::vector<double> pairNormals; // n_x, n_y
	std::vector<double> pairForces; // S [N]
	long lastStep = -1; // of the memory

	template <class Visitor> static void attributes(Visitor&& visit)
	{
		using C = PathIndependentShear;
		visit("contacts", &C::contacts, result, "Contacts between two disks that the last step has dealt with [1].");
		visit("slidingContacts", &C::slidingContacts, result, "Of these, the ones that slipped at the Coulomb limit in the last step [1].");
		visit("frictionDissipation", &C::frictionDissipation, setting,
		    "Energy dissipated by slip since the start, on walls and boxes, too [J].");
		visit("pairIds", &C::pairIds, internal, "Ids of the bodies of all contacts, two a contact; the memory of the springs.");
		visit("pairNormals", &C::pairNormals, internal,
		    "Their normals in the last step, from the first body to the second: x and y, x and z or y and z [1].");
		visit("pairForces", &C::pairForces, internal, "Their spring's forces on the second body along the normal turned by +90 degrees [N].");
		visit("lastStep", &C::lastStep, internal, "O.iter of the last step; after a pause of this engine the memory starts anew.");
	}

	void step();

    private:
	struct Disk {
		bool exists = false; // else the body is no disk
		double turn = 0; // since the step before [rad]
		Vector3r force = Vector3r::Zero(); // in the plane; to be added to O.forces, as the torque
		double torque = 0;
		bool touched = false;
	};

	// A contact of linear springs in the plane.
	struct Spring {
		void *geom, *phys;
		int id1, id2;
		const Vector3r& n;
		double force; // the functor's S [N]
		double limit; // mu |R_n| [N]
		std::size_t known; // its place in the memory; at its end: made in this step, or not known
	};

	void readBodies();
	bool isDisk(int id) const { return id < static_cast<int>(disks.size()) && disks[id].exists; }
	bool exchange(yade::Interaction*);
	void countSlip(const Spring&, bool isNew);
	bool clip(double& force, const Spring&);
	void remember(const Spring&, double force);
	std::size_t recall(int id1, int id2);

	ScenePlane plane;
	std::vector<Disk> disks; // at their bodies' ids
	// The memory being written while the old one is read; where the next pair is expected in it; its order by ids, made when needed.
	std::vector<int> newIds;
	std::vector<double> newNormals, newForces;
	std::size_t expected = 0;
	std::vector<std::size_t> sorted;
};

// NewtonIntegrator's leapfrog has turned each sphere by angVel dt since the forces were last found.
void PathIndependentShear::readBodies()
{
	auto& container = *scene_bodies(scene);
	const double dt = scene_dt(scene);
	static Kind isSphere { "Sphere" };
	plane = ScenePlane::of(container, plane, Vector3r::Zero());
	disks.assign(container.size(), Disk());
	for (std::size_t id = 0; id < disks.size(); id++) {
		const Shared<yade::Body>& body = container[id];
		if (!body || !body_shape(body) || !isSphere(body_shape(body).get()))
			continue;
		const Vector3r& spin = state_angVel(body_state(body));
		if (spin[plane.x] != 0 || spin[plane.y] != 0)
			refuse(text("body #", id, " turns out of the plane"),
			    text("Set blockedDOFs='", plane.blocks(), "' and its ", plane.letter(plane.x), " and ", plane.letter(plane.y),
				" angular velocities to 0"));
		disks[id].exists = true;
		disks[id].turn = plane.turn * spin[plane.normal] * dt;
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

// Takes a trial force back to the limit and counts the energy of the slip. Returns whether it slips.
bool PathIndependentShear::clip(double& force, const Spring& c)
{
	if (!(std::abs(force) > c.limit))
		return false;
	frictionDissipation += c.limit * (std::abs(force) - c.limit) / phys_ks(c.phys);
	force = std::copysign(c.limit, force);
	return true;
}

void PathIndependentShear::remember(const Spring& c, double force)
{
	newIds.insert(newIds.end(), { c.id1, c.id2 });
	newNormals.insert(newNormals.end(), { c.n[0], c.n[1] });
	newForces.push_back(force);
}

// The slip of a disk on something else. The law functor has taken its trial force, S - k_s (shearInc . t), back to the limit.
void PathIndependentShear::countSlip(const Spring& c, bool isNew)
{
	const Vector3r moved = plane.toCore(geom_shearInc(c.geom));
	if (isNew || c.known < pairForces.size()) {
		double trial = (isNew ? 0 : pairForces[c.known]) - phys_ks(c.phys) * (c.n[0] * moved[1] - c.n[1] * moved[0]);
		clip(trial, c);
	}
	remember(c, c.force);
}

// Replaces the shear force of one contact; false where there is none between two disks.
bool PathIndependentShear::exchange(yade::Interaction* interaction)
{
	void* const geom = interaction_geom(interaction).get();
	void* const phys = interaction_phys(interaction).get();
	if (!geom || !phys)
		return false;
	const int id1 = interaction_id1(interaction), id2 = interaction_id2(interaction);
	const bool ofDisks = isDisk(id1) && isDisk(id2), linear = isScGeom(geom) && linearSprings(phys);
	if (!ofDisks && !linear)
		return false;
	if (!linear)
		refuse(pairName(id1, id2) + " has " + className(geom) + " and " + className(phys),
		    "It needs ScGeom with FrictPhys (Law2_ScGeom_FrictPhys_CundallStrack) or FrictViscoPhys "
		    "(Law2_ScGeom_FrictViscoPhys_CundallStrackVisco)");
	const Vector3r n = plane.toCore(geom_normal(geom));
	if (n[2] != 0 && ofDisks)
		refuse(pairName(id1, id2) + " has a normal out of the plane", "Put all disks in one plane, and block what would take them out of it");

	Vector3r& shear = phys_shearForce(phys);
	const Vector3r old = plane.toCore(shear);
	// A contact made in this step is new, even if the same pair had one in the step before. (O.resetTime() may leave iterMadeReal in the future.)
	const bool isNew = interaction_iterMadeReal(interaction) == scene_iter(scene);
	const Spring c { geom, phys, id1, id2, n, n[0] * old[1] - n[1] * old[0], phys_tangensOfFrictionAngle(phys) * phys_normalForce(phys).norm(),
		isNew ? pairForces.size() : recall(id1, id2) };
	if (!ofDisks) {
		if (n[2] == 0)
			countSlip(c, isNew);
		return false;
	}

	const double r1 = geom_refR1(geom), r2 = geom_refR2(geom);
	const double overlap = geom_penetrationDepth(geom);
	double force = c.force; // a spring not known from the step before begins with what the law functor has found
	if (c.known < pairForces.size()) {
		const double mx = pairNormals[2 * c.known], my = pairNormals[2 * c.known + 1];
		const double theta = std::atan2(mx * n[1] - my * n[0], mx * n[0] + my * n[1]);
		const double stretch = (r1 + r2) * theta - r1 * disks[id1].turn - r2 * disks[id2].turn;
		force = pairForces[c.known] - phys_ks(phys) * stretch;
	}
	slidingContacts += clip(force, c) && c.limit > 0; // without friction there is no limit to reach
	remember(c, force);

	const double forceX = -n[1] * force, forceY = n[0] * force;
	shear = plane.toSpace(forceX, forceY);
	const double alpha = (r1 + r2) / (r1 + r2 - overlap);
	const Vector3r added(alpha * forceX - old[0], alpha * forceY - old[1], 0);
	Disk &one = disks[id1], &two = disks[id2];
	one.force -= added;
	two.force += added;
	one.torque -= r1 * force - (r1 - overlap / 2) * c.force;
	two.torque -= r2 * force - (r2 - overlap / 2) * c.force;
	one.touched = two.touched = true;
	return true;
}

void PathIndependentShear::step()
{
	if (scene_isPeriodic(scene))
		refuse("the scene is periodic, which is not supported", "Set O.periodic=False and use walls");
	readBodies();
	const long now = scene_iter(scene);
	if (now != lastStep + 1)
		pairForces.clear(); // no pair is known any more
	expected = 0;
	sorted.clear();
	newIds.clear();
	newNormals.clear();
	newForces.clear();
	contacts = slidingContacts = 0;
	for (const auto& interaction : interactionsOf(scene))
		contacts += exchange(interaction.get());
	pairIds.swap(newIds);
	pairNormals.swap(newNormals);
	pairForces.swap(newForces);
	lastStep = now;

	// Added as the law functors add theirs: NewtonIntegrator sums up what is pending.
	auto& forces = scene_forces(scene);
	for (std::size_t id = 0; id < disks.size(); id++) {
		if (!disks[id].touched)
			continue;
		forces.addForce(static_cast<int>(id), plane.toSpace(disks[id].force[0], disks[id].force[1]));
		forces.addTorque(static_cast<int>(id), plane.torque(disks[id].torque));
	}
}

} // namespace cd_engine

CD_ENGINE_REGISTER(PathIndependentShear)
