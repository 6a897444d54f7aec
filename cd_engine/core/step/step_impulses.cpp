// The impulses of a step on its bodies. Few steps are published, so the impulses are summed only when somebody asks for them, except in a step with
// sleeping islands, which keep theirs.
#include "step/time_step.hpp"

#include <algorithm>
#include <utility>

namespace cd {
namespace {

	void add(std::array<double, 3>& on, double x, double y, double turn)
	{
		on[0] += x;
		on[1] += y;
		on[2] += turn;
	}

} // namespace

// The effect of a contact's impulse on both bodies of its pair.
inline TimeStep::Share TimeStep::share(const World& world, std::size_t index, Vector n, double pn, double pt) const
{
	const Pair& pair = world.pairs[index];
	const Place &a = places[pair.a], &b = places[pair.b];
	const double x = n.x * pn - n.y * pt, y = n.y * pn + n.x * pt;
	// A disk takes the impulse on its rim, so only the tangential part turns it. The arm of a boundary starts at its centre.
	const double overlap = overlaps[index], arm = b.radius - 0.5 * overlap;
	const double turnA = a.radius > 0 ? (a.radius - 0.5 * overlap) * pt : (b.x - arm * n.x - a.x) * y - (b.y - arm * n.y - a.y) * x;
	return { pair.a, pair.b, x, y, -turnA, -arm * pt };
}

// Gives the impulse of a contact to both of its bodies.
inline void TimeStep::give(const Share& of)
{
	add(impulses[of.a], -of.x, -of.y, of.turnA);
	add(impulses[of.b], of.x, of.y, of.turnB);
}

void TimeStep::give(const World& world, std::size_t row)
{
	const ContactRow& c = system.contacts[row];
	give(share(world, rowPair[row], { c.nx, c.ny }, c.pn, c.pt));
}

// Adds the impulse of a contact to the bodies of a sleeping island, and to the list of its impulses on immobile bodies.
void TimeStep::push(const World& world, std::size_t row, int32_t island)
{
	const ContactRow& c = system.contacts[row];
	const Share of = share(world, rowPair[row], { c.nx, c.ny }, c.pn, c.pt);
	const auto addTo = [&](int32_t body, double x, double y, double turn) {
		if (sleepers.sleeps(body))
			add(impulses[body], x, y, turn);
		else
			sleepers.push({ island, static_cast<int32_t>(row), body, { x, y, turn } });
	};
	addTo(of.a, -of.x, -of.y, of.turnA);
	addTo(of.b, of.x, of.y, of.turnB);
}

// Before a step tells its islands to sleep: those of bodies that sleep already stay.
void TimeStep::clearImpulses()
{
	if (sleepers.none())
		return impulses.clear();
	for (std::size_t i = 0; i < impulses.size(); i++)
		if (!sleepers.sleeps(static_cast<int32_t>(i)))
			impulses[i] = { 0, 0, 0 };
}

const std::vector<std::array<double, 3>>& TimeStep::impulsesOn(const World& world)
{
	impulses.resize(world.bodies.size());
	if (std::exchange(impulsesKnown, true))
		return impulses;
	std::fill(impulses.begin(), impulses.end(), std::array<double, 3> {});
	const ContactRow* const rows = spared ? nullptr : system.contacts.all().data();
	const double* const solution = system.contacts.solution();
	// In the order of the contacts, which decides the last digits.
	for (std::size_t i = 0; i < rowPair.size(); i++) {
		const double pn = rows ? rows[i].pn : solution[2 * i], pt = rows ? rows[i].pt : solution[2 * i + 1];
		const Carried& carried = world.carried[rowPair[i]]; // it has the normal of the step
		if (pn > 0)
			give(share(world, rowPair[i], { carried.nx, carried.ny }, pn, pt));
	}
	return impulses;
}

} // namespace cd
