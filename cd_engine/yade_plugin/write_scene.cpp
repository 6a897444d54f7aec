#include "scene_link.hpp"

#include <algorithm>
#include <cmath>

namespace cd_engine {
namespace {

	template <class T> boost::shared_ptr<T> create(const char* name)
	{
		const boost::shared_ptr<yade::Factorable> made = Singleton<yade::ClassFactory>::instance().createShared(name);
		return boost::shared_ptr<T>(made, reinterpret_cast<T*>(made.get()));
	}

} // namespace

// Gives the interaction objects to hold its force: those it had when it was last loaded, or new ones.
void SceneLink::makeReal(std::size_t index, long iteration)
{
	auto& geom = at<boost::shared_ptr<yade::IGeom>>(interactions[index], layout.interaction_geom);
	auto& phys = at<boost::shared_ptr<yade::IPhys>>(interactions[index], layout.interaction_phys);
	if (!spare[index].geom)
		spare[index] = { create<yade::IGeom>("ScGeom"), create<yade::IPhys>("FrictPhys") };
	geom = spare[index].geom;
	phys = spare[index].phys;
	at<long>(interactions[index], layout.interaction_iterMadeReal) = iteration;
	forces[index] = { geom.get(), phys.get(), true };
	const cd::Pair& pair = world.pairs[index];
	const double radiusB = world.bodies[pair.b].shape.radius;
	at<double>(geom.get(), layout.geom_refR1) = bodies[pair.a].boundary ? radiusB : world.bodies[pair.a].shape.radius;
	at<double>(geom.get(), layout.geom_refR2) = radiusB;
	at<Vector3r>(geom.get(), layout.geom_shearInc) = Vector3r::Zero();
}

void SceneLink::makeUnreal(std::size_t index)
{
	auto& geom = at<boost::shared_ptr<yade::IGeom>>(interactions[index], layout.interaction_geom);
	auto& phys = at<boost::shared_ptr<yade::IPhys>>(interactions[index], layout.interaction_phys);
	if (forces[index].geom)
		spare[index] = { geom, phys };
	geom.reset();
	phys.reset();
	at<long>(interactions[index], layout.interaction_iterMadeReal) = -1;
}

// The forces in YADE's signs: normalForce + shearForce act on the second body.
void SceneLink::writeContact(std::size_t index, double rate)
{
	const cd::Pair& pair = world.pairs[index];
	void* const g = forces[index].geom;
	void* const p = forces[index].phys;
	at<Vector3r>(g, layout.geom_normal) = Vector3r(pair.nx, pair.ny, 0);
	at<Vector3r>(g, layout.geom_contactPoint) = Vector3r(pair.cx, pair.cy, layer);
	at<double>(g, layout.geom_penetrationDepth) = pair.overlap;
	at<double>(p, layout.phys_tangensOfFrictionAngle) = pair.mu;
	const double fn = pair.pn * rate, ft = pair.pt * rate;
	at<Vector3r>(p, layout.phys_normalForce) = Vector3r(fn * pair.nx, fn * pair.ny, 0);
	at<Vector3r>(p, layout.phys_shearForce) = Vector3r(-ft * pair.ny, ft * pair.nx, 0);
}

void SceneLink::writeMotion(std::size_t id)
{
	char* const state = bodies[id].state;
	const cd::Body& body = world.bodies[id];
	Vector3r& position = at<Vector3r>(state, layout.state_se3);
	Vector3r& velocity = at<Vector3r>(state, layout.state_vel);
	position[0] = body.x;
	position[1] = body.y;
	velocity[0] = body.v[0];
	velocity[1] = body.v[1];
	at<Vector3r>(state, layout.state_angVel)[2] = body.v[2];
	if (body.turn == 0)
		return;
	// The turn about z, applied from the left. Quasi-static turns are tiny, where two terms of the series are exact to round-off.
	double* q = &at<double>(state, layout.state_orientation);
	const double half = 0.5 * body.turn, square = half * half;
	const bool tiny = square < 1e-7;
	const double s = tiny ? half * (1 - square / 6) : std::sin(half), c = tiny ? 1 - square * (0.5 - square / 24) : std::cos(half);
	const double x = c * q[0] - s * q[1], y = c * q[1] + s * q[0], z = c * q[2] + s * q[3], w = c * q[3] - s * q[2];
	// Renormalised, since round-off would grow over 1e6 steps.
	const double inverse = 1 / std::sqrt(x * x + y * y + z * z + w * w);
	q[0] = x * inverse;
	q[1] = y * inverse;
	q[2] = z * inverse;
	q[3] = w * inverse;
}

void SceneLink::scatter(yade::Scene* scene, double dt)
{
	const long iteration = at<long>(scene, layout.scene_iter);
	const double rate = 1 / dt;
	total.assign(world.bodies.size(), { 0, 0, 0 });
	for (std::size_t i = 0; i < world.pairs.size(); i++) {
		if (i + 8 < world.pairs.size() && forces[i + 8].geom) { // written next: their cache lines are asked for ahead
			__builtin_prefetch(static_cast<char*>(forces[i + 8].geom) + 64, 1);
			__builtin_prefetch(static_cast<char*>(forces[i + 8].geom) + 128, 1);
			__builtin_prefetch(static_cast<char*>(forces[i + 8].phys) + 64, 1);
		}
		const cd::Pair& pair = world.pairs[i];
		if (!(pair.pn > 0)) {
			if (forces[i].any)
				makeUnreal(i);
			continue;
		}
		if (!forces[i].geom)
			makeReal(i, iteration);
		writeContact(i, rate);
		const double fx = (pair.nx * pair.pn - pair.ny * pair.pt) * rate, fy = (pair.ny * pair.pn + pair.nx * pair.pt) * rate;
		// A disk takes the force on its rim, so only the tangential part turns it; a boundary's arm starts at its centre.
		const double ft = pair.pt * rate, radiusA = bodies[pair.a].boundary ? 0 : world.bodies[pair.a].shape.radius;
		std::array<double, 3>&onA = total[pair.a], &onB = total[pair.b];
		onA[0] -= fx;
		onA[1] -= fy;
		onB[0] += fx;
		onB[1] += fy;
		onB[2] -= (world.bodies[pair.b].shape.radius - 0.5 * pair.overlap) * ft;
		if (radiusA > 0)
			onA[2] -= (radiusA - 0.5 * pair.overlap) * ft;
		else {
			// At the mid-configuration, where the solver had it.
			const cd::Body& a = world.bodies[pair.a];
			onA[2] -= (pair.cx - a.x + 0.5 * dt * a.v[0]) * fy - (pair.cy - a.y + 0.5 * dt * a.v[1]) * fx;
		}
	}
	auto& container = at<yade::ForceContainer>(scene, layout.scene_forces);
	for (std::size_t id = 0; id < world.bodies.size(); id++) {
		if (!bodies[id].exists)
			continue;
		writeMotion(id);
		const double* w = world.bodies[id].inverseMass;
		const double weight = w[0] > 0 || w[1] > 0 ? at<double>(bodies[id].state, layout.state_mass) : 0;
		container.addForce(static_cast<int>(id), Vector3r(total[id][0] + weight * gravity[0], total[id][1] + weight * gravity[1], 0));
		container.addTorque(static_cast<int>(id), Vector3r(0, 0, total[id][2]));
	}
	// ForceResetter clears the sums only; what threads have added since the last sync would return in the next step.
	container.sync();
}

} // namespace cd_engine
