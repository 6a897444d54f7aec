#include "islands/sleepers.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace cd {
namespace {

	// Whether a body does not move and all that a step reads of it is as before; forces only where they have an effect.
	bool rests(const Body& b, const Body& c)
	{
		bool same = b.x == c.x && b.y == c.y && b.radius == c.radius && b.friction == c.friction;
		for (int k = 0; k < 3; k++)
			same = same && b.v[k] == 0 && c.v[k] == 0 && b.inverseMass[k] == c.inverseMass[k]
			    && (b.inverseMass[k] == 0 || b.force[k] == c.force[k]);
		return same;
	}

	auto allOf(const Shape& s) { return std::tie(s.kind, s.ex, s.ey, s.cosine, s.sine, s.axis, s.sense); }

} // namespace

void Sleepers::wakeAll(World& world, const Cause& why)
{
	if (!none())
		last = why;
	of.clear();
	list.clear();
	pushed.clear();
	powerless.clear();
	world.awake.resize(world.pairs.size());
	std::iota(world.awake.begin(), world.awake.end(), 0);
}

void Sleepers::look(World& world)
{
	if (none() ? world.awake.size() != world.pairs.size() : of.size() != world.bodies.size())
		wakeAll(world);
	if (none())
		return;
	for (std::size_t i = 0; i < of.size(); i++) {
		const auto body = static_cast<int32_t>(i);
		const Body& now = world.bodies[i];
		const bool immobile = isGuided(now);
		if (of[i] == awake && !immobile)
			continue;
		const bool same = rests(now, bodies[i]) && (now.radius > 0 || allOf(world.shapes[i]) == allOf(shapes[i]));
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
	for (const Push& push : pushed)
		if (of[push.body] == awake)
			disturb(push.island, "a boundary that it touches was moved or changed", push.body);
	wakeDisturbed(world);
}

bool Sleepers::wake(const ContactRows& contacts, World& world)
{
	if (none())
		return false;
	for (const ContactRow& c : contacts)
		for (const int32_t body : { c.a, c.b })
			if (c.wnn > 0) // else nothing passes through it
				disturb(body, "a body that is awake came near", body == c.a ? c.b : c.a);
	return wakeDisturbed(world);
}

void Sleepers::disturb(int32_t body, const char* what, int32_t with)
{
	if (sleeps(body) && !list[index[of[body]]].disturbed.what)
		list[index[of[body]]].disturbed = { what, with };
}

// Wakes the islands in which something has changed, and returns whether there were any. Then lists the pairs that a step must look at: all
// but those of two bodies that rest, of which one sleeps. Contacts that cannot push are listed also there.
bool Sleepers::wakeDisturbed(World& world)
{
	const auto wakes = [](const SleepingIsland& island) { return island.disturbed.what != nullptr; };
	const auto first = std::find_if(list.begin(), list.end(), wakes);
	const bool any = first != list.end();
	if (any) {
		last = first->disturbed;
		for (int32_t& name : of)
			if (name >= 0 && wakes(list[index[name]]))
				name = awake;
		pushed.erase(std::remove_if(pushed.begin(), pushed.end(), [&](const Push& p) { return of[p.island] < 0; }), pushed.end());
		list.erase(std::remove_if(first, list.end(), wakes), list.end());
		number();
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

void Sleepers::number()
{
	for (std::size_t k = 0; k < list.size(); k++)
		index[list[k].name] = static_cast<int32_t>(k);
}

void Sleepers::add(const World& world, const std::vector<SleepingIsland>& found, const std::vector<int32_t>& names)
{
	if (found.empty())
		return;
	changed = true;
	of.resize(names.size(), awake);
	index.resize(names.size());
	for (const SleepingIsland& island : found)
		of[island.name] = island.name;
	for (std::size_t i = 0; i < names.size(); i++)
		if (of[names[i]] == names[i])
			of[i] = names[i];
	bodies = world.bodies;
	shapes = world.shapes;
	list.insert(list.end(), found.begin(), found.end());
	std::sort(list.begin(), list.end());
	number();
}

const std::vector<Push>& Sleepers::pushes()
{
	if (!std::is_sorted(pushed.begin(), pushed.end()))
		std::sort(pushed.begin(), pushed.end());
	return pushed;
}

} // namespace cd
