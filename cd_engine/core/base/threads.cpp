#include "base/threads.hpp"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include <unistd.h>

namespace cd {
namespace {

	constexpr unsigned patience = 4000; // looks for work, of about 25 ns each, before a helper sleeps; waking it costs as much
	constexpr unsigned alone = 400; // looks before a waiting thread yields its processor, which the awaited thread may need

	void wait(unsigned looks)
	{
		if (looks > alone && looks % 16 == 0)
			std::this_thread::yield();
		else
			__builtin_ia32_pause();
	}

} // namespace

class Threads::Pool {
    public:
	explicit Pool(int helpers)
	    : open(helpers + 1)
	    , looksBeforeSleep(helpers < static_cast<int>(std::thread::hardware_concurrency()) ? patience : 0)
	{
		try {
			for (int i = 0; i < helpers; i++)
				threads.emplace_back([this, i] { help(i + 1); });
		} catch (const std::system_error&) { // no more are available: the existing ones must do
		}
	}

	bool isOurs() const { return process == getpid(); }

	~Pool()
	{
		ends = true;
		current++;
		wake();
		for (std::thread& t : threads)
			t.join();
	}

	void share(const Job& asked)
	{
		const uint32_t number = current.load() + 1;
		job = asked;
		unfinished.store(job.bounds[job.rows] - job.bounds[0], std::memory_order_relaxed);
		for (std::size_t who = 0; who < open.size(); who++)
			open[who].store(uint64_t(number) << 32 | sizeOfShare(who));
		current.store(number);
		if (asleep.load() > 0)
			wake();
		take(number, 0);
		for (unsigned looks = 0; unfinished.load(std::memory_order_acquire) > 0; looks++)
			wait(looks);
	}

    private:
	// Where the share of thread `who` begins in a row.
	int32_t begin(std::size_t row, std::size_t who) const
	{
		return job.bounds[row] + static_cast<int32_t>((job.bounds[row + 1] - job.bounds[row]) * who / open.size());
	}
	uint32_t sizeOfShare(std::size_t who) const
	{
		int32_t size = 0;
		for (std::size_t row = 0; row < job.rows; row++)
			size += begin(row, who + 1) - begin(row, who);
		return size;
	}

	// The next part of a share of which `left` parts, this one included, have not been begun.
	int32_t part(std::size_t who, uint32_t left) const
	{
		auto at = static_cast<int32_t>(sizeOfShare(who) - left);
		for (std::size_t row = 0;; row++) {
			const int32_t first = begin(row, who), size = begin(row, who + 1) - first;
			if (at < size)
				return first + at;
			at -= size;
		}
	}

	// Takes parts that nobody has begun, first of its own share and then of those of the others. Only a thread that holds a part reads `job`,
	// which does not change until all parts are done.
	void take(uint32_t number, std::size_t self)
	{
		for (std::size_t i = 0; i < open.size(); i++) {
			const std::size_t who = (self + i) % open.size();
			uint64_t now = open[who].load();
			while (now >> 32 == number && static_cast<uint32_t>(now) > 0) {
				if (!open[who].compare_exchange_weak(now, now - 1))
					continue;
				job.call(job.work, part(who, static_cast<uint32_t>(now)));
				unfinished.fetch_sub(1, std::memory_order_release);
				now = open[who].load();
			}
		}
	}

	void help(std::size_t self)
	{
		pthread_setname_np(pthread_self(), "cd_engine"); // what `top -H` shows
		uint32_t last = 0;
		const auto none = [&] { return current.load() == last; };
		for (;;) {
			for (unsigned looks = 0; looks < looksBeforeSleep && none(); looks++)
				wait(looks);
			if (none()) {
				std::unique_lock<std::mutex> lock(mutex);
				asleep++;
				begins.wait(lock, [&] { return !none(); });
				asleep--;
			}
			if (ends)
				return;
			last = current.load();
			take(last, self);
		}
	}

	// The lock ensures that a helper counted as asleep already waits, or looks for work after this: it holds the mutex in between.
	void wake()
	{
		{
			const std::lock_guard<std::mutex> lock(mutex);
		}
		begins.notify_all();
	}

	struct alignas(64) Open : std::atomic<uint64_t> { // number of the job << 32 | parts of a share that nobody has begun
		Open()
		    : std::atomic<uint64_t>(0)
		{
		}
	};
	std::vector<Open> open; // by thread, the caller first
	alignas(64) std::atomic<uint32_t> current { 0 }; // number of the present job
	alignas(64) std::atomic<int32_t> unfinished { 0 }; // parts of the job
	alignas(64) Job job {};
	const unsigned looksBeforeSleep;
	std::atomic<bool> ends { false };
	std::atomic<int> asleep { 0 };
	std::mutex mutex;
	std::condition_variable begins;
	std::vector<std::thread> threads;
	const pid_t process = getpid();
};

void Threads::End::operator()(Pool* pool) const
{
	if (pool->isOurs())
		delete pool;
}

void Threads::use(int count)
{
	if (count == wanted)
		return;
	pool.reset();
	wanted = std::max(1, count);
}

void Threads::share(const Job& job)
{
	if (!pool || !pool->isOurs())
		pool.reset(new Pool(wanted - 1));
	pool->share(job);
}

} // namespace cd
