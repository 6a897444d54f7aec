#include "waiting.hpp"

#include <atomic>

namespace cd_engine {
namespace {

	std::atomic<int> waiting { 0 };
	std::atomic<bool> paused { false };

} // namespace

bool awaited() { return waiting > 0 && !paused; }
void pauseBegins() { paused = true; }
void runBegins() { paused = false; }
void waitBegins() { waiting++; }
void waitEnds() { waiting--; }

} // namespace cd_engine
