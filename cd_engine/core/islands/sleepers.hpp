// Islands that stay asleep: a step only checks whether their bodies are unchanged.
//
// If a step finds an island asleep (island_sleep.cpp) and writes none of its forces anew, it leaves everything in the island as it was, and
// so would every later step. Later steps therefore leave out the island and its contacts, and add its stored part of the counts, the error
// and the forces. This ends when any bit changes of a body of the island or of an immobile body that touches it, or when an awake body
// comes to touch it. Then the island is examined again. Leaving islands out does not change motion, forces or counts: sums whose
// round-off depends on their order are made over the islands in the order of their names, whether a step examined them or not.
//
// A contact along whose normal neither body can move carries nothing. Whatever happens at it concerns no island, so it belongs to none:
// it wakes nothing, and every step examines it.
//
// One array, the island of every body, and a copy of the bodies as they were define what sleeps. All else that is stored here follows from
// them, or was found in the step that put an island to sleep.
#pragma once

#include "problem/problem.hpp"
#include "error/error.hpp"
#include "scene/scene.hpp"

namespace cd {

// Why an island is woken.
struct Cause {
	const char* what = nullptr; // null: there is no reason
	int32_t body = -1; // with this body; -1: with none
};

struct SleepingIsland {
	int32_t name; // the first of its movable bodies
	ResidualSum error;
	int contacts = 0, loaded = 0, sliding = 0;
	double deepest = 0; // overlap beyond the reference one [m]
	Cause disturbed; // the first thing in it that has changed
	double stored = 0; // energy of its springs [J]

	bool operator<(const SleepingIsland& o) const { return name < o.name; }
	operator const ResidualSum&() const { return error; }
};

// The impulse of a contact of a sleeping island on an immobile body.
template <class Space> struct BoundaryImpulse {
	int32_t island, contact, body;
	std::array<double, Space::freedoms> impulse; // along the axes [N s], angular momentum about the body's centre [N m s]

	bool operator<(const BoundaryImpulse& o) const { return island < o.island || (island == o.island && contact < o.contact); }
};

// To be called in a step in this order: update (or wakeAll), wake, add.
template <class Space> class Sleepers {
	using Body = BodyOf<Space>;
	using World = WorldOf<Space>;
	using BoundaryImpulse = cd::BoundaryImpulse<Space>;

    public:
	// After the bodies of a step are read, but before its pairs. Wakes what has changed, and lists in world.awake the pairs that the step
	// examines.
	void update(World&);
	void wakeAll(World&, const Cause& why = { "near pairs were searched anew, since a body has moved far, come or gone", -1 });
	// Wakes the islands that have a body in one of these contacts. Returns whether there were any.
	bool wake(const ContactRows<Space>&, World&);
	// Adds the islands that a step has examined and found asleep. names: of each body, the name of its island.
	void add(const World&, const std::vector<SleepingIsland>& found, const std::vector<int32_t>& names);

	bool none() const { return list.empty(); }
	// False for what is no body of the world.
	bool sleeps(int32_t body) const { return !none() && static_cast<std::size_t>(body) < of.size() && of[body] >= 0; }
	const std::vector<SleepingIsland>& islands() const { return list; } // sorted by name
	// The sleeping island of a contact of these bodies; null: both are awake.
	SleepingIsland* islandAt(int32_t a, int32_t b) { return sleeps(a) ? &islandOf(a) : sleeps(b) ? &islandOf(b) : nullptr; }
	void addBoundaryImpulse(const BoundaryImpulse& of) { impulses.push_back(of); }
	const std::vector<BoundaryImpulse>& boundaryImpulses(); // in the order of the islands' names, then of the contacts
	// The pairs of sleeping bodies that are contacts in this step but cannot push.
	std::vector<int32_t> powerless;

	// Something about this body has changed, or about the body `with` that it touches. If it sleeps, the next update wakes its island.
	// Not thread-safe.
	void disturb(int32_t body, const char* what, int32_t with);
	void disturb(int32_t a, int32_t b)
	{
		for (const int32_t body : { a, b })
			if (sleeps(body))
				disturb(body, "the force of a contact was changed", body);
	}
	// Why islands were woken last.
	const Cause& woken() const { return last; }
	void forgetWoken() { last = {}; }

    private:
	bool wakeDisturbed(World&);
	SleepingIsland& islandOf(int32_t body);

	static constexpr int32_t awake = -1, unchanged = -2;
	std::vector<int32_t> of; // by body: the name of its island; `unchanged`: it is immobile, and was like this in the last step
	bool changed = false; // since the pairs were listed
	std::vector<Body> bodies; // as they were when they fell asleep, or of immobile ones, in the last step
	std::vector<ShapeOf<Space>> shapes;
	std::vector<SleepingIsland> list;
	std::vector<BoundaryImpulse> impulses;
	Cause last;
	long seen = 0; // World::reading of the last update
};

} // namespace cd
