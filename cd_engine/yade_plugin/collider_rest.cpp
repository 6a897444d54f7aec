#include "collider_rest.hpp"
#include "waiting.hpp"

namespace cd_engine {

void ColliderRest::attach(boost::shared_ptr<yade::Engine> engine)
{
	wake();
	collider = std::move(engine);
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
	if (collider && collider->getClassName() == "InsertionSortCollider")
		at<bool>(collider.get(), layout.collider_doSort) = true;
}

void ColliderRest::rest(yade::Scene* scene)
{
	if (collider)
		collider->dead = resting = awaited() || at<long>(scene, layout.scene_stopAtIter) > at<long>(scene, layout.scene_iter) + 1;
}

int32_t ColliderRest::maskApart() const { return collider ? at<int>(collider.get(), layout.collider_avoidSelfInteractionMask) : 0; }

} // namespace cd_engine
