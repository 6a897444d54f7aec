// What a run knows of rest from step to step, and when slow islands are tried for it (island_sleep.cpp).
#pragma once

#include "islands/sleepers.hpp"

#include <limits>

namespace cd {

struct Effort;

// One value: whoever saves a run saves all of it, so that the run continues identically.
struct Rest {
	// Steps between two trials, and sweeps in one trial: about one sweep a step since the last trial. This costs less than an island at rest that
	// stays awake. Islands that come to rest in a thousand sweeps mostly do so in a hundred, the others by chance in a later trial.
	static constexpr int shortestPause = 16, longestPause = 2048, fewestSweeps = 64, mostSweeps = 1024;
	static constexpr long never = std::numeric_limits<long>::max();

	long steps = 0; // made so far
	long trialAt = never; // value of `steps` from which the next trial is due
	int pause = shortestPause; // steps from one trial to the next
	int islands = 0, sleeping = 0; // in the last step: how many there were, and how many of them slept
	bool withoutSweep = false; // the last step solved its one large island so; this decides in which order impulses are added
	std::vector<int> loadsBefore; // the loads of the last step, if it was the one before a trial

	// Of each body in this step: a hash of the velocity that forces add to it. Equal loads have equal hashes. Empty if nobody compares them.
	std::vector<int> loads;

	// Sweeps that slow islands may take to prove their rest in this step; 0: no trial.
	int sweeps() const;
	// Before a step of dt: finds the loads if this step or the next one compares them.
	template <class Space> void begin(const WorldOf<Space>&, double dt);
	// After a step: keeps its loads for a trial in the next one, and decides when the next trial comes.
	void plan(const Effort&);

    private:
	bool precedesTrial() const { return sleeping < islands && steps + 1 == trialAt; }
};

// What the solution of islands needs to know about rest; without it nothing sleeps.
template <class Space> struct Stillness {
	const Sleepers<Space>& sleepers; // islands left out of the system
	const std::vector<BodyOf<Space>>& before; // the bodies before the step
	Rest& rest;
	double tolerance; // of rest, at most that of the step
};

} // namespace cd
