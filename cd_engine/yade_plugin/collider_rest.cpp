#include "collider_rest.hpp"
#include "../core/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd_engine {

void ColliderRest::attach(boost::shared_ptr<yade::Engine> engine, boost::shared_ptr<yade::Factorable> functor)
{
	wake();
	collider = std::move(engine);
	bounds = std::move(functor);
	margin = 0;
	seen.clear();
}

void ColliderRest::wake()
{
	if (collider && resting)
		collider->dead = false;
	resting = false;
}

bool ColliderRest::stillComplete(const cd::World& world, double reach) const
{
	if (seen.size() != world.bodies.size())
		return false;
	// Half the margin of a disk is for its own way, half for its partner's; a boundary shares with the smallest disk.
	double smallest = std::numeric_limits<double>::infinity();
	for (const cd::Body& b : world.bodies)
		if (b.shape.kind == cd::ShapeKind::disk && b.shape.radius > 0)
			smallest = std::min(smallest, b.shape.radius);
	for (std::size_t i = 0; i < seen.size(); i++) {
		const cd::Body& b = world.bodies[i];
		const cd::Shape &now = b.shape, &then = seen[i].shape;
		if (now.kind != then.kind || now.radius != then.radius || now.ex != then.ex || now.ey != then.ey || now.axis != then.axis
		    || now.sense != then.sense)
			return false;
		double way = std::max(std::abs(b.x - seen[i].x), std::abs(b.y - seen[i].y));
		if (now.kind == cd::ShapeKind::box)
			way += std::hypot(now.ex, now.ey) * (std::abs(now.cosine - then.cosine) + std::abs(now.sine - then.sine));
		const double radius = now.kind == cd::ShapeKind::disk ? now.radius : smallest;
		if (!(way <= 0.5 * (margin * radius - reach)))
			return false;
	}
	return true;
}

// Sets the bounds so wide that no two bodies can meet within the step unless they are a pair: contact is required half a step ahead
// and kept for one more, so each of two bodies may go 1.5 ways. True if the bounds have changed.
bool ColliderRest::widen(const cd::World& world, double dt, double leastMargin)
{
	double smallest = std::numeric_limits<double>::infinity();
	for (const cd::Body& b : world.bodies)
		if (b.shape.kind == cd::ShapeKind::disk && b.shape.radius > 0)
			smallest = std::min(smallest, b.shape.radius);
	const double needed = 3 * cd::fastestWay(world, dt) / smallest;
	if (margin >= std::max(needed, leastMargin) && margin <= std::max(4 * needed, leastMargin))
		return false;
	margin = std::max(1.5 * needed, leastMargin);
	at<double>(bounds.get(), layout.bounds_aabbEnlargeFactor) = 1 + margin;
	return true;
}

void ColliderRest::refresh(const cd::World& world, yade::Scene* scene, double dt, double leastMargin, bool listChanged)
{
	if (!collider || !bounds || leastMargin <= 0) {
		wake();
		return;
	}
	const bool widened = widen(world, dt, leastMargin);
	bool runs = !collider->dead;
	if (widened || (!runs && (listChanged || !stillComplete(world, cd::reach(world, dt))))) {
		collider->scene = scene;
		collider->action();
		runs = true;
	}
	if (runs) {
		seen.clear();
		for (const cd::Body& b : world.bodies)
			seen.push_back({ b.x, b.y, b.shape });
	}
	collider->dead = resting = at<long>(scene, layout.scene_stopAtIter) > at<long>(scene, layout.scene_iter) + 1;
}

} // namespace cd_engine
