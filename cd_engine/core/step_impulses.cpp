// The impulses of a step on its bodies. Few steps are published, so they are summed when somebody asks, except where islands sleep.
#include "step_geometry.hpp"

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

// The effect of a contact's impulse on both of its bodies.
TimeStep::Share TimeStep::share(const ContactRow& c, double overlap) const
{
	const Place &a = places[c.a], &b = places[c.b];
	const double x = c.nx * c.pn - c.ny * c.pt, y = c.ny * c.pn + c.nx * c.pt;
	// A disk takes the impulse on its rim, so only the tangential part turns it. The arm of a boundary starts at its centre.
	const double arm = b.radius - 0.5 * overlap;
	const double turnA = a.radius > 0 ? (a.radius - 0.5 * overlap) * c.pt : (b.x - arm * c.nx - a.x) * y - (b.y - arm * c.ny - a.y) * x;
	return { c.a, c.b, x, y, -turnA, -arm * c.pt };
}

// Gives the impulse of a contact to both of its bodies.
void TimeStep::give(const Share& of)
{
	add(impulses[of.a], -of.x, -of.y, of.turnA);
	add(impulses[of.b], of.x, of.y, of.turnB);
}

// Adds a share to the bodies of a sleeping island, and to the list of its impulses on immobile bodies.
void TimeStep::push(const Share& of, int32_t island, int32_t row)
{
	const auto addTo = [&](int32_t body, double x, double y, double turn) {
		if (sleepers.sleeps(body))
			add(impulses[body], x, y, turn);
		else
			sleepers.push({ island, row, body, { x, y, turn } });
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
	// In the order of the contacts, which decides the last digits.
	for (std::size_t i = 0; i < rowPair.size(); i++) {
		const Pair& pair = world.pairs[rowPair[i]];
		ContactRow c;
		if (!spared)
			c = system.contacts[i];
		else if (specialOf[i] >= 0)
			c = specialRows[specialOf[i]];
		else { // two disks
			const Touch touch = locate(pair, world);
			c.a = pair.a;
			c.b = pair.b;
			c.nx = touch.nx;
			c.ny = touch.ny;
		}
		if (spared) {
			c.pn = system.contacts.solution()[2 * i];
			c.pt = system.contacts.solution()[2 * i + 1];
		}
		if (c.pn > 0)
			give(share(c, overlaps[rowPair[i]]));
	}
	return impulses;
}

} // namespace cd
