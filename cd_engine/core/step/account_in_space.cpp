#include "step/account_in_space.hpp"
#include "step/account_sums.hpp"

#include <cassert>
#include <utility>

namespace cd {
namespace {

	constexpr double slidingMargin = 1e-9; // as in the plane

	Vector3 normalOf(const ContactRow<Space3>& c) { return { c.nx, c.ny, c.nz }; }
	Vector3 frictionOf(const SpatialComponents<double>& p) { return { p.x, p.y, p.z }; }

	bool slides(double mu, const SpatialComponents<double>& p)
	{
		const double most = mu * p.n * (1 - slidingMargin);
		return mu > 0 && tangentialSquare(p) >= most * most;
	}

	using Energies = SpringEnergies<double>;

	// What the springs of a contact take in a step h, as in the plane.
	Energies energiesOf(const ContactRow<Space3>& c, double kn, double h)
	{
		if (!(c.wnn > 0))
			return {};
		const double resists = 1 / (h * c.cn), dashpot = std::max(0., resists - kn * h), before = std::max(0., -c.bias * resists / kn);
		const double held = c.ct > 0 ? (c.slipX * c.slipX + c.slipY * c.slipY + c.slipZ * c.slipZ) / (c.ct * c.ct) : 0;
		const double storedBefore = 0.5 * kn * before * before + 0.5 * c.ct * held;
		if (!(c.pn > 0))
			return { 0, storedBefore, 0, 0 };
		const double normal = c.bias + c.cn * c.pn, overlap = (c.pn - dashpot * c.bias * resists / kn) / resists;
		const double tangential = c.px * (c.slipX + c.ct * c.px) + c.py * (c.slipY + c.ct * c.py) + c.pz * (c.slipZ + c.ct * c.pz);
		return { 0.5 * kn * overlap * overlap + 0.5 * c.ct * tangentialSquare(impulseOf(c)), storedBefore, c.pn * normal + tangential,
			h * dashpot * normal * normal };
	}

	// Writes the force of a contact, unless it has it: then it is not written again, because it would differ in the last digit when read.
	bool write(SpaceCarried& was, const Vector3& n, const SpatialComponents<double>& p, double dt, long iteration)
	{
		const Vector3 friction = frictionOf(p);
		if (was.any() && was.n == n && dt * was.normalForce() == p.n && dt * was.ft == friction)
			return false;
		was = { n, p.n / dt * n, 1 / dt * friction, was.any() ? was.since : iteration };
		return true;
	}

	// Calls give(body, impulse) for both bodies of a contact.
	template <class Give>
	void giveBoth(
	    const Pair& pair, const BodyMotion<Space3>& motion, const SpaceTouch& touch, const SpatialComponents<double>& p, const Give& give)
	{
		const Vector3 on = p.n * touch.n + frictionOf(p);
		for (const int side : { -1, 1 }) {
			const int32_t body = side < 0 ? pair.a : pair.b;
			const Vector3 force = side * on, turn = cross(touch.c - motion.places()[body].at, force);
			give(body, Account<Space3>::Impulse { force.x, force.y, force.z, turn.x, turn.y, turn.z });
		}
	}

} // namespace

void Account<Space3>::begin()
{
	if (!std::exchange(known, true))
		sums.clear();
}

void Account<Space3>::clear(const Sleepers<Space3>& sleepers)
{
	if (sleepers.none())
		return sums.clear();
	for (std::size_t i = 0; i < sums.size(); i++)
		if (!sleepers.sleeps(static_cast<int32_t>(i)))
			sums[i] = {};
}

void Account<Space3>::book(WorldOf<Space3>& world, const StepView<Space3>& step, const ContactFinder<Space3>& finder, const ProblemBuilder<Space3>&,
    const ContactRows<Space3>& contacts, const ContactRow<RollingPlane>*, Sleepers<Space3>& sleepers, StepReport& report)
{
	assert(contacts.size() == finder.pairs().size());
	const auto bookRange = [&](std::size_t from, std::size_t to) {
		const bool anyAsleep = !sleepers.none();
		const auto count = static_cast<int32_t>(world.bodies.size());
		const std::vector<SpaceMean>& means = step.motion.means();
		Totals sum { 0, 0, from > 0 ? 0 : report.dissipated };
		for (std::size_t i = from; i < to; i++) {
			const ContactRow<Space3>& c = contacts[i];
			const int32_t index = finder.pairs()[i];
			const Pair& pair = world.pairs[index];
			const SpatialComponents<double> p = impulseOf(c);
			const Energies springs = world.compliant() ? energiesOf(c, world.stiffnesses[index].kn, step.dt()) : Energies {};
			sum.springs = sum.springs + Energies { 0, springs.before, 0, 0 };
			if (p.n <= 0) {
				release<Space3>(pair, world.carried[index], sleepers);
				continue;
			}
			if (write(world.carried[index], normalOf(c), p, step.dt(), step.settings.iteration) && anyAsleep)
				sleepers.disturb(pair.a, pair.b);
			// The impulse works on the mean of the relative velocities before and after.
			const double* const a = c.a < count ? means[c.a].v : step.bodies[c.a].v;
			const double work = dot(p, relativeVelocity<false>(c, motionOf<Space3>(a), motionOf<Space3>(means[c.b].v)));
			const bool asleep = anyAsleep && sleepers.islandAt(pair.a, pair.b); // then it counts with its island
			sum.loaded += !asleep;
			sum.sliding += !asleep && slides(pair.mu, p);
			sum.dissipated -= work + springs.absorbed;
			sum.work += std::abs(work);
			sum.springs = sum.springs + Energies { asleep ? 0 : springs.stored, 0, springs.absorbed, springs.dashpots };
		}
		return sum;
	};
	bookAll(world, step, finder, contacts.size(), sleepers, bookRange, report);
	known = !sleepers.none();
	if (known)
		bookSleeping(world, step, finder, contacts, sleepers, report);
}

void Account<Space3>::bookSleeping(const WorldOf<Space3>& world, const StepView<Space3>& step, const ContactFinder<Space3>& finder,
    const ContactRows<Space3>& contacts, Sleepers<Space3>& sleepers, StepReport& report)
{
	const auto slidesAt = [&](std::size_t i) { return slides(contacts[i].mu, impulseOf(contacts[i])); };
	const auto stored = [&](std::size_t i) { return energiesOf(contacts[i], world.stiffnesses[finder.pairs()[i]].kn, step.dt()).stored; };
	const auto give = [&](std::size_t i, const auto& to) {
		const int32_t pair = finder.pairs()[i];
		giveBoth(world.pairs[pair], step.motion, finder.touch(step, pair), impulseOf(contacts[i]), to);
	};
	addSleeping(world, finder, contacts, slidesAt, stored, give, sums, sleepers, report);
}

const std::vector<Account<Space3>::Impulse>& Account<Space3>::impulses(const WorldOf<Space3>& world, const ContactFinder<Space3>& finder,
    const BodyMotion<Space3>& motion, const ContactRows<Space3>& contacts, const ContactRow<RollingPlane>*)
{
	sums.resize(world.bodies.size());
	if (std::exchange(known, true))
		return sums;
	std::fill(sums.begin(), sums.end(), Impulse {});
	for (std::size_t i = 0; i < finder.pairs().size(); i++) {
		const int32_t index = finder.pairs()[i];
		if (contacts[i].pn > 0) // what the pair carries has the normal of the step
			giveBoth(world.pairs[index], motion, finder.touchOf(world, index, motion), impulseOf(contacts[i]),
			    [&](int32_t body, const Impulse& impulse) { add(sums[body], impulse); });
	}
	return sums;
}

} // namespace cd
