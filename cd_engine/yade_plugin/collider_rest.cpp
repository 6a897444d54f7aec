#include "collider_rest.hpp"

#include <algorithm>
#include <cmath>

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

bool ColliderRest::stillComplete(const cd::World& world, const cd::Reach& reach) const
{
	if (seen.size() != world.bodies.size())
		return false;
	for (std::size_t i = 0; i < seen.size(); i++) {
		const cd::Body& b = world.bodies[i];
		if (b.radius != seen[i].radius)
			return false;
		double way = std::max(std::abs(b.x - seen[i].x), std::abs(b.y - seen[i].y));
		if (b.radius == 0) {
			const cd::Shape &now = world.shapes[i], &then = seenShapes[i];
			if (now.kind != then.kind || now.ex != then.ex || now.ey != then.ey || now.axis != then.axis || now.sense != then.sense)
				return false;
			if (now.kind == cd::ShapeKind::box)
				way += std::hypot(now.ex, now.ey) * (std::abs(now.cosine - then.cosine) + std::abs(now.sine - then.sine));
		}
		// Half the margin of a disk is for its own way, half for its partner's; a boundary shares with the smallest disk.
		const double radius = b.radius > 0 ? b.radius : reach.smallestRadius;
		if (!(way <= 0.5 * (margin * radius - reach.gap)))
			return false;
	}
	return true;
}

// Sets the bounds so wide that no two bodies can meet within the step unless they are a pair: contact is required half a step ahead
// and kept for one more, so each of two bodies may go 1.5 ways. True if the bounds have changed.
bool ColliderRest::widen(const cd::Reach& reach, double leastMargin)
{
	const double needed = 3 * reach.way / reach.smallestRadius;
	if (margin >= std::max(needed, leastMargin) && margin <= std::max(4 * needed, leastMargin))
		return false;
	margin = std::max(1.5 * needed, leastMargin);
	at<double>(bounds.get(), layout.bounds_aabbEnlargeFactor) = 1 + margin;
	return true;
}

bool ColliderRest::refresh(const cd::World& world, yade::Scene* scene, double dt, double leastMargin, bool listChanged)
{
	if (!collider || !bounds || leastMargin <= 0) {
		wake();
		return false;
	}
	const cd::Reach reach = cd::reach(world, dt);
	const bool widened = widen(reach, leastMargin);
	const bool awake = !collider->dead;
	const bool runs = widened || (!awake && (listChanged || !stillComplete(world, reach)));
	if (runs) {
		collider->scene = scene;
		collider->action();
	}
	if (runs || awake) {
		seen.clear();
		for (const cd::Body& b : world.bodies)
			seen.push_back({ b.x, b.y, b.radius });
		seenShapes = world.shapes;
	}
	collider->dead = resting = at<long>(scene, layout.scene_stopAtIter) > at<long>(scene, layout.scene_iter) + 1;
	return runs;
}

} // namespace cd_engine
