// Threads that share the work of one caller, and how work is cut for them: by its amount alone, never by their number, so that every number of
// threads gives the same bits.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace cd {

// The caller and count() - 1 helpers. These are started by the first work of several parts, wait without using the processor where none comes
// for some tenths of a millisecond, and end with this object. A process that is forked off starts its own. One caller at a time.
class Threads {
    public:
	Threads();
	Threads(Threads&&) noexcept;
	Threads& operator=(Threads&&) noexcept;
	~Threads();

	// At least one.
	void use(int count);
	int count() const { return wanted; }
	bool started() const { return pool != nullptr; } // whether there are helpers

	// Calls work(part) for every part from `bounds[0]` on and below `bounds[rows]`, each once; returns when all are done. Work does not throw.
	// Of each row of parts, bounds[r] to bounds[r + 1], every thread takes its share first, the same one in every run, so that what it works on
	// is near it still; who has done with that takes what others have not begun.
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
	void share(const Job&);
	void drop();

	int wanted = 1;
	std::unique_ptr<Pool> pool;
};

// Cuts a row of items into parts of equal size.
struct Cut {
	static constexpr std::size_t few = 8192; // fewer items than these are one part: one thread has done them before another has woken
	static constexpr std::size_t most = 64; // parts, of any larger number of items

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

// Whether `holds` is true of any item; of each range no more are looked at than needed.
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
