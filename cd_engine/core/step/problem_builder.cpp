#include "step/problem_builder.hpp"
#include "step/pair_lanes.hpp"

#include <cassert>

namespace cd {
namespace {

	// Of a belt along t where it is touched [m/s]: across it the surface stays. Divided by 1 rad/s it is the lever arm of the contact
	// (motion.hpp).
	double surfaceSpeed(const StepView<Plane>& step, int32_t body, const Touch& touch)
	{
		const auto& [vx, vy, spin] = step.world.surfaces[body];
		const Place& place = step.place(body);
		return touch.nx * (vy + spin * (touch.cx - place.x)) - touch.ny * (vx - spin * (touch.cy - place.y));
	}

} // namespace

// The impulse that a contact has carried (the kernel repeats this, see RowSettings), within the present friction cone, since a guess within the
// tolerance becomes the step's solution.
std::array<double, 2> ProblemBuilder<Plane>::guess(const StepView<Plane>& step, std::size_t pair) const
{
	if (!step.settings.warmStart)
		return { 0, 0 };
	const auto [pn, pt] = step.world.carried[pair].impulse(step.dt());
	return { pn, cutGuess<double>({ pn, pt }, step.world.pairs[pair].mu, insideCone) };
}

// The row of any pair. turned: the change of its gap by the rotation of its boundary.
ContactRow<Plane> ProblemBuilder<Plane>::makeRow(
    const StepView<Plane>& step, const ContactFinder<Plane>& finder, std::size_t index, double& turned) const
{
	const Pair& pair = step.world.pairs[index];
	const Touch touch = step.locate(pair);
	const double gap = finder.gap(step.world, index);
	const Place& place = step.place(pair.a);
	// The spin before the step: a torque that the contacts balance does not turn the box.
	turned = step.turning(pair, touch, gap, step.world.bodies[pair.a].v[2]);
	const double radius = step.smallerRadius(pair), allowed = step.settings.allowedOverlap * radius;
	const bool pushes = !step.world.compliant() && gap < -std::max(pushedOut, step.settings.allowedOverlap) * radius;
	const double bias = ((gap > 0 ? gap : pushes ? step.settings.gapCorrection * (gap + allowed) : 0) + turned) / step.dt();
	// Arms of disks: from the centre along the normal.
	const double armA = place.radius - 0.5 * touch.overlap, armB = step.place(pair.b).radius - 0.5 * touch.overlap;
	const auto [pn, pt] = guess(step, index);
	ContactRow<Plane> c { pair.a, pair.b, touch.nx, touch.ny, 0, armA, 0, -armB, bias, pair.mu, 0, 0, 0, pn, pt };
	if (isBoundary(place)) {
		const double ax = touch.cx - place.x, ay = touch.cy - place.y;
		c.an = ax * touch.ny - ay * touch.nx;
		c.at = ax * touch.nx + ay * touch.ny;
	}
	if (step.world.isBelt(c.a)) {
		c.an = 0;
		c.at = surfaceSpeed(step, c.a, touch);
	}
	if (step.world.isBelt(c.b)) {
		c.bn = 0;
		c.bt = surfaceSpeed(step, c.b, touch);
	}
	c.assembleBlock(step.bodies[c.a], step.bodies[c.b]);
	if (step.world.compliant())
		soften(step, finder, index, turned, c);
	if (!(c.wnn > 0))
		c.pn = c.pt = 0; // two immobile bodies: forces that springs left between them have no meaning here
	return c;
}

// Gives a row the stiffness of its pair (contact_system.hpp; the kernel repeats this). What friction holds is a spring whose force the contact has
// carried.
void ProblemBuilder<Plane>::soften(
    const StepView<Plane>& step, const ContactFinder<Plane>& finder, std::size_t pair, double turned, ContactRow<Plane>& c)
{
	const auto [kn, kt] = step.world.stiffnesses[pair];
	const double h = step.dt(), damping = step.settings.dampingRatio;
	const double dashpot = damping > 0 && c.wnn > 0 ? 2 * damping * std::sqrt(kn / c.wnn) : 0;
	const Springs<double> springs { kn, kt, dashpot, finder.gap(step.world, pair) + turned, step.world.carried[pair].impulse(h)[1] };
	const Spring<double> yields = yieldOf(springs, h);
	c.bias = biasOf(springs, h);
	c.cn = yields.n;
	c.ct = yields.t;
	c.slipBias = yields.bias;
	c.mu = kt > 0 ? c.mu : 0;
	moveOn(step, kn, c);
}

// From the impulse that a contact with stiffness has carried to the first guess.
void ProblemBuilder<Plane>::moveOn(const StepView<Plane>& step, double kn, ContactRow<Plane>& c)
{
	const auto before = [&](int32_t i) { return motionOf<Plane>(step.velocityBefore(i)); };
	const Components<double> u = relativeVelocity<false>(c, before(c.a), before(c.b));
	const Components<double> guess = movedOn(impulseOf(c), u, kn, c.ct, step.dt());
	c.pn = guess.n;
	c.pt = c.mu > 0 ? cutGuess(guess, c.mu, insideCone) : 0;
}

void ProblemBuilder<Plane>::demandRebound(
    const StepView<Plane>& step, const ContactFinder<Plane>& finder, std::size_t contact, ContactRow<Plane>& c, double turned)
{
	const int32_t pair = finder.pairs()[contact];
	const Body &a = step.world.bodies[c.a], &b = step.world.bodies[c.b];
	const double un = relativeVelocity<false>(c, motionOf<Plane>(a.v), motionOf<Plane>(b.v)).n;
	c.bias = rebounds.demand(contact, step, pair, { finder.gap(step.world, pair), turned, un }, c);
}

// Fills rows from their pairs. The kernel makes those of two disks that can move and turn. In the others it leaves wnn = 0, and they are made here.
void ProblemBuilder<Plane>::fillRows(
    const StepView<Plane>& step, const ContactFinder<Plane>& finder, ContactRow<Plane>* rows, std::size_t from, std::size_t to)
{
	const std::vector<int32_t>& pairOf = finder.pairs();
	for (; from < to; from += batch) {
		const std::size_t count = std::min(batch, to - from);
		PairLanes pairs[groupsInBatch];
		load<true>(step, count, pairs, [&](std::size_t k) { return pairOf[from + k]; });
		groupKernel<Plane>().assemble(
		    step.motion.places().data(), step.bodies.data(), step.world.carried.data(), pairs, rows + from, count, rowSettings(step));
		for (std::size_t i = from; i < from + count; i++) {
			ContactRow<Plane>& c = rows[i];
			double turned = 0;
			specialOf[i] = c.wnn > 0 ? -1 : 0;
			if (isSpecial(i))
				c = makeRow(step, finder, pairOf[i], turned);
			if (!step.settings.warmStart)
				c.pn = c.pt = 0;
			if (step.settings.restitution > 0)
				demandRebound(step, finder, i, c, turned);
		}
	}
}

void ProblemBuilder<Plane>::fillAll(ContactRow<Plane>* rows, std::size_t count)
{
	forRanges(&step->threads, count, [&](std::size_t from, std::size_t to) { fillRows(*step, *finder, rows, from, to); });
}

void ProblemBuilder<Plane>::build(
    const StepView<Plane>& now, const ContactFinder<Plane>& found, ContactSystem<Plane>& system, bool same, bool postpones)
{
	assert(system.bodies.size() == now.world.bodies.size() && now.world.carried.size() == now.world.pairs.size());
	const std::size_t count = found.pairs().size();
	step = &now;
	finder = &found;
	system.contactSet += !same;
	specialOf.resize(count);
	rebounds.restart(now, now.settings.restitution > 0 ? count : 0);
	if (same && postpones && makeSpecials())
		return system.contacts.postpone(*this, count);
	system.contacts.forgetSource();
	system.contacts.resize(count);
	fillAll(system.contacts.all().data(), count);
	numbered = false;
}

void ProblemBuilder<Plane>::append(const StepView<Plane>& now, const ContactFinder<Plane>& found, ContactSystem<Plane>& system)
{
	assert(now.settings.restitution == 0);
	system.contacts.make();
	system.contactSet++;
	const std::size_t before = system.contacts.size(), count = found.pairs().size();
	system.contacts.resize(count);
	specialOf.resize(count);
	fillRows(now, found, system.contacts.all().data(), before, count);
	numbered = false;
	for (std::size_t i = before; i < count; i++) {
		ContactRow<Plane>& c = system.contacts[i];
		const double un = relativeVelocity(c, system.bodies[c.a], system.bodies[c.b]).n;
		c.pn = c.wnn > 0 ? std::max(0., -(un + c.bias) / c.nn()) : 0;
		c.pt = 0;
	}
}

void ProblemBuilder<Plane>::guessAgain(const StepView<Plane>& now, const ContactFinder<Plane>& found, ContactSystem<Plane>& system, bool warm) const
{
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const auto [pn, pt] = warm && i < found.foundFirst() ? guess(now, found.pairs()[i]) : std::array<double, 2> { 0, 0 };
		system.contacts[i].pn = pn;
		system.contacts[i].pt = pt;
		if (now.world.compliant())
			moveOn(now, now.world.stiffnesses[found.pairs()[i]].kn, system.contacts[i]);
	}
}

bool ProblemBuilder<Plane>::lowerRebounds(
    const StepView<Plane>& now, ContactSystem<Plane>& system, const SolverReport& report, double tolerance, bool last)
{
	if (!rebounds.any())
		return false;
	if (report.contact >= 0 && report.status != Status::converged && report.status != Status::diverged)
		return rebounds.giveUp(system, report.contact);
	// A gap correction adds energy by itself, so this test does not apply to it.
	const bool unsolved = report.status == Status::max_iterations || report.status == Status::stagnated;
	return now.settings.gapCorrection == 0 && (report.status == Status::converged || unsolved)
	    && rebounds.lower(system, now.world.bodies, now.dt(), tolerance, now.settings.restitution, unsolved || last);
}

// The rows that the kernel cannot make, for contacts that are the same as in the last step. Returns whether all can be solved
// and, if they are rigid, none has a negative bias, as is so of all others.
bool ProblemBuilder<Plane>::makeSpecials()
{
	if (!numbered) {
		specials.clear();
		for (std::size_t i = 0; i < specialOf.size(); i++)
			if (isSpecial(i)) {
				specialOf[i] = static_cast<int32_t>(specials.size());
				specials.push_back(static_cast<int32_t>(i));
			}
		numbered = true;
	}
	const World& world = step->world;
	const auto pairAt = [&](std::size_t k) { return finder->pairs()[specials[k]]; };
	specialRows.resize(specials.size());
	for (std::size_t k = 0; k < specials.size(); k++) {
		// They are far from each other in memory: first the pairs are prefetched, then their bodies.
		if (k + 8 < specials.size()) {
			__builtin_prefetch(&world.pairs[pairAt(k + 8)]);
			__builtin_prefetch(&world.carried[pairAt(k + 8)]);
			finder->prefetch(pairAt(k + 8));
		}
		if (k + 4 < specials.size()) {
			const int32_t disk = world.pairs[pairAt(k + 4)].b;
			__builtin_prefetch(&step->place(disk));
			__builtin_prefetch(&step->bodies[disk]);
		}
		double turned;
		specialRows[k] = makeRow(*step, *finder, pairAt(k), turned);
		if (!(specialRows[k].wnn > 0) || !(specialRows[k].bias >= 0 || world.compliant()))
			return false;
	}
	return true;
}

void ProblemBuilder<Plane>::makeRows(std::vector<ContactRow<Plane>>& all)
{
	fillAll(all.data(), all.size());
	for (std::size_t k = 0; k < specials.size(); k++) {
		all[specials[k]] = specialRows[k]; // made before the solution, which may have turned a box
		specialOf[specials[k]] = static_cast<int32_t>(k);
	}
}

ContactRow<Plane> ProblemBuilder<Plane>::row(int32_t contact) const
{
	if (isSpecial(contact))
		return specialRows[specialOf[contact]];
	double turned;
	return makeRow(*step, *finder, finder->pairs()[contact], turned);
}

void ProblemBuilder<Plane>::fill(
    const int32_t* contacts, std::size_t count, const double* inverseRadius, Group<Plane>* groups, GroupSprings<Plane>* springs, uint8_t* left) const
{
	const World& world = step->world;
	PairLanes pairs[groupsInBatch];
	const RowSettings settings = rowSettings(*step);
	for (std::size_t from = 0; from < count; from += groupsInBatch, contacts += batch) {
		const std::size_t here = std::min(groupsInBatch, count - from);
		const auto which = [&](std::size_t k) { return finder->pairs()[std::max(contacts[k], 0)]; };
		if (from + groupsInBatch < count) // the next ones: no processor predicts the addresses in the order of the groups
			for (std::size_t k = batch; k < 2 * batch && k < (count - from) * PairLanes::lanes; k++) {
				__builtin_prefetch(&world.pairs[which(k)]);
				__builtin_prefetch(&world.carried[which(k)]);
			}
		load<true>(*step, here * PairLanes::lanes, pairs, which, inverseRadius);
		for (std::size_t k = 0; k < here; k++) {
			unsigned unknown = groupKernel<Plane>().assembleGroup(step->motion.places().data(), step->bodies.data(), world.carried.data(),
			    pairs[k], groups[from + k], springs ? springs + from + k : nullptr, settings);
			for (std::size_t lane = 0; lane < PairLanes::lanes; lane++)
				unknown |= static_cast<unsigned>(contacts[k * PairLanes::lanes + lane] < 0) << lane;
			left[from + k] = static_cast<uint8_t>(unknown);
		}
	}
}

} // namespace cd
