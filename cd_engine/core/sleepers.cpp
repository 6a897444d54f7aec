#include "sleepers.hpp"

#include <algorithm>
#include <numeric>

namespace cd {
namespace {

	bool isImmobile(const Body& b) { return b.inverseMass[0] == 0 && b.inverseMass[1] == 0 && b.inverseMass[2] == 0; }

	bool isStill(const Body& b) { return b.v[0] == 0 && b.v[1] == 0 && b.v[2] == 0; }

	// In all that a step reads; forces where they can do something.
	bool isSame(const Body& b, const Body& c)
	{
		bool same = b.x == c.x && b.y == c.y && b.radius == c.radius && b.friction == c.friction;
		for (int k = 0; k < 3; k++)
			same = same && b.v[k] == c.v[k] && b.inverseMass[k] == c.inverseMass[k] && (b.inverseMass[k] == 0 || b.force[k] == c.force[k]);
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
	of.resize(count, -1);
	place.resize(count);
	quiet.resize(count);
	bodies.resize(count);
	shapes.resize(count);
}

void Sleepers::wakeAll(World& world)
{
	list.clear();
	std::fill(of.begin(), of.end(), -1);
	world.awake.resize(world.pairs.size());
	std::iota(world.awake.begin(), world.awake.end(), 0);
}

void Sleepers::look(World& world)
{
	if (none()) {
		if (world.awake.size() != world.pairs.size())
			wakeAll(world);
		return;
	}
	resize(world.bodies.size());
	bool changes = false;
	for (std::size_t i = 0; i < world.bodies.size(); i++) {
		const Body& now = world.bodies[i];
		const bool sleeps = of[i] >= 0, immobile = isImmobile(now);
		const bool still = (sleeps || immobile) && isStill(now) && isSame(now, bodies[i]) && (now.radius > 0 || isSame(world.shapes[i], shapes[i]));
		if (sleeps)
			islandWith(static_cast<int32_t>(i)).changed |= !still;
		else if (immobile) {
			bodies[i] = now;
			shapes[i] = world.shapes[i];
		}
		changes = changes || quiet[i] != still;
		quiet[i] = still;
	}
	for (SleepingIsland& island : list)
		for (const Push& push : island.onImmobile)
			island.changed |= !quiet[push.body];
	changes = removeChanged() || changes;
	for (SleepingIsland& island : list)
		island.found = false;
	if (changes)
		listAwake(world);
}

// Whether there were any.
bool Sleepers::removeChanged()
{
	const auto isChanged = [](const SleepingIsland& island) { return island.changed; };
	if (std::none_of(list.begin(), list.end(), isChanged))
		return false;
	for (std::size_t i = 0; i < of.size(); i++)
		if (of[i] >= 0 && list[place[of[i]]].changed) {
			of[i] = -1;
			quiet[i] = false;
		}
	list.erase(std::remove_if(list.begin(), list.end(), isChanged), list.end());
	sort();
	return true;
}

// A pair between what is quiet stays as it is.
void Sleepers::listAwake(World& world) const
{
	world.awake.clear();
	for (std::size_t i = 0; i < world.pairs.size(); i++) {
		const Pair& pair = world.pairs[i];
		if (!quiet[pair.a] || !quiet[pair.b] || (of[pair.a] < 0 && of[pair.b] < 0))
			world.awake.push_back(static_cast<int32_t>(i));
	}
}

bool Sleepers::wakeBeyond(double gap, World& world)
{
	for (SleepingIsland& island : list)
		island.changed = gap < island.widest || gap >= island.next;
	const bool any = removeChanged();
	if (any)
		listAwake(world);
	return any;
}

bool Sleepers::wake(const std::vector<ContactRow>& contacts, World& world)
{
	if (none())
		return false;
	for (const ContactRow& c : contacts)
		for (const int32_t body : { c.a, c.b })
			if (sleepsOn(body))
				islandWith(body).changed = true;
	const bool any = removeChanged();
	if (any)
		listAwake(world);
	return any;
}

void Sleepers::forgetFound(std::size_t count)
{
	resize(count);
	for (SleepingIsland& island : list)
		island.changed = island.found;
	removeChanged();
}

void Sleepers::remember(const World& world)
{
	if (std::none_of(list.begin(), list.end(), [](const SleepingIsland& island) { return island.found; }))
		return;
	bodies = world.bodies;
	shapes = world.shapes;
}

void Sleepers::disturb(const Pair& pair)
{
	for (const int32_t body : { pair.a, pair.b })
		if (sleeps(body))
			islandWith(body).changed = true;
}

void Sleepers::add(int32_t name, int contacts, const ResidualSum& error)
{
	list.emplace_back();
	list.back().name = name;
	list.back().contacts = contacts;
	list.back().error = error;
}

void Sleepers::addBody(int32_t body, int32_t name, int unknowns)
{
	of[body] = name;
	islandWith(body).unknowns += unknowns;
}

void Sleepers::sort()
{
	std::sort(list.begin(), list.end(), [](const SleepingIsland& a, const SleepingIsland& b) { return a.name < b.name; });
	for (std::size_t k = 0; k < list.size(); k++)
		place[list[k].name] = static_cast<int32_t>(k);
}

} // namespace cd
