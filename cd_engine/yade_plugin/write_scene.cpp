#include "scene_link.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd_engine {
namespace {

	constexpr std::size_t ahead = 10; // contacts or bodies whose memory is asked for before it is written

	template <class T> boost::shared_ptr<T> create(const char* name)
	{
		const boost::shared_ptr<yade::Factorable> made = Singleton<yade::ClassFactory>::instance().createShared(name);
		return boost::shared_ptr<T>(made, reinterpret_cast<T*>(made.get()));
	}

	bool isA(void* serializable, const char* name) { return static_cast<yade::Serializable*>(serializable)->getClassName() == name; }

} // namespace

// Keeps the spares of pairs that are about to be forgotten, so that contacts that come and go do not ask for memory. Not those that somebody
// else holds or that springs have made: stiffnesses stay with their pair.
void SceneLink::collectSpares()
{
	for (Spare& s : spare)
		if (s.geom.use_count() == 1 && s.phys.use_count() == 1 && isA(s.geom.get(), "ScGeom") && isA(s.phys.get(), "FrictPhys")
		    && at<double>(s.phys.get(), layout.phys_kn) == 0)
			pool.push_back(std::move(s));
}

SceneLink::Spare SceneLink::takeSpare()
{
	if (pool.empty())
		return { create<yade::IGeom>("ScGeom"), create<yade::IPhys>("FrictPhys") };
	Spare taken = std::move(pool.back());
	pool.pop_back();
	return taken;
}

// Gives the interaction objects to hold its force: those it had when it was last loaded, or others, of which every member is set anew.
void SceneLink::makeReal(std::size_t index, long iteration)
{
	auto& geom = at<boost::shared_ptr<yade::IGeom>>(interactions[index], layout.interaction_geom);
	auto& phys = at<boost::shared_ptr<yade::IPhys>>(interactions[index], layout.interaction_phys);
	if (!spare[index].geom)
		spare[index] = takeSpare();
	geom = spare[index].geom;
	phys = spare[index].phys;
	at<long>(interactions[index], layout.interaction_iterMadeReal) = iteration;
	forces[index] = { geom.get(), phys.get(), true };
	const cd::Pair& pair = world.pairs[index];
	const double radiusB = surfaces[pair.b].radius;
	at<double>(geom.get(), layout.geom_refR1) = bodies[pair.a].boundary ? radiusB : surfaces[pair.a].radius;
	at<double>(geom.get(), layout.geom_refR2) = radiusB;
	at<Vector3r>(geom.get(), layout.geom_shearInc) = Vector3r::Zero();
	at<Vector3r>(geom.get(), layout.geom_normal) = Vector3r::Zero(); // YADE leaves it as the memory was; no contact has it
}

void SceneLink::makeUnreal(std::size_t index)
{
	auto& geom = at<boost::shared_ptr<yade::IGeom>>(interactions[index], layout.interaction_geom);
	auto& phys = at<boost::shared_ptr<yade::IPhys>>(interactions[index], layout.interaction_phys);
	if (forces[index].geom)
		spare[index] = { geom, phys };
	forces[index] = { nullptr, nullptr, false };
	geom.reset();
	phys.reset();
	at<long>(interactions[index], layout.interaction_iterMadeReal) = -1;
}

// The forces in YADE's signs: normalForce + shearForce act on the second body. Those that say already what they are to say stay as they are, since
// written again they would differ in the last digit; returns whether they were written.
bool SceneLink::writeContact(std::size_t index, const cd::Touch& touch, double dt)
{
	const cd::Pair& pair = world.pairs[index];
	void* const g = forces[index].geom;
	void* const p = forces[index].phys;
	at<Vector3r>(g, layout.geom_contactPoint) = Vector3r(touch.cx, touch.cy, layer);
	at<double>(g, layout.geom_penetrationDepth) = touch.overlap;
	at<double>(p, layout.phys_tangensOfFrictionAngle) = pair.mu;
	const Vector3r normal(touch.nx, touch.ny, 0);
	if (at<Vector3r>(g, layout.geom_normal) == normal && impulseIn(forces[index], dt) == std::array<double, 2> { pair.pn, pair.pt })
		return false;
	at<Vector3r>(g, layout.geom_normal) = normal;
	const double rate = 1 / dt, fn = pair.pn * rate, ft = pair.pt * rate;
	at<Vector3r>(p, layout.phys_normalForce) = Vector3r(fn * touch.nx, fn * touch.ny, 0);
	at<Vector3r>(p, layout.phys_shearForce) = Vector3r(-ft * touch.ny, ft * touch.nx, 0);
	return true;
}

// The lines of memory that writeContact writes.
void SceneLink::prefetchContact(const Forces& f) const
{
	if (!f.geom)
		return;
	for (const long member : { layout.geom_normal, layout.geom_contactPoint + 16, layout.geom_penetrationDepth })
		prefetch(f.geom, member);
	prefetch(f.phys, layout.phys_normalForce);
	prefetch(f.phys, layout.phys_tangensOfFrictionAngle);
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

void SceneLink::scatterContacts(cd::TimeStep& step, long iteration, double dt)
{
	if (step.woke())
		for (const int32_t i : world.awake) { // some have not been read before the step
			findForces(i);
			checkForces(i);
		}
	const std::vector<int32_t>& solved = step.pairs();
	assert(solved.size() == step.touches().size() && spare.size() == world.pairs.size() && forces.size() == world.pairs.size());
	for (std::size_t i = 0; i < solved.size(); i++) {
		if (i + ahead < solved.size())
			prefetchContact(forces[solved[i + ahead]]);
		assert(static_cast<std::size_t>(solved[i]) < world.pairs.size());
		const cd::Pair& pair = world.pairs[solved[i]];
		if (!(pair.pn > 0))
			continue;
		bool changes = !forces[solved[i]].geom;
		if (changes)
			makeReal(solved[i], iteration);
		changes = writeContact(solved[i], step.touches()[i], dt) || changes;
		if (changes)
			step.sleepers.disturb(pair);
	}
	for (const int32_t i : world.awake)
		if (forces[i].any && !(world.pairs[i].pn > 0)) {
			makeUnreal(i);
			step.sleepers.disturb(world.pairs[i]);
		}
}

void SceneLink::scatter(yade::Scene* scene, cd::TimeStep& step, double dt)
{
	assert(world.bodies.size() == bodies.size());
	scatterContacts(step, at<long>(scene, layout.scene_iter), dt);
	auto& container = at<yade::ForceContainer>(scene, layout.scene_forces);
	const double rate = 1 / dt;
	for (std::size_t id = 0; id < world.bodies.size(); id++) {
		if (id + ahead < world.bodies.size())
			prefetchBody(bodies[id + ahead]);
		if (!bodies[id].exists)
			continue;
		writeMotion(id);
		const double* w = world.bodies[id].inverseMass;
		const double weight = w[0] > 0 || w[1] > 0 ? at<double>(bodies[id].state, layout.state_mass) : 0;
		const std::array<double, 3>& p = step.impulseOn(id);
		container.addForce(static_cast<int>(id), Vector3r(p[0] * rate + weight * gravity[0], p[1] * rate + weight * gravity[1], 0));
		container.addTorque(static_cast<int>(id), Vector3r(0, 0, p[2] * rate));
	}
	// ForceResetter clears the sums only; what threads have added since the last sync would return in the next step.
	container.sync();
}

} // namespace cd_engine
