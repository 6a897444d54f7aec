// Islands that sleep on: a step looks at nothing of theirs but whether their bodies are as they were.
//
// A step that finds an island asleep (sleep.hpp) and writes none of its forces anew leaves everything as it was, and so would every step after
// it. Such an island and its contacts are left out of the steps that follow, and what they add to counts, error and forces is added from memory,
// until a body of the island changes in any bit, or one that cannot move and touches it, or a body that does not sleep comes to touch it. Then it is
// looked at again. Nothing of this shows in motion, forces and counts: sums that round-off makes depend on their order are made of the islands in
// the order of their names, whether they were looked at or not.
#pragma once

#include "residual.hpp"
#include "world.hpp"

namespace cd {

// Impulse on a body.
struct Push {
	int32_t body;
	double impulse[3]; // [N s], [N s], angular momentum about the body's centre [N m s]
};

struct SleepingIsland {
	int32_t name = 0; // the first of its bodies that can move
	int unknowns = 0;
	ResidualSum error;
	// Filled in when the step in which it was found ends.
	int contacts = 0, loaded = 0, sliding = 0;
	double deepest = 0; // overlap beyond the reference one [m]
	std::vector<Push> onImmobile; // one for every contact with a body that cannot move
	bool found = true; // by the step that is being made or was the last, which looks at it
	bool disturbed = false; // not as it was
};

// In the order in which a step uses it: look (or wakeAll), wake, startSearch, add, finishSearch, join, remember, disturb.
class Sleepers {
    public:
	// Before the pairs of a step are read, its bodies being there already: lists in world.awake the pairs to be looked at.
	void look(World&);
	void wakeAll(World&);

	bool none() const { return list.empty(); }
	// In the order of their names.
	const std::vector<SleepingIsland>& islands() const { return list; }
	// Whether a body sleeps, and whether it sleeps on: in an island that this step does not look at.
	bool sleeps(int32_t body) const { return !none() && nameOf[body] >= 0; }
	bool sleepsOn(int32_t body) const { return sleeps(body) && !list[indexOf[nameOf[body]]].found; }
	SleepingIsland& islandOf(int32_t body) { return list[indexOf[nameOf[body]]]; }

	// Wakes those of these bodies that sleep on; whether there were any.
	bool wake(const std::vector<ContactRow>&, World&);

	// What a step finds, in place of what it or the last one found before: first all islands, then their bodies.
	void startSearch(std::size_t bodies);
	void add(int32_t name, const ResidualSum& error);
	void finishSearch();
	void join(int32_t body, int32_t name, int unknowns);

	// At the end of a step: how everything is, and islands of which something has been written.
	void remember(const World&);
	void disturb(const Pair&); // not for several threads at once

    private:
	void resize(std::size_t bodies);
	bool compareBodies(const World&);
	template <class Condition> bool remove(Condition);
	void number();
	void listAwake(World&) const;

	void recycle(SleepingIsland&);

	std::vector<SleepingIsland> list;
	std::vector<std::vector<Push>> memory; // of islands that are no more
	std::vector<int32_t> nameOf; // by body: the name of its island, -1: it is awake
	std::vector<int32_t> indexOf; // by name: of the island in the list
	std::vector<char> quiet; // by body: sleeps on, or cannot move and has not changed
	std::vector<Body> bodies; // as they were, where they sleep or cannot move
	std::vector<Shape> shapes;
};

} // namespace cd
