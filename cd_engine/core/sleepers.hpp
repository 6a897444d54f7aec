// Islands that sleep on: a step looks at nothing of theirs but whether their bodies are as they were.
//
// A step that finds an island asleep (sleep.hpp) and writes none of its forces anew leaves everything as it was, and so would every step after
// it. Such an island and its contacts are left out of the steps that follow, and what they add to counts, error and forces is added from memory,
// until a body of the island changes in any bit, or one that cannot move and touches it, or a body that does not sleep comes to touch it, or the gap up
// to which pairs are contacts becomes such that its contacts would be others. Then it is looked at again. Nothing of this shows in results: sums
// that round-off makes depend on their order are made of the islands in the order of their names, whether they were looked at or not.
#pragma once

#include "residual.hpp"
#include "world.hpp"

#include <limits>

namespace cd {

// Impulse on a body.
struct Push {
	int32_t body;
	double impulse[3]; // [N s], [N s], angular momentum about the body's centre [N m s]
};

struct SleepingIsland {
	int32_t name = 0; // the first of its bodies that can move
	int contacts = 0, unknowns = 0;
	ResidualSum error;
	// Filled in when the step in which it was found ends.
	int loaded = 0, sliding = 0; // contacts
	double deepest = 0; // overlap beyond the reference one [m]
	double widest = -std::numeric_limits<double>::infinity(); // gap of its contacts [m]
	double next = std::numeric_limits<double>::infinity(); // narrowest gap of its bodies that is too wide for a contact [m]
	std::vector<Push> onImmobile; // one for every contact with a body that cannot move
	bool found = true; // by the step that is being made or was the last
	bool changed = false;
};

class Sleepers {
    public:
	// Before the pairs of a step are read, its bodies being there already: lists in world.awake the pairs to be looked at.
	void look(World&);
	void wakeAll(World&);

	bool none() const { return list.empty(); }
	// In the order of their names.
	const std::vector<SleepingIsland>& islands() const { return list; }
	// Whether a body sleeps on, in an island that this step does not look at; whether it sleeps at all.
	bool sleepsOn(int32_t body) const { return !none() && of[body] >= 0 && !list[place[of[body]]].found; }
	bool sleeps(int32_t body) const { return !none() && of[body] >= 0; }
	SleepingIsland& islandWith(int32_t body) { return list[place[of[body]]]; }

	// Wakes the islands whose contacts would be others if pairs up to this gap [m] were; whether there were any.
	bool wakeBeyond(double gap, World&);
	// Wakes those of these bodies that sleep on; whether there were any.
	bool wake(const std::vector<ContactRow>&, World&);

	// What a step finds: forgets what it found before, adds islands and their bodies, is ready.
	void forgetFound(std::size_t bodies);
	void add(int32_t name, int contacts, const ResidualSum& error);
	void sort();
	void addBody(int32_t body, int32_t name, int unknowns);
	// At the end of a step: how everything is that it found asleep, and that the scene has not been left as it was.
	void remember(const World&);
	void disturb(const Pair&);

    private:
	void resize(std::size_t bodies);
	bool removeChanged();
	void listAwake(World&) const;

	std::vector<SleepingIsland> list;
	std::vector<int32_t> of; // by body: the name of its island, -1: it is awake
	std::vector<int32_t> place; // in the list, by name
	std::vector<char> quiet; // by body: sleeps on, or cannot move and has not changed
	std::vector<Body> bodies; // as they were, where they sleep or cannot move
	std::vector<Shape> shapes;
};

} // namespace cd
