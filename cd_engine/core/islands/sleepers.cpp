#include "islands/sleepers.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace cd {
namespace {

	// Whether a body does not move and all that a step reads of it is as before; forces only where they have an effect.
	template <class Space> bool rests(const BodyOf<Space>& b, const BodyOf<Space>& c)
	{
		bool same = samePlace(b, c);
		for (int k = 0; k < Space::freedoms; k++)
			same = same && b.v[k] == 0 && c.v[k] == 0 && b.inverseMass[k] == c.inverseMass[k]
			    && (b.inverseMass[k] == 0 || b.force[k] == c.force[k]);
		return same;
	}

} // namespace

template <class Space> void Sleepers<Space>::wakeAll(World& world, const Cause& why)
{
	if (!none())
		last = why;
	of.clear();
	list.clear();
	impulses.clear();
	powerless.clear();
	world.awake.resize(world.pairs.size());
	std::iota(world.awake.begin(), world.awake.end(), 0);
}

template <class Space> void Sleepers<Space>::update(World& world)
{
	assert(world.shapes.size() == world.bodies.size());
	if (none() ? world.awake.size() != world.pairs.size() : of.size() != world.bodies.size())
		wakeAll(world);
	if (none())
		return;
	const uint8_t* const still = world.stillSince(seen);
	seen = world.reading;
	for (std::size_t i = 0; i < of.size(); i++) {
		if (still && still[i] && of[i] == unchanged)
			continue;
		const auto body = static_cast<int32_t>(i);
		const Body& now = world.bodies[i];
		const bool immobile = isGuided(now);
		if (of[i] == awake && !immobile)
			continue;
		const bool same = rests<Space>(now, bodies[i]) && (!isBoundary(now) || world.shapes[i] == shapes[i]);
		if (of[i] >= 0) {
			if (!same)
				disturb(body, "a body was moved or changed, or another force acts on it", body);
			continue;
		}
		changed = changed || (of[i] == unchanged) != (immobile && same);
		of[i] = immobile && same ? unchanged : awake;
		bodies[i] = now;
		shapes[i] = world.shapes[i];
	}
	for (const BoundaryImpulse& on : impulses)
		if (of[on.body] == awake)
			disturb(on.island, "a boundary that it touches was moved or changed", on.body);
	wakeDisturbed(world);
}

template <class Space> bool Sleepers<Space>::wake(const ContactRows<Space>& contacts, World& world)
{
	if (none())
		return false;
	for (const ContactRow<Space>& c : contacts)
		for (const int32_t body : { c.a, c.b })
			if (c.wnn > 0) // else nothing passes through it
				disturb(body, "a body that is awake came near", body == c.a ? c.b : c.a);
	return wakeDisturbed(world);
}

template <class Space> void Sleepers<Space>::disturb(int32_t body, const char* what, int32_t with)
{
	if (sleeps(body) && !islandOf(body).disturbed.what)
		islandOf(body).disturbed = { what, with };
}

template <class Space> SleepingIsland& Sleepers<Space>::islandOf(int32_t body)
{
	return *std::lower_bound(list.begin(), list.end(), of[body], [](const SleepingIsland& island, int32_t name) { return island.name < name; });
}

// Wakes the islands in which something has changed, and returns whether there were any. Then lists the pairs that a step examines: all
// but those of two bodies that rest, of which one sleeps. Contacts that cannot push are listed also there.
template <class Space> bool Sleepers<Space>::wakeDisturbed(World& world)
{
	const auto wakes = [](const SleepingIsland& island) { return island.disturbed.what != nullptr; };
	const auto first = std::find_if(list.begin(), list.end(), wakes);
	const bool any = first != list.end();
	if (any) {
		last = first->disturbed;
		for (std::size_t i = 0; i < of.size(); i++)
			if (of[i] >= 0 && wakes(islandOf(static_cast<int32_t>(i))))
				of[i] = awake;
		impulses.erase(
		    std::remove_if(impulses.begin(), impulses.end(), [&](const BoundaryImpulse& on) { return of[on.island] < 0; }), impulses.end());
		list.erase(std::remove_if(first, list.end(), wakes), list.end());
	}
	if (!any && !changed)
		return false;
	changed = false;
	world.awake.clear();
	for (std::size_t i = 0; i < world.pairs.size(); i++)
		if (const int32_t a = of[world.pairs[i].a], b = of[world.pairs[i].b]; a == awake || b == awake || (a < 0 && b < 0))
			world.awake.push_back(static_cast<int32_t>(i));
	if (!powerless.empty()) {
		world.awake.insert(world.awake.end(), powerless.begin(), powerless.end());
		std::sort(world.awake.begin(), world.awake.end());
		world.awake.erase(std::unique(world.awake.begin(), world.awake.end()), world.awake.end());
	}
	return any;
}

template <class Space> void Sleepers<Space>::add(const World& world, const std::vector<SleepingIsland>& found, const std::vector<int32_t>& names)
{
	assert(names.size() >= world.bodies.size() || found.empty());
	assert(std::is_sorted(found.begin(), found.end()));
	if (found.empty())
		return;
	changed = true;
	of.resize(world.bodies.size(), awake);
	for (const SleepingIsland& island : found)
		of[island.name] = island.name;
	for (std::size_t i = 0; i < of.size(); i++)
		if (of[names[i]] == names[i])
			of[i] = names[i];
	bodies = world.bodies;
	shapes = world.shapes;
	list.insert(list.end(), found.begin(), found.end());
	std::sort(list.begin(), list.end());
}

template <class Space> auto Sleepers<Space>::boundaryImpulses() -> const std::vector<BoundaryImpulse>&
{
	if (!std::is_sorted(impulses.begin(), impulses.end()))
		std::sort(impulses.begin(), impulses.end());
	return impulses;
}

template class Sleepers<Plane>;
template class Sleepers<Space3>;

} // namespace cd
