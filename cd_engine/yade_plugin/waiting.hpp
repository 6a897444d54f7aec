// Who waits for a run, who has paused it, and what has ended it. cd_engine/run_hooks.py calls these functions.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <utility>

namespace cd_engine {

inline std::atomic<int> waiting { 0 };
inline std::atomic<bool> paused { false };

// Whether somebody waits for the run to end: O.run(n, True) or O.wait(). Meanwhile only the scene's engines look at the scene.
inline bool awaited() { return waiting > 0 && !paused; }

// Returns what ended the last run, empty if nothing did or somebody has taken it, and keeps `next` in its place. YADE forgets the error of a run
// that has ended before somebody begins to wait for it.
inline std::string exchangeError(const std::string& next)
{
	static std::mutex lock;
	static std::string error;
	const std::lock_guard<std::mutex> held(lock);
	return std::exchange(error, next);
}

// O.stopAtIter as the engine has set it to end a run, and what it replaced; below 0: nothing.
inline std::atomic<long> stopSet { -1 }, stopBefore { -1 };

// Lets the run end when the clock shows `at`, with this error, unless another one is kept.
inline void stopAfter(long at, long& stopAtIter, const std::string& error)
{
	if (const std::string first = exchangeError(error); !first.empty())
		exchangeError(first);
	if (stopSet < 0)
		stopBefore = stopAtIter;
	stopSet = stopAtIter = at;
}

// Returns the O.stopAtIter that holds again after such a run, given the present one. YADE sets it to -1 where it stops.
inline long formerStop(long now)
{
	const bool ours = stopSet >= 0 && (now == stopSet || now < 0);
	stopSet = -1;
	return ours ? stopBefore.load() : now;
}

} // namespace cd_engine
