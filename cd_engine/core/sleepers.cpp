#include "sleepers.hpp"

#include <algorithm>
#include <numeric>

namespace cd {
namespace {

	bool isImmobile(const Body& b) { return b.inverseMass[0] == 0 && b.inverseMass[1] == 0 && b.inverseMass[2] == 0; }

	bool isStill(const Body& b) { return b.v[0] == 0 && b.v[1] == 0 && b.v[2] == 0; }

	// Compares all that a step reads; forces only where they have an effect.
	bool isSame(const Body& b, const Body& c)
	{
		bool same = b.x == c.x && b.y == c.y && b.radius == c.radius && b.friction == c.friction;
		for (int k = 0; k < 3; k++)
			same
			    = same && b.v[k] == c.v[k] && b.inverseMass[k] == c.inverseMass[k] && (b.inverseMass[k] == 0 || b.force[k] == c.force[k]);
		return same;
	}

	bool isSame(const Shape& s, const Shape& t)
	{
		return s.kind == t.kind && s.ex == t.ex && s.ey == t.ey && s.cosine == t.cosine && s.sine == t.sine && s.axis == t.axis
		    && s.sense == t.sense;
	}

} // namespace

void Sleepers::resize(std::size_t count)
{
	if (count < nameOf.size())
		list.clear(); // bodies were removed
	if (list.empty())
		nameOf.assign(count, -1);
	nameOf.resize(count, -1);
	indexOf.resize(count);
	quiet.resize(count);
	bodies.resize(count);
	shapes.resize(count);
}

// Keeps the memory of an island. An island that is looked at now and then, and sleeps on, then allocates nothing.
void Sleepers::recycle(SleepingIsland& island)
{
	if (island.onImmobile.capacity() == 0)
		return;
	island.onImmobile.clear();
	memory.push_back(std::move(island.onImmobile));
}

void Sleepers::wakeAll(World& world)
{
	if (!list.empty())
		last = { "settings, or which bodies are near each other, have changed", -1 };
	for (SleepingIsland& island : list)
		recycle(island);
	list.clear();
	std::fill(nameOf.begin(), nameOf.end(), -1);
	std::fill(quiet.begin(), quiet.end(), 0);
	world.awake.resize(world.pairs.size());
	std::iota(world.awake.begin(), world.awake.end(), 0);
}

void Sleepers::look(World& world)
{
	if (!none())
		resize(world.bodies.size());
	if (none()) {
		if (world.awake.size() != world.pairs.size())
			wakeAll(world);
		return;
	}
	bool changes = compareBodies(world);
	for (SleepingIsland& island : list)
		for (const Push& push : island.onImmobile)
			if (!quiet[push.body])
				island.disturb("a boundary that it touches was moved or changed", push.body);
	changes = removeDisturbed(false) || changes;
	for (SleepingIsland& island : list)
		island.found = false;
	if (changes)
		listAwake(world);
}

// Finds which bodies are quiet and which islands disturbed. Returns whether the set of quiet bodies has changed.
bool Sleepers::compareBodies(const World& world)
{
	bool changes = false;
	for (std::size_t i = 0; i < world.bodies.size(); i++) {
		const Body& now = world.bodies[i];
		const bool asleep = nameOf[i] >= 0, immobile = isImmobile(now);
		const bool still
		    = (asleep || immobile) && isStill(now) && isSame(now, bodies[i]) && (now.radius > 0 || isSame(world.shapes[i], shapes[i]));
		if (asleep && !still)
			islandOf(static_cast<int32_t>(i))
			    .disturb("a body was moved or changed, or another force acts on it", static_cast<int32_t>(i));
		if (immobile && !asleep) {
			bodies[i] = now;
			shapes[i] = world.shapes[i];
		}
		changes = changes || quiet[i] != still;
		quiet[i] = still;
	}
	return changes;
}

// Removes the islands that meet the condition. Returns whether there were any.
template <class Condition> bool Sleepers::remove(Condition condition)
{
	if (std::none_of(list.begin(), list.end(), condition))
		return false;
	for (std::size_t i = 0; i < nameOf.size(); i++)
		if (nameOf[i] >= 0 && condition(islandOf(static_cast<int32_t>(i)))) {
			nameOf[i] = -1;
			quiet[i] = false;
		}
	for (SleepingIsland& island : list)
		if (condition(island))
			recycle(island);
	list.erase(std::remove_if(list.begin(), list.end(), condition), list.end());
	number();
	return true;
}

// Removes the islands in which something has changed; sleepingOn: only those that this step has not looked at.
bool Sleepers::removeDisturbed(bool sleepingOn)
{
	const auto wakes = [sleepingOn](const SleepingIsland& island) { return island.disturbed.what && !(sleepingOn && island.found); };
	const auto first = std::find_if(list.begin(), list.end(), wakes);
	if (first == list.end())
		return false;
	last = first->disturbed;
	return remove(wakes);
}

void Sleepers::number()
{
	for (std::size_t k = 0; k < list.size(); k++)
		indexOf[list[k].name] = static_cast<int32_t>(k);
}

// A pair of quiet bodies, of which at least one sleeps, stays as it is; all other pairs are listed.
void Sleepers::listAwake(World& world) const
{
	world.awake.clear();
	for (std::size_t i = 0; i < world.pairs.size(); i++) {
		const Pair& pair = world.pairs[i];
		if (!quiet[pair.a] || !quiet[pair.b] || (nameOf[pair.a] < 0 && nameOf[pair.b] < 0))
			world.awake.push_back(static_cast<int32_t>(i));
	}
}

bool Sleepers::wake(const ContactRows& contacts, World& world)
{
	if (none())
		return false;
	for (const ContactRow& c : contacts)
		for (const int32_t body : { c.a, c.b })
			if (sleepsOn(body))
				islandOf(body).disturb("a body that is awake came near", body == c.a ? c.b : c.a);
	const bool any = removeDisturbed(true);
	if (any)
		listAwake(world);
	return any;
}

void Sleepers::startSearch(std::size_t count)
{
	resize(count);
	remove([](const SleepingIsland& island) { return island.found; });
}

void Sleepers::add(int32_t name, const ResidualSum& error)
{
	list.emplace_back();
	list.back().name = name;
	list.back().error = error;
	if (!memory.empty()) {
		list.back().onImmobile = std::move(memory.back());
		memory.pop_back();
	}
}

void Sleepers::finishSearch()
{
	std::sort(list.begin(), list.end(), [](const SleepingIsland& a, const SleepingIsland& b) { return a.name < b.name; });
	number();
}

void Sleepers::join(int32_t body, int32_t name, int unknowns)
{
	nameOf[body] = name;
	islandOf(body).unknowns += unknowns;
}

void Sleepers::remember(const World& world)
{
	if (std::none_of(list.begin(), list.end(), [](const SleepingIsland& island) { return island.found; }))
		return;
	bodies = world.bodies;
	shapes = world.shapes;
}

} // namespace cd
