#include "waiting.hpp"

#include <atomic>
#include <mutex>
#include <utility>

namespace cd_engine {
namespace {

	std::atomic<int> waiting { 0 };
	std::atomic<bool> paused { false };
	std::mutex lock;
	std::string error;

} // namespace

bool awaited() { return waiting > 0 && !paused; }
void pauseBegins() { paused = true; }
void runBegins()
{
	paused = false;
	takeError();
}
void waitBegins() { waiting++; }
void waitEnds() { waiting--; }

void keepError(const std::string& what)
{
	const std::lock_guard<std::mutex> held(lock);
	error = what;
}

std::string takeError()
{
	const std::lock_guard<std::mutex> held(lock);
	return std::exchange(error, {});
}

} // namespace cd_engine
