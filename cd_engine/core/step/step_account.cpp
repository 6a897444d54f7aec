// Applies the impulses of a step to the pairs, the bodies and the energy.
#include "kernels/kernels.hpp"
#include "step/time_step.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	// A contact whose tangential impulse is within this fraction of the cone slides; the solvers put sliding impulses on the cone
	// to round-off, and a sticking one lies this close by chance with negligible probability.
	constexpr double onCone = 1e-9;

	// How many contacts ahead data are prefetched: the bodies of rows, and without rows what pairs carry, and the pairs of the batch after the
	// next.
	constexpr size_t bodiesAhead = 12, carriedAhead = 48, pairsAhead = 128;

	bool slides(double mu, double pn, double pt) { return mu > 0 && std::abs(pt) >= mu * pn * (1 - onCone); }

} // namespace

// Nothing is left of what the contact of a pair has carried. An island in which a force changes does not sleep.
void TimeStep::release(const Pair& pair, Carried& was)
{
	if (!was.any())
		return;
	sleepers.disturb(pair.a, pair.b);
	was = {};
}

// Whether a contact already has the right force. It is not written again, because it would differ in the last digit when read.
inline bool TimeStep::keeps(double nx, double ny, double pn, double pt, Carried& was, double dt)
{
	if (was.nx != nx || was.ny != ny || !was.any() || was.impulse(dt) != std::array<double, 2> { pn, pt })
		return false;
	if (std::signbit(was.nx) != std::signbit(nx) || std::signbit(was.ny) != std::signbit(ny)) { // springs may leave -0
		was.nx = nx;
		was.ny = ny;
	}
	return true;
}

// Sums over the contacts of a range.
struct TimeStep::Account {
	int loaded = 0, sliding = 0;
	double dissipated = 0; // [J]
};

// What the impulse of a contact does.
struct TimeStep::Effect {
	int32_t a, b; // bodies
	double nx, ny, fnx, fny, ftx, fty; // as in Carried, whose members would have to be set to 0 first
	double mu, pn, pt;
	double work; // [J]
};

inline TimeStep::Effect TimeStep::effectOf(const ContactRow& c, double rate) const
{
	const double fn = c.pn * rate, ft = c.pt * rate;
	// The impulse works on the mean of the relative velocities before and after. This is exact for the kinetic energy, M being constant.
	const Components<double> u = relativeVelocity<false>(c, motionOf(means[c.a].v), motionOf(means[c.b].v));
	return { c.a, c.b, c.nx, c.ny, fn * c.nx, fn * c.ny, -ft * c.ny, ft * c.nx, c.mu, c.pn, c.pt, c.pn * u.n + c.pt * u.t };
}

// Books the effect of a contact on its pair and the sums. Inlined, so that no effect goes through memory.
[[gnu::always_inline]] inline void TimeStep::book(
    World& world, const StepSettings& settings, size_t row, const Effect& e, bool anyAsleep, Account& sum)
{
	const int32_t pair = rowPair[row];
	Carried& was = world.carried[pair];
	if (e.pn <= 0)
		return release(world.pairs[pair], was);
	if (!keeps(e.nx, e.ny, e.pn, e.pt, was, settings.dt)) {
		was.nx = e.nx;
		was.ny = e.ny;
		was.fn[0] = e.fnx;
		was.fn[1] = e.fny;
		was.ft[0] = e.ftx;
		was.ft[1] = e.fty;
		was.since = was.any() ? was.since : settings.iteration;
		if (anyAsleep)
			sleepers.disturb(e.a, e.b);
	}
	const bool asleep = anyAsleep && sleepers.islandAt(e.a, e.b);
	sum.loaded += !asleep;
	sum.sliding += !asleep && slides(e.mu, e.pn, e.pt);
	sum.dissipated -= e.work;
}

// The same for `count` postponed contacts, at most `batch`. Contacts are postponed only if nothing sleeps.
inline void TimeStep::bookPostponed(World& world, const StepSettings& settings, double rate, size_t from, size_t count, Account& sum)
{
	PairEffects effects[batch / PairLanes::lanes];
	effectsOf(world, rate, from, count, effects);
	const double* const p = system.contacts.solution() + 2 * from;
	for (size_t k = 0; k < count; k++) {
		const size_t i = from + k, l = k % PairLanes::lanes;
		const auto later = [&](size_t by) { return rowPair[std::min(i + by, rowPair.size() - 1)]; };
		__builtin_prefetch(&world.carried[later(carriedAhead)], 1);
		__builtin_prefetch(&world.pairs[later(pairsAhead)]);
		const Pair& pair = world.pairs[rowPair[i]];
		const PairEffects& e = effects[k / PairLanes::lanes];
		if (specialOf[i] >= 0) {
			ContactRow c = specialRows[specialOf[i]];
			c.pn = p[2 * k];
			c.pt = p[2 * k + 1];
			book(world, settings, i, effectOf(c, rate), false, sum);
			continue;
		}
		book(world, settings, i,
		    { pair.a, pair.b, e.nx[l], e.ny[l], e.fn[0][l], e.fn[1][l], e.ft[0][l], e.ft[1][l], pair.mu, p[2 * k], p[2 * k + 1], e.work[l] },
		    false, sum);
	}
}

TimeStep::Account TimeStep::account(World& world, const StepSettings& settings, double dissipated, size_t from, size_t to)
{
	const double rate = 1 / settings.dt;
	Account sum;
	sum.dissipated = dissipated;
	if (system.contacts.postponed()) {
		for (; from < to; from += batch)
			bookPostponed(world, settings, rate, from, std::min(batch, to - from), sum);
		return sum;
	}
	const ContactRow* const rows = system.contacts.all().data();
	for (size_t i = from; i < to; i++) {
		if (i + bodiesAhead < to) {
			__builtin_prefetch(&means[rows[i + bodiesAhead].a]);
			__builtin_prefetch(&means[rows[i + bodiesAhead].b]);
		}
		book(world, settings, i, effectOf(rows[i], rate), !sleepers.none(), sum);
	}
	return sum;
}

void TimeStep::finishContacts(World& world, const StepSettings& settings, StepReport& report)
{
	clearImpulses();
	if (settings.reduce)
		solveIslands.putToSleep(sleepers, world);
	if (!sleepers.none() || !system.contacts.solvedBeside())
		system.contacts.make();
	spared = system.contacts.postponed();
	const Account all = reduceRanges<Account>(
	    sleepers.none() ? &threads : nullptr, // only one thread may report what it wakes
	    system.contacts.size(), [&](size_t from, size_t to) { return account(world, settings, from > 0 ? 0 : report.dissipated, from, to); },
	    [](const Account& a, const Account& b) {
		    return Account { a.loaded + b.loaded, a.sliding + b.sliding, a.dissipated + b.dissipated };
	    });
	if (rowPair.size() < world.awake.size())
		for (const int32_t i : world.awake)
			if (!solved[i])
				release(world.pairs[i], world.carried[i]);
	report.loadedContacts += all.loaded;
	report.slidingContacts += all.sliding;
	report.dissipated = all.dissipated;
	impulsesKnown = !sleepers.none();
	if (!impulsesKnown)
		return;
	impulses.resize(world.bodies.size());
	sleepers.powerless.clear();
	for (size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow& c = system.contacts[i];
		SleepingIsland* const asleep = sleepers.islandAt(c.a, c.b);
		if (asleep && !(c.wnn > 0))
			sleepers.powerless.push_back(rowPair[i]);
		else if (asleep) {
			report.contacts--;
			asleep->contacts++;
			asleep->deepest = std::max(asleep->deepest, -gapOf(world, rowPair[i]));
			if (i >= assembled) // a contact that was added later is none in the next step
				sleepers.disturb(asleep->name, "a contact came late", c.a);
			asleep->loaded += c.pn > 0;
			asleep->sliding += c.pn > 0 && slides(c.mu, c.pn, c.pt);
			push(world, i, asleep->name);
		} else if (c.pn > 0)
			give(world, i);
	}
}

// Adds what sleeping islands contribute, those that this step has looked at and the others.
void TimeStep::finishSleepers(StepReport& report)
{
	for (const SleepingIsland& island : sleepers.islands()) {
		report.contacts += island.contacts;
		report.loadedContacts += island.loaded;
		report.slidingContacts += island.sliding;
		report.maxPenetration = std::max(report.maxPenetration, island.deepest);
	}
	for (const Push& push : sleepers.pushes())
		for (int k = 0; k < 3; k++)
			impulses[push.body][k] += push.impulse[k];
}

} // namespace cd
