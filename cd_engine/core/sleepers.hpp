// Islands that stay asleep: a step only checks whether their bodies are unchanged.
//
// If a step finds an island asleep (sleep.hpp) and writes none of its forces anew, it leaves everything in the island as it was, and so would every
// later step. Later steps therefore leave out the island and its contacts, and add its stored part of the counts, the error and the forces. This ends
// when any bit changes of a body of the island or of an immobile body that touches it, or when an awake body comes to touch it. Then the island is
// looked at again. Motion, forces and counts do not depend on this: sums whose round-off depends on their order are made over the islands in the
// order of their names, whether a step looked at them or not.
#pragma once

#include "residual.hpp"
#include "world.hpp"

namespace cd {

// An impulse on a body.
struct Push {
	int32_t body;
	double impulse[3]; // [N s], [N s], angular momentum about the body's centre [N m s]
};

// Why an island is woken.
struct Cause {
	const char* what = nullptr; // null: there is no reason
	int32_t body = -1; // with this body; -1: with none
};

struct SleepingIsland {
	int32_t name = 0; // the first of its movable bodies
	int unknowns = 0;
	ResidualSum error;
	// Set at the end of the step that found the island asleep.
	int contacts = 0, loaded = 0, sliding = 0;
	double deepest = 0; // overlap beyond the reference one [m]
	std::vector<Push> onImmobile; // one for every contact with an immobile body
	bool found = true; // whether the present or last step looked at the island and found it asleep
	Cause disturbed; // the first thing in it that has changed

	void disturb(const char* what, int32_t body)
	{
		if (!disturbed.what)
			disturbed = { what, body };
	}
};

// To be called in a step in this order: look (or wakeAll), wake, startSearch, add, finishSearch, join, disturb, remember.
class Sleepers {
    public:
	// After the bodies of a step are read, but before its pairs. Lists in world.awake the pairs that the step must look at.
	void look(World&);
	void wakeAll(World&);

	bool none() const { return list.empty(); }
	// Sorted by name.
	const std::vector<SleepingIsland>& islands() const { return list; }
	// sleeps: whether a body is in a sleeping island. sleepsOn: whether this step also does not look at that island.
	bool sleeps(int32_t body) const { return !none() && nameOf[body] >= 0; }
	bool sleepsOn(int32_t body) const { return sleeps(body) && !list[indexOf[nameOf[body]]].found; }
	SleepingIsland& islandOf(int32_t body) { return list[indexOf[nameOf[body]]]; }

	// Wakes the islands that sleep on and have a body in one of these contacts. Returns whether there were any.
	bool wake(const ContactRows&, World&);

	// Record what a step finds, in place of what this step or the last one found before: first all islands, then their bodies.
	void startSearch(std::size_t bodies);
	void add(int32_t name, const ResidualSum& error);
	void finishSearch();
	void join(int32_t body, int32_t name, int unknowns);

	// At the end of a step: stores the state of the bodies.
	void remember(const World&);
	// A force between these bodies has changed. Not thread-safe.
	void disturb(int32_t a, int32_t b)
	{
		for (const int32_t body : { a, b })
			if (sleeps(body))
				islandOf(body).disturb("the force of a contact was changed", body);
	}
	// Why islands were woken last.
	const Cause& woken() const { return last; }
	void forgetWoken() { last = {}; }

    private:
	void resize(std::size_t bodies);
	bool compareBodies(const World&);
	template <class Condition> bool remove(Condition);
	bool removeDisturbed(bool sleepingOn);
	void number();
	void listAwake(World&) const;

	void recycle(SleepingIsland&);

	std::vector<SleepingIsland> list;
	Cause last;
	std::vector<std::vector<Push>> memory; // of islands that no longer exist, for reuse
	std::vector<int32_t> nameOf; // by body: the name of its island, -1: it is awake
	std::vector<int32_t> indexOf; // by name: the index of the island in the list
	std::vector<char> quiet; // by body: it sleeps on, or is immobile and unchanged
	std::vector<Body> bodies; // stored state of the bodies that sleep or cannot move
	std::vector<Shape> shapes;
};

} // namespace cd
