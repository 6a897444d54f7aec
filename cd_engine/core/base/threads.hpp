// Threads that share the work of one caller. The work is divided by its amount alone, never by the number of threads, so that every number of threads
// gives the same bits.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace cd {

// The caller and count() - 1 helpers. The first work of several parts starts the helpers. A helper without work soon sleeps, without using the
// processor. The helpers end with this object. A forked process starts its own helpers. Only one caller at a time.
class Threads {
    public:
	// Sets the number of threads, at least 1.
	void use(int count);
	int count() const { return wanted; }
	bool started() const { return pool != nullptr; } // whether there are helpers

	// Calls work(part) once for every part from bounds[0] to bounds[rows] - 1; returns when all are done. Work must not throw. In each row of
	// parts, bounds[r] to bounds[r + 1], every thread takes its share first. The share is the same in every run, so its data may still be in the
	// thread's cache. A thread that has finished its share takes parts of others that nobody has begun.
	template <class Work> void run(const int32_t* bounds, std::size_t rows, const Work& work)
	{
		if (bounds[rows] - bounds[0] < 2 || wanted < 2)
			for (int32_t part = bounds[0]; part < bounds[rows]; part++)
				work(part);
		else
			share({ bounds, rows, [](const void* w, int32_t part) { (*static_cast<const Work*>(w))(part); }, &work });
	}

    private:
	struct Job {
		const int32_t* bounds;
		std::size_t rows;
		void (*call)(const void* work, int32_t part);
		const void* work;
	};
	class Pool;
	// Ends the helpers. A forked process has none: it must not touch the pool of the other process and leaves it as it is.
	struct End {
		void operator()(Pool*) const;
	};
	void share(const Job&);

	int wanted = 1;
	std::unique_ptr<Pool, End> pool;
};

// Cuts a row of items into parts of equal size.
struct Cut {
	static constexpr std::size_t few = 8192; // fewer items are one part: one thread would finish before another has woken
	static constexpr std::size_t most = 64; // number of parts for all larger numbers of items

	explicit Cut(std::size_t n)
	    : items(n)
	    , parts(n < few ? 1 : most)
	{
	}
	std::size_t from(std::size_t part) const { return items * part / parts; }

	std::size_t items, parts;
};

// Calls work(part) for every part below `parts`, by the threads if there are any.
template <class Work> void forEach(Threads* threads, std::size_t parts, const Work& work)
{
	const int32_t bounds[] = { 0, static_cast<int32_t>(parts) };
	if (threads)
		threads->run(bounds, 1, work);
	else
		for (std::size_t part = 0; part < parts; part++)
			work(part);
}

// Calls work(from, to) for ranges that cover all items.
template <class Work> void forRanges(Threads* threads, std::size_t items, const Work& work)
{
	const Cut cut(items);
	forEach(threads, cut.parts, [&](std::size_t part) { work(cut.from(part), cut.from(part + 1)); });
}

// The results of work(from, to) added up in the order of the ranges, by `add`.
template <class Result, class Work, class Add> Result reduceRanges(Threads* threads, std::size_t items, const Work& work, const Add& add)
{
	const Cut cut(items);
	Result of[Cut::most];
	forEach(threads, cut.parts, [&](std::size_t part) { of[part] = work(cut.from(part), cut.from(part + 1)); });
	for (std::size_t part = 1; part < cut.parts; part++)
		of[0] = add(of[0], of[part]);
	return of[0];
}

// Whether `holds` is true for any item. In each range the search ends at the first one.
template <class Condition> bool anyOf(Threads* threads, std::size_t items, const Condition& holds)
{
	const auto look = [&](std::size_t from, std::size_t to) {
		while (from < to && !holds(from))
			from++;
		return from < to;
	};
	return reduceRanges<bool>(threads, items, look, [](bool a, bool b) { return a || b; });
}

} // namespace cd
