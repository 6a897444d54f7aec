#include "step/overlap_correction.hpp"

#include <cassert>

namespace cd {

namespace {

	constexpr int sweeps = 4; // every other one backwards; with two a pile swells half as fast
	constexpr double roundOff = 1e-9; // of a disk's radius: a smaller excess stays

	void displace(Body& b, const Motion<double>& by)
	{
		b.x += by.x;
		b.y += by.y;
		b.turn += by.spin;
	}
	void displace(SpaceBody& b, const SpatialMotion<double>& by)
	{
		b.at = b.at + Vector3 { by.x, by.y, by.z };
		b.turn = b.turn + Vector3 { by.spinX, by.spinY, by.spinZ };
	}

} // namespace

template <class Space>
bool OverlapCorrection<Space>::isDue(const WorldOf<Space>& world, const StepSettings<Space>& s, const ContactFinder<Space>& finder)
{
	return s.overlapCorrection > 0 && finder.deepest() > s.allowedOverlap * smallestRadius(world);
}

template <class Space> void OverlapCorrection<Space>::sweep(const Row& c, std::size_t contact, const std::vector<BodyVelocity<Space>>& masses)
{
	MotionOf<Space>&a = displacement[c.a], &b = displacement[c.b];
	const double misses = least[contact] - relativeVelocity<false>(c, a, b).n, before = multiplier[contact];
	if (misses <= 0 && before == 0)
		return;
	const double now = std::max(0., before + misses / c.wnn);
	multiplier[contact] = now;
	ImpulseOf<Space> change {};
	change.n = now - before;
	push(actionOf(c, change), a, motionOf<Space>(masses[c.a].w), b, motionOf<Space>(masses[c.b].w));
}

template <class Space>
bool OverlapCorrection<Space>::operator()(
    WorldOf<Space>& world, const StepView<Space>& step, const ContactFinder<Space>& finder, const std::vector<Row>& contacts)
{
	assert(contacts.size() == finder.pairs().size() && step.bodies.size() >= world.bodies.size());
	const double share = step.settings.overlapCorrection;
	bool any = false;
	least.resize(contacts.size());
	for (std::size_t i = 0; i < contacts.size(); i++) {
		const Row& c = contacts[i];
		const double radius = step.smallerRadius(world.pairs[finder.pairs()[i]]);
		// The gap of the next mid-configuration, to first order.
		const double un = relativeVelocity<false>(c, motionOf<Space>(step.bodies[c.a].v), motionOf<Space>(step.bodies[c.b].v)).n;
		const double excess = -(finder.gap(world, finder.pairs()[i]) + step.dt() * un + step.settings.allowedOverlap * radius);
		const bool pushes = c.wnn > 0 && excess > roundOff * radius;
		least[i] = pushes ? share * excess : std::min(excess, 0.);
		any = any || pushes;
	}
	if (!any)
		return false;
	multiplier.assign(contacts.size(), 0);
	displacement.assign(step.bodies.size(), {});
	for (int k = 0; k < sweeps; k++)
		for (std::size_t i = 0; i < contacts.size(); i++)
			if (const std::size_t at = k % 2 == 0 ? i : contacts.size() - 1 - i; contacts[at].wnn > 0)
				sweep(contacts[at], at, step.bodies);
	for (std::size_t i = 0; i < world.bodies.size(); i++)
		displace(world.bodies[i], displacement[i]);
	return true;
}

template class OverlapCorrection<Plane>;
template class OverlapCorrection<Space3>;

} // namespace cd
