#include "collider_rest.hpp"
#include "waiting.hpp"
#include "scene_error.hpp"

#include "../core/lost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd_engine {
namespace {

	using yade::Vector3r;

	// Whether a body has bounds to YADE's mind: it exists, and nobody has taken it out of all contacts.
	bool bounded(int id)
	{
		namespace py = boost::python;
		const PyGILState_STATE gil = PyGILState_Ensure();
		const py::object body = py::import("yade").attr("O").attr("bodies")[id];
		const bool is = !body.is_none() && py::extract<bool>(body.attr("bounded"));
		PyGILState_Release(gil);
		return is;
	}

	// Whether the collider makes bounds as wide as its verletDist; YADE's own does, where it has a NewtonIntegrator, which it asks how fast
	// bodies are. One that moves nothing says 0 for ever, which is to it that it does not know, so it runs whenever it is called.
	bool takesVerletDist(const boost::shared_ptr<yade::Engine>& collider)
	{
		namespace py = boost::python;
		if (collider->getClassName() != "InsertionSortCollider")
			return false;
		const PyGILState_STATE gil = PyGILState_Ensure();
		py::object(collider).attr("newton") = py::import("yade.wrapper").attr("NewtonIntegrator")();
		PyGILState_Release(gil);
		return true;
	}

	constexpr std::size_t fewQuick = 8;
	// Ways of its own in a step that a body may go before the collider has to run again; of the few fastest disks.
	constexpr double mostWays = 7, spareQuick = 50;
	// Of the radius: mean margin of the disks that is worth a rest, beyond a way of each.
	constexpr double meanMargin = 2;
	// Of its radius: margin of a slow disk where others are fast.
	constexpr double hitRadius = 0.5;

	// The bounds of a body; null if it has none, or does not exist.
	char* boundOf(yade::Scene* scene, int id)
	{
		char* const body = reinterpret_cast<char*>((*at<boost::shared_ptr<yade::BodyContainer>>(scene, layout.scene_bodies))[id].get());
		return body ? static_cast<char*>(pointer<yade::Bound>(body, layout.body_bound)) : nullptr;
	}

	// Where YADE has it.
	const Vector3r& placeOf(yade::Scene* scene, int id)
	{
		char* const body = reinterpret_cast<char*>((*at<boost::shared_ptr<yade::BodyContainer>>(scene, layout.scene_bodies))[id].get());
		return at<Vector3r>(pointer<yade::State>(body, layout.body_state), layout.state_se3);
	}

} // namespace

void ColliderRest::attach(boost::shared_ptr<yade::Engine> engine)
{
	wake();
	collider = std::move(engine);
	widens = takesVerletDist(collider);
	margins.clear();
	seen.clear();
}

void ColliderRest::wake()
{
	if (collider && resting)
		collider->dead = false;
	resting = false;
}

void ColliderRest::wakeUnsorted()
{
	wake();
	if (widens)
		at<bool>(collider.get(), layout.collider_doSort) = true;
}

// The ways of the bodies in this step, and what they need.
void ColliderRest::measure(const cd::World& world, double dt, const std::vector<double>& outran)
{
	const std::size_t count = world.bodies.size();
	ways.resize(count);
	needs.resize(count);
	fastest = 0;
	for (std::size_t i = 0; i < count; i++) {
		ways[i] = cd::wayOf(world.bodies[i], world.shapes[i], dt);
		needs[i] = cd::reachOf(world.bodies[i], world.shapes[i], dt);
		fastest = std::max(fastest, ways[i]);
	}
	for (std::size_t i = 0; i < std::min(outran.size(), count); i++)
		needs[i] = std::max(needs[i], outran[i]);
}

// Margins so wide that the collider may rest for some steps. The few fastest disks, which may be far from all others, get the widest. Where bodies are
// fast, slow ones get what an impact may ask of them.
void ColliderRest::chooseMargins(const cd::World& world)
{
	const std::size_t count = world.bodies.size();
	quick.clear();
	for (std::size_t i = 0; i < count; i++)
		if (world.bodies[i].radius > 0 && ways[i] > least)
			quick.push_back(i);
	const std::size_t many = std::min(fewQuick, quick.size());
	std::partial_sort(quick.begin(), quick.begin() + static_cast<long>(many), quick.end(),
	    [this](std::size_t i, std::size_t j) { return ways[i] != ways[j] ? ways[i] > ways[j] : i < j; });
	quick.resize(many);
	margins.resize(count);
	double radii = 0, need = 0, way = 0; // sums over the disks
	for (std::size_t i = 0; i < count; i++)
		if (world.bodies[i].radius > 0) {
			radii += world.bodies[i].radius;
			need += needs[i];
			way += ways[i];
		}
	const double spareWays = way > 0 ? std::clamp((meanMargin * radii - need) / way, 1., mostWays) : mostWays;
	for (std::size_t i = 0; i < count; i++) {
		const double hit = std::min(world.bodies[i].radius * hitRadius, fastest);
		margins[i] = std::max({ least, hit, needs[i] + spareWays * ways[i] });
	}
	for (const std::size_t i : quick)
		margins[i] = needs[i] + spareQuick * ways[i];
}

// What of its margin a body has used up by moving [m]; infinite if it is another one now.
double ColliderRest::used(const cd::World& world, std::size_t i) const
{
	const cd::Body& b = world.bodies[i];
	const double other = std::numeric_limits<double>::infinity();
	if (b.radius != seen[i].radius)
		return other;
	double way = std::max(std::abs(b.x - seen[i].x), std::abs(b.y - seen[i].y));
	if (b.radius == 0) {
		const cd::Shape &now = world.shapes[i], &then = seenShapes[i];
		if (now.kind != then.kind || now.ex != then.ex || now.ey != then.ey || now.axis != then.axis || now.sense != then.sense)
			return other;
		if (now.kind == cd::ShapeKind::box)
			way += std::hypot(now.ex, now.ey) * (std::abs(now.cosine - then.cosine) + std::abs(now.sine - then.sine));
	}
	return way;
}

// Whether what is left of every margin is enough. Fills World::listed.
bool ColliderRest::stillComplete(cd::World& world) const
{
	world.listed.resize(seen.size());
	for (std::size_t i = 0; i < seen.size(); i++) {
		world.listed[i] = margins[i] - used(world, i);
		if (!(needs[i] <= world.listed[i]))
			return false;
	}
	return true;
}

// Sets how far the collider makes the bounds wider when it runs next: of each body by its own margin, or of all by the largest.
void ColliderRest::askFor(yade::Scene* scene, bool each) const
{
	const int now = static_cast<int>(at<long>(scene, layout.scene_iter));
	at<double>(collider.get(), layout.collider_verletDist) = *std::max_element(margins.begin(), margins.end());
	at<int>(collider.get(), layout.collider_targetInterv) = each ? 1 : -1; // for so many steps of the way made since the bounds were made last
	at<double>(collider.get(), layout.collider_minSweepDistFactor) = 0;
	for (int id = 0; each && id < static_cast<int>(margins.size()); id++) {
		char* const bound = boundOf(scene, id);
		if (!bound)
			continue;
		auto& place = at<Vector3r>(bound, layout.bound_refPos);
		place = placeOf(scene, id);
		// By the round-off of the difference too much.
		place[0] -= margins[id] * (1 + 1e-9) + 8 * std::numeric_limits<double>::epsilon() * std::abs(place[0]);
		at<int>(bound, layout.bound_lastUpdateIter) = now - 1;
		at<double>(bound, layout.bound_sweepLength) = 0;
	}
}

// The first body, by its id, that does not lie within its bounds by its margin, or has none; -1 if all do.
int ColliderRest::narrowlyBound(const cd::World& world, yade::Scene* scene) const
{
	// A box's corners are known as well as the quaternion of its orientation is a unit one.
	constexpr double roundOff = 8 * std::numeric_limits<double>::epsilon(), unit = 1e-9;
	for (int id = 0; id < static_cast<int>(world.bodies.size()); id++) {
		char* const bound = boundOf(scene, id);
		const double width = margins[id];
		if (!bound && bounded(id))
			return id;
		if (!bound)
			continue;
		const cd::Body& b = world.bodies[id];
		const cd::Shape& shape = world.shapes[id];
		const cd::Half half = cd::halfSides(b, shape);
		const auto& low = at<yade::Vector3r>(bound, layout.bound_min);
		const auto& high = at<yade::Vector3r>(bound, layout.bound_max);
		const auto within = [&](int axis, double place, double side) {
			const double wide = side + width - roundOff * (std::abs(place) + side + width) - unit * (shape.ex + shape.ey);
			return std::isinf(side) || (low[axis] <= place - wide && high[axis] >= place + wide);
		};
		if (!within(0, b.x, half.x) || !within(1, b.y, half.y))
			return id;
	}
	return -1;
}

void ColliderRest::search(cd::World& world, yade::Scene* scene)
{
	if (widens)
		chooseMargins(world);
	else
		margins.assign(world.bodies.size(), 0);
	collider->scene = scene;
	const double leastShare = widens ? at<double>(collider.get(), layout.collider_minSweepDistFactor) : 0;
	int id = -1;
	// For each body first. A new body has no bounds yet that could be set, and at iteration 0 YADE uses one width for all.
	for (const bool each : { true, false }) {
		if (each && at<long>(scene, layout.scene_iter) == 0)
			continue;
		if (widens && !each)
			margins.assign(margins.size(), std::max(least, *std::max_element(needs.begin(), needs.end()) + fastest));
		if (widens)
			askFor(scene, each);
		collider->action();
		id = narrowlyBound(world, scene);
		if (id < 0)
			break;
	}
	if (widens) { // whoever runs it next
		at<double>(collider.get(), layout.collider_verletDist) = least;
		at<int>(collider.get(), layout.collider_targetInterv) = -1;
		at<double>(collider.get(), layout.collider_minSweepDistFactor) = leastShare;
	}
	remember(world);
	if (id < 0)
		return;
	const std::string body = "ContactDynamics: body #" + std::to_string(id);
	if (!boundOf(scene, id))
		throw SceneError(body
		    + " has no bounds, so others would pass through it. Give the collider a functor for its shape (Bo1_Sphere_Aabb, "
		      "Bo1_Box_Aabb, Bo1_Wall_Aabb), as cd_engine.engines() does, or say that it touches nothing: O.bodies["
		    + std::to_string(id) + "].bounded=False");
	throw SceneError(body
	    + " has narrower bounds than a step needs, so contacts would be found late. Use the collider of cd_engine.engines(), and "
	      "no Bo1_Sphere_Aabb whose aabbEnlargeFactor is below 1");
}

void ColliderRest::remember(cd::World& world)
{
	seen.clear();
	for (const cd::Body& b : world.bodies)
		seen.push_back({ b.x, b.y, b.radius });
	seenShapes = world.shapes;
	if (widens)
		world.listed = margins;
	else
		world.listed.clear();
}

bool ColliderRest::needed(
    cd::World& world, yade::Scene* scene, double dt, double leastMargin, bool listChanged, const std::vector<double>& outran)
{
	const double smallest = cd::smallestRadius(world);
	longest = 0;
	works = collider && leastMargin > 0 && !std::isinf(smallest); // without disks nothing touches
	world.listed.clear();
	if (!works)
		return false;
	least = leastMargin * smallest;
	measure(world, dt, outran);
	longest = fastest / smallest;
	if (!collider->dead) { // so it has run in this step, with the bounds asked for before
		margins.assign(world.bodies.size(), widens ? least : 0);
		const bool slow = !widens || *std::max_element(needs.begin(), needs.end()) <= least;
		if (slow && narrowlyBound(world, scene) < 0) {
			remember(world);
			return false;
		}
		return true;
	}
	return listChanged || seen.size() != world.bodies.size() || !stillComplete(world);
}

int ColliderRest::lost(const cd::World& world) const { return works ? cd::leftBehind(world, quick) : -1; }

void ColliderRest::rest(yade::Scene* scene)
{
	if (!works)
		return wake();
	collider->dead = resting = awaited() || at<long>(scene, layout.scene_stopAtIter) > at<long>(scene, layout.scene_iter) + 1;
}

} // namespace cd_engine
