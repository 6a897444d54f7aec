// Who waits for a run, who has paused it, and which error has ended it. cd_engine/run_hooks.py calls these functions.
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

} // namespace cd_engine
