#include "step/account_sums.hpp"
#include "step/pair_lanes.hpp"

#include <cassert>
#include <type_traits>
#include <utility>

namespace cd {
namespace {

	// A contact whose tangential impulse is within this fraction of the cone slides; the solvers put sliding impulses on the cone
	// to round-off, and a sticking one lies this close by chance with negligible probability.
	constexpr double slidingMargin = 1e-9;

	// How many contacts ahead data are prefetched: what pairs carry, and the pairs of the batch after the next.
	constexpr std::size_t carriedAhead = 48, pairsAhead = 128;

	bool slides(double mu, double pn, double pt) { return mu > 0 && std::abs(pt) >= mu * pn * (1 - slidingMargin); }

	using Energies = SpringEnergies<double>;

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
	// plain: rigid contacts without rolling resistance, and no body sleeps. Without their branches a pass has a fifth fewer instructions.
	const auto bookRange = [&](auto plain, std::size_t from, std::size_t to) {
		constexpr bool isPlain = decltype(plain)::value;
		// Copies, because to the compiler a store to what a pair carries might change what is captured.
		const double dt = step.dt(), rate = 1 / dt;
		const int32_t* const pairOf = finder.pairs().data();
		const Pair* const pairs = world.pairs.data();
		Carried* const carried = world.carried.data();
		const bool anyAsleep = !isPlain && !sleepers.none();
		const ContactRow<RollingPlane>* const rollingRows = isPlain ? nullptr : rolling;
		const RowSettings settings = rowSettings(step);
		const Stiffness* const stiffnesses = !isPlain && world.compliant() ? world.stiffnesses.data() : nullptr;
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
				if (rollingRows && stiffnesses)
					addSpring(rollingRows[i], e, l);
				if (stiffnesses)
					sum.springs.before += e.before[l];
				if (pn <= 0) {
					release<Plane>(pair, was, sleepers);
					continue;
				}
				const double nx = e.nx[l], ny = e.ny[l];
				const ContactRow<RollingPlane>* const moved = rollingRows ? rollingRows + i : nullptr;
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
	const bool plain = sleepers.none() && !rolling && !world.compliant();
	const auto book = [&](std::size_t from, std::size_t to) {
		return plain ? bookRange(std::true_type(), from, to) : bookRange(std::false_type(), from, to);
	};
	bookAll(world, step, finder, contacts.size(), sleepers, book, report);
	known = !sleepers.none();
	if (known)
		bookSleeping(world, step, finder, contacts, rolling, sleepers, report);
}

void Account<Plane>::bookSleeping(const World& world, const StepView<Plane>& step, const ContactFinder<Plane>& finder,
    const ContactRows<Plane>& contacts, const ContactRow<RollingPlane>* rolling, Sleepers<Plane>& sleepers, StepReport& report)
{
	const auto slidesAt = [&](std::size_t i) { return slides(contacts[i].mu, contacts[i].pn, contacts[i].pt); };
	const auto stored = [&](std::size_t i) {
		const double kn = world.stiffnesses[finder.pairs()[i]].kn;
		return energiesOf(contacts[i], impulseOf(contacts[i]), kn, step.dt()).stored + (rolling ? rollingEnergiesOf(rolling[i]).stored : 0);
	};
	const auto give = [&](std::size_t i, const auto& to) {
		const ContactRow<Plane>& c = contacts[i];
		const int32_t pair = finder.pairs()[i];
		giveBoth(world.pairs[pair], step.motion.places(), finder.overlap(pair), { c.nx, c.ny }, c.pn, c.pt, momentOf(rolling, i), to);
	};
	addSleeping(world, finder, contacts, slidesAt, stored, give, sums, sleepers, report);
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
