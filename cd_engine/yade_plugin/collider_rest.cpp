#include "collider_rest.hpp"
#include "waiting.hpp"
#include "scene_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd_engine {
namespace {

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

	// The bounds of a body; null if it has none, or does not exist.
	char* boundOf(yade::Scene* scene, int id)
	{
		char* const body = reinterpret_cast<char*>((*at<boost::shared_ptr<yade::BodyContainer>>(scene, layout.scene_bodies))[id].get());
		return body ? static_cast<char*>(pointer<yade::Bound>(body, layout.body_bound)) : nullptr;
	}

} // namespace

void ColliderRest::attach(boost::shared_ptr<yade::Engine> engine)
{
	wake();
	collider = std::move(engine);
	widens = takesVerletDist(collider);
	width = 0;
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

bool ColliderRest::stillComplete(const cd::World& world, const cd::Reach& reach) const
{
	if (seen.size() != world.bodies.size())
		return false;
	for (std::size_t i = 0; i < seen.size(); i++) {
		const cd::Body& b = world.bodies[i];
		if (b.radius != seen[i].radius)
			return false;
		if (b.alone)
			continue;
		double way = std::max(std::abs(b.x - seen[i].x), std::abs(b.y - seen[i].y));
		if (b.radius == 0) {
			const cd::Shape &now = world.shapes[i], &then = seenShapes[i];
			if (now.kind != then.kind || now.ex != then.ex || now.ey != then.ey || now.axis != then.axis || now.sense != then.sense)
				return false;
			if (now.kind == cd::ShapeKind::box)
				way += std::hypot(now.ex, now.ey) * (std::abs(now.cosine - then.cosine) + std::abs(now.sine - then.sine));
		}
		if (!(way <= width - 0.5 * reach.gap)) // each of two bodies for half of the gap
			return false;
	}
	return true;
}

// Sets the bounds so wide that all pairs that a step may take for contacts are listed. True if the width has changed.
bool ColliderRest::widen(const cd::Reach& reach, double leastMargin)
{
	const double least = leastMargin * reach.smallestRadius, needed = 0.5 * reach.gap;
	if (width >= std::max(needed, least) && width <= std::max(4 * needed, least))
		return false;
	width = std::max(1.5 * needed, least);
	at<double>(collider.get(), layout.collider_verletDist) = width;
	at<int>(collider.get(), layout.collider_targetInterv) = -1; // the width is not to be guessed from the ways made before
	return true;
}

// The first body, by its id, that does not lie within its bounds by the width, or has none; -1 if all do.
int ColliderRest::narrowlyBound(const cd::World& world, yade::Scene* scene) const
{
	// A box's corners are known as well as the quaternion of its orientation is a unit one.
	constexpr double roundOff = 8 * std::numeric_limits<double>::epsilon(), unit = 1e-9;
	for (int id = 0; id < static_cast<int>(world.bodies.size()); id++) {
		char* const bound = boundOf(scene, id);
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

void ColliderRest::search(const cd::World& world, yade::Scene* scene)
{
	collider->scene = scene;
	collider->action();
	remember(world);
	const int id = narrowlyBound(world, scene);
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

void ColliderRest::remember(const cd::World& world)
{
	seen.clear();
	for (const cd::Body& b : world.bodies)
		seen.push_back({ b.x, b.y, b.radius });
	seenShapes = world.shapes;
}

// A body that needs wide bounds but that nobody comes near gets none; its pairs are complete without.
void ColliderRest::findAlone(cd::World& world, double dt, double leastMargin)
{
	for (const int id : alone)
		if (id < static_cast<int>(world.bodies.size()))
			world.bodies[id].alone = false;
	alone.clear();
	const cd::Reach reach = cd::reach(world, dt);
	const double least = leastMargin * reach.smallestRadius;
	if (leastMargin > 0 && 0.5 * reach.gap > least && std::isfinite(reach.way))
		alone = fastAndAlone.find(world, dt, 0.5 * least);
	for (const int id : alone)
		world.bodies[id].alone = true;
}

bool ColliderRest::needed(cd::World& world, yade::Scene* scene, double dt, double leastMargin, bool listChanged)
{
	findAlone(world, dt, leastMargin);
	const cd::Reach reach = cd::reach(world, dt);
	longest = reach.way / reach.smallestRadius;
	works = collider && leastMargin > 0 && !std::isinf(reach.smallestRadius); // without disks nothing touches
	if (!works)
		return false;
	const bool widened = widens && widen(reach, leastMargin);
	const bool awake = !collider->dead; // so it has run in this step, with the bounds asked for before
	if (awake && !widened && narrowlyBound(world, scene) < 0) {
		remember(world);
		return false;
	}
	return widened || awake || listChanged || !stillComplete(world, reach);
}

void ColliderRest::rest(yade::Scene* scene)
{
	if (!works)
		return wake();
	collider->dead = resting = awaited() || at<long>(scene, layout.scene_stopAtIter) > at<long>(scene, layout.scene_iter) + 1;
}

} // namespace cd_engine
