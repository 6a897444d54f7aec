#include "step/account.hpp"
#include "step/pair_lanes.hpp"

#include <cassert>
#include <utility>

namespace cd {
namespace {

	// A contact whose tangential impulse is within this fraction of the cone slides; the solvers put sliding impulses on the cone
	// to round-off, and a sticking one lies this close by chance with negligible probability.
	constexpr double onCone = 1e-9;

	// How many contacts ahead data are prefetched: what pairs carry, and the pairs of the batch after the next.
	constexpr std::size_t carriedAhead = 48, pairsAhead = 128;

	bool slides(double mu, double pn, double pt) { return mu > 0 && std::abs(pt) >= mu * pn * (1 - onCone); }

	using Energies = SpringEnergies<double>; // members of StepReport [J]
	Energies operator+(const Energies& a, const Energies& b)
	{
		return { a.stored + b.stored, a.before + b.before, a.absorbed + b.absorbed, a.dashpots + b.dashpots };
	}

	struct Totals {
		int loaded = 0, sliding = 0;
		double dissipated = 0, work = 0; // [J]
		Energies springs {};
	};

	// Of the springs of a contact in a step h, from its row (ProblemBuilder::soften).
	Energies energiesOf(const ContactRow<Plane>& c, const Components<double>& p, double kn, double h)
	{
		if (!(c.wnn > 0))
			return {};
		const double resists = 1 / (h * c.cn), held = c.ct > 0 ? -c.slipBias / c.ct : 0;
		const Springs<double> springs { kn, c.ct > 0 ? 1 / (c.ct * h * h) : 0, std::max(0., resists - kn * h), c.bias * resists / kn, held };
		return cd::energiesOf(springs, p, h);
	}

	// Of its spring against rolling.
	Energies rollingEnergiesOf(const ContactRow<RollingPlane>& c)
	{
		if (!(c.cr > 0))
			return {};
		const double held = c.rollBias / c.cr, before = 0.5 * c.cr * held * held;
		return c.pn > 0 ? Energies { 0.5 * c.cr * c.pr * c.pr, before, c.pr * (c.rollBias + c.cr * c.pr), 0 } : Energies { 0, before, 0, 0 };
	}
	void addSpring(const ContactRow<RollingPlane>& c, PairEffects& to, std::size_t lane)
	{
		const Energies of = rollingEnergiesOf(c);
		to.stored[lane] += of.stored;
		to.before[lane] += of.before;
		to.absorbed[lane] += of.absorbed;
	}

	// Nothing is left of what the contact of a pair has carried. An island in which a force changes does not sleep.
	void release(const Pair& pair, Carried& was, Sleepers<Plane>& sleepers)
	{
		if (!was.any())
			return;
		sleepers.disturb(pair.a, pair.b);
		was = {};
	}

	// Whether a contact already has the right force. It is not written again, because it would differ in the last digit when read.
	inline bool keeps(double nx, double ny, double pn, double pt, const ContactRow<RollingPlane>* rolling, Carried& was, double dt)
	{
		if (was.nx != nx || was.ny != ny || !was.any() || was.impulse(dt) != std::array<double, 2> { pn, pt })
			return false;
		if (rolling ? dt * was.moment / rolling->length != rolling->pr : was.moment != 0)
			return false;
		if (std::signbit(was.nx) != std::signbit(nx) || std::signbit(was.ny) != std::signbit(ny)) { // springs may leave -0
			was.nx = nx;
			was.ny = ny;
		}
		return true;
	}

	// What the kernel finds for contacts of disks, for any contact. kn: of its spring, 0 if it is rigid; h: the step.
	void effectOf(const ContactRow<Plane>& c, const std::vector<Mean>& means, const Components<double>& p, double kn, double h, PairEffects& e,
	    std::size_t lane)
	{
		// The impulse works on the mean of the relative velocities before and after. This is exact for the kinetic energy, M being constant.
		const Components<double> u = relativeVelocity<false>(c, motionOf<Plane>(means[c.a].v), motionOf<Plane>(means[c.b].v));
		e.nx[lane] = c.nx;
		e.ny[lane] = c.ny;
		e.work[lane] = dot(p, u);
		if (!(kn > 0))
			return;
		const Energies energies = energiesOf(c, p, kn, h);
		e.stored[lane] = energies.stored;
		e.before[lane] = energies.before;
		e.absorbed[lane] = energies.absorbed;
		e.dashpots[lane] = energies.dashpots;
	}

	void add(Account<Plane>::Impulse& to, const Account<Plane>::Impulse& of)
	{
		for (int k = 0; k < 3; k++)
			to[k] += of[k];
	}

	double momentOf(const ContactRow<RollingPlane>* rolling, std::size_t contact)
	{
		return rolling ? rolling[contact].pr * rolling[contact].length : 0;
	}

	// Calls give(body, impulse) for both bodies of a contact. n: its normal; moment: on the second body [N m s].
	template <class Give>
	inline void giveBoth(
	    const Pair& pair, const std::vector<Place>& places, double overlap, Vector n, double pn, double pt, double moment, const Give& give)
	{
		const Place &a = places[pair.a], &b = places[pair.b];
		const double x = n.x * pn - n.y * pt, y = n.y * pn + n.x * pt;
		// A disk takes the impulse on its rim, so only the tangential part turns it. The arm of a boundary starts at its centre.
		const double arm = b.radius - 0.5 * overlap;
		const double turn = isBoundary(a) ? (b.x - arm * n.x - a.x) * y - (b.y - arm * n.y - a.y) * x : (a.radius - 0.5 * overlap) * pt;
		give(pair.a, Account<Plane>::Impulse { -x, -y, -turn - moment });
		give(pair.b, Account<Plane>::Impulse { x, y, -arm * pt + moment });
	}

} // namespace

void Account<Plane>::begin()
{
	if (!std::exchange(known, true))
		sums.clear();
}

void Account<Plane>::clear(const Sleepers<Plane>& sleepers)
{
	if (sleepers.none())
		return sums.clear();
	for (std::size_t i = 0; i < sums.size(); i++)
		if (!sleepers.sleeps(static_cast<int32_t>(i)))
			sums[i] = { 0, 0, 0 };
}

void Account<Plane>::book(World& world, const StepView<Plane>& step, const ContactFinder<Plane>& finder, const ProblemBuilder<Plane>& builder,
    const ContactRows<Plane>& contacts, const ContactRow<RollingPlane>* rolling, Sleepers<Plane>& sleepers, StepReport& report)
{
	spared = contacts.postponed();
	assert(contacts.size() == finder.pairs().size() && (!spared || (sleepers.none() && contacts.solvedBeside())));
	const std::vector<Mean>& means = step.motion.means();
	const ContactRow<Plane>* const rows = spared ? nullptr : contacts.all().data();
	const Components<double>* const solution = contacts.solution();
	const auto bookRange = [&](std::size_t from, std::size_t to) {
		// Copies, because to the compiler a store to what a pair carries might change what is captured.
		const double dt = step.dt(), rate = 1 / dt;
		const int32_t* const pairOf = finder.pairs().data();
		const Pair* const pairs = world.pairs.data();
		Carried* const carried = world.carried.data();
		const bool anyAsleep = !sleepers.none();
		const RowSettings settings = rowSettings(step);
		const Stiffness* const stiffnesses = world.compliant() ? world.stiffnesses.data() : nullptr;
		Totals sum { 0, 0, from > 0 ? 0 : report.dissipated };
		const auto later = [pairOf, last = contacts.size() - 1](std::size_t i) { return pairOf[std::min(i, last)]; };
		for (; from < to; from += batch) {
			const std::size_t count = std::min(batch, to - from);
			Components<double> impulses[batch];
			for (std::size_t k = 0; rows && k < count; k++)
				impulses[k] = impulseOf(rows[from + k]);
			const Components<double>* const p = rows ? impulses : solution + from;
			PairLanes lanes[groupsInBatch];
			PairEffects effects[groupsInBatch];
			const auto which = [&](std::size_t k) { return pairOf[from + k]; };
			const std::size_t groups = stiffnesses ? load<true>(step, count, lanes, which) : load<false>(step, count, lanes, which);
			groupKernel<Plane>().effects(
			    step.motion.places().data(), means.data(), step.bodies.data(), carried, p, count, lanes, effects, groups, settings);
			for (std::size_t k = 0; k < count; k++) {
				const std::size_t i = from + k, l = k % PairLanes::lanes;
				__builtin_prefetch(&carried[later(i + carriedAhead)], 1);
				__builtin_prefetch(&pairs[later(i + pairsAhead)]);
				const Pair& pair = pairs[pairOf[i]];
				Carried& was = carried[pairOf[i]];
				PairEffects& e = effects[k / PairLanes::lanes];
				const double pn = p[k].n, pt = p[k].t;
				if (builder.isSpecial(i))
					effectOf(rows ? rows[i] : builder.specialRow(i), means, p[k], stiffnesses ? stiffnesses[pairOf[i]].kn : 0, dt,
					    e, l);
				if (rolling && stiffnesses)
					addSpring(rolling[i], e, l);
				if (stiffnesses)
					sum.springs.before += e.before[l];
				if (pn <= 0) {
					release(pair, was, sleepers);
					continue;
				}
				const double nx = e.nx[l], ny = e.ny[l];
				const ContactRow<RollingPlane>* const moved = rolling ? rolling + i : nullptr;
				if (!keeps(nx, ny, pn, pt, moved, was, dt)) {
					const double fn = pn * rate, ft = pt * rate;
					was.nx = nx;
					was.ny = ny;
					was.fn[0] = fn * nx;
					was.fn[1] = fn * ny;
					was.ft[0] = -ft * ny;
					was.ft[1] = ft * nx;
					was.moment = moved ? moved->pr * moved->length * rate : 0;
					was.since = was.any() ? was.since : step.settings.iteration;
					if (anyAsleep)
						sleepers.disturb(pair.a, pair.b);
				}
				const bool asleep = anyAsleep && sleepers.islandAt(pair.a, pair.b); // then it counts with its island
				sum.loaded += !asleep;
				sum.sliding += !asleep && slides(pair.mu, pn, pt);
				if (moved)
					e.work[l] += moved->pr
					    * cd::rolling<double>(*moved, motionOf<Plane>(means[pair.a].v), motionOf<Plane>(means[pair.b].v));
				sum.dissipated -= e.work[l];
				if (!stiffnesses)
					continue;
				sum.dissipated -= e.absorbed[l]; // p . s, with the slip s
				sum.work += std::abs(e.work[l]);
				sum.springs = sum.springs + Energies { asleep ? 0 : e.stored[l], 0, e.absorbed[l], e.dashpots[l] };
			}
		}
		return sum;
	};
	// Only one thread may report what it wakes.
	const Totals all = reduceRanges<Totals>(
	    sleepers.none() ? &step.threads : nullptr, contacts.size(), bookRange, [](const Totals& a, const Totals& b) -> Totals {
		    return { a.loaded + b.loaded, a.sliding + b.sliding, a.dissipated + b.dissipated, a.work + b.work, a.springs + b.springs };
	    });
	if (contacts.size() < world.awake.size())
		for (const int32_t i : world.awake)
			if (!finder.isContact(i))
				release(world.pairs[i], world.carried[i], sleepers);
	report.loadedContacts += all.loaded;
	report.slidingContacts += all.sliding;
	report.dissipated = all.dissipated;
	report.work = all.work;
	report.stored = all.springs.stored;
	report.storedBefore = all.springs.before;
	report.absorbed = all.springs.absorbed;
	report.dashpots = all.springs.dashpots;
	known = !sleepers.none();
	if (known)
		bookSleeping(world, step, finder, contacts, rolling, sleepers, report);
}

// Sums the impulses, and adds what sleeping islands contribute: those that this step has examined and the others.
void Account<Plane>::bookSleeping(const World& world, const StepView<Plane>& step, const ContactFinder<Plane>& finder,
    const ContactRows<Plane>& contacts, const ContactRow<RollingPlane>* rolling, Sleepers<Plane>& sleepers, StepReport& report)
{
	sums.resize(world.bodies.size());
	sleepers.powerless.clear();
	for (std::size_t i = 0; i < contacts.size(); i++) {
		const ContactRow<Plane>& c = contacts[i];
		const int32_t pair = finder.pairs()[i];
		SleepingIsland* const asleep = sleepers.islandAt(c.a, c.b);
		if (asleep && !(c.wnn > 0)) {
			sleepers.powerless.push_back(pair);
			continue;
		}
		if (asleep) {
			report.contacts--;
			asleep->contacts++;
			asleep->deepest = std::max(asleep->deepest, -finder.gap(world, pair));
			if (i >= finder.foundFirst()) // a contact that was added later is none in the next step
				sleepers.disturb(asleep->name, "a contact came late", c.a);
			asleep->loaded += c.pn > 0;
			asleep->sliding += c.pn > 0 && slides(c.mu, c.pn, c.pt);
			if (world.compliant())
				asleep->stored += energiesOf(c, impulseOf(c), world.stiffnesses[pair].kn, step.dt()).stored
				    + (rolling ? rollingEnergiesOf(rolling[i]).stored : 0);
		}
		if (asleep || c.pn > 0)
			giveBoth(world.pairs[pair], step.motion.places(), finder.overlap(pair), { c.nx, c.ny }, c.pn, c.pt, momentOf(rolling, i),
			    [&](int32_t body, const Impulse& impulse) {
				    if (!asleep || sleepers.sleeps(body))
					    add(sums[body], impulse);
				    else
					    sleepers.addBoundaryImpulse({ asleep->name, static_cast<int32_t>(i), body, impulse });
			    });
	}
	for (const SleepingIsland& island : sleepers.islands()) {
		report.contacts += island.contacts;
		report.loadedContacts += island.loaded;
		report.slidingContacts += island.sliding;
		report.stored += island.stored;
		report.maxPenetration = std::max(report.maxPenetration, island.deepest);
	}
	for (const auto& of : sleepers.boundaryImpulses())
		add(sums[of.body], of.impulse);
}

const std::vector<Account<Plane>::Impulse>& Account<Plane>::impulses(const World& world, const ContactFinder<Plane>& finder,
    const BodyMotion<Plane>& motion, const ContactRows<Plane>& contacts, const ContactRow<RollingPlane>* rolling)
{
	sums.resize(world.bodies.size());
	if (std::exchange(known, true))
		return sums;
	std::fill(sums.begin(), sums.end(), Impulse {});
	const ContactRow<Plane>* const rows = spared ? nullptr : contacts.all().data();
	const Components<double>* const solution = contacts.solution();
	// In the order of the contacts, which decides the last digits.
	for (std::size_t i = 0; i < finder.pairs().size(); i++) {
		const auto [pn, pt] = rows ? impulseOf(rows[i]) : solution[i];
		const int32_t pair = finder.pairs()[i];
		const Carried& carried = world.carried[pair]; // it has the normal of the step
		if (pn > 0)
			giveBoth(world.pairs[pair], motion.places(), finder.overlap(pair), { carried.nx, carried.ny }, pn, pt, momentOf(rolling, i),
			    [&](int32_t body, const Impulse& impulse) { add(sums[body], impulse); });
	}
	return sums;
}

} // namespace cd
