// Which contacts can be swept at the same time. The contacts are cut, in the order given, into blocks of neighbours, and each block gets a colour. No
// two blocks of one colour share a movable body. A sweep goes colour by colour, and within a block in the order given. The cut depends on the
// contacts alone, not on the number of threads.
//
// Blocks are coloured instead of single contacts because the order of a sweep is part of the method: orders that jump from contact to contact needed
// 2.5 times the sweeps.
#pragma once

#include "graph/partition.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cd {

class Blocks {
    public:
	// Fewer contacts make a single block: the work of one colour would be as short as the time in which two threads synchronise.
	static constexpr std::size_t worthwhile = 8192;
	static constexpr std::size_t size = 512; // contacts in a block

	// freedom: of every body, how many of its velocity components can change.
	void cut(const std::vector<Link>& links, const std::vector<uint8_t>& freedom);

	std::vector<int32_t> contacts; // the solvable ones, in the order of the sweep
	std::vector<int32_t> block; // first contact of each block, then the end
	std::vector<int32_t> colour; // first block of each colour, then the end

	std::size_t count() const { return block.size() - 1; }
	std::size_t colours() const { return colour.size() - 1; }
	Range contactsOf(std::size_t i) const
	{
		return { static_cast<std::size_t>(block[i]), static_cast<std::size_t>(block[i + 1]) };
	} // in `contacts`

	// Calls work(block) for every block, by the threads if there are any.
	template <class Work> void inEvery(Threads* threads, const Work& work) const
	{
		if (threads)
			threads->run(colour.data(), colours(), work);
		else
			for (int32_t i = 0; i < static_cast<int32_t>(count()); i++)
				work(i);
	}
	// The same in the order of the sweep: blocks that share a movable body never run at the same time.
	template <class Work> void byColour(Threads* threads, const Work& work) const
	{
		if (!threads)
			return inEvery(threads, work);
		for (std::size_t c = 0; c < colours(); c++)
			threads->run(&colour[c], 1, work);
	}

    private:
	// A body may have contacts in this many blocks. A wall in more blocks would put each of them into a colour of its own. Its contacts are
	// therefore swept last, in a block of their own.
	static constexpr int mostOfBody = 16;
	static constexpr int mostColours = 64;

	struct Touched {
		int32_t last; // last block in which the body was met
		int32_t blocks; // in how many blocks it was met; 0: it cannot move
		uint64_t colours; // of these blocks, one bit a colour
	};

	void findWalls(const std::vector<Link>&, const std::vector<uint8_t>& freedom);
	void findColours(const std::vector<Link>&);
	void sort();

	std::vector<int32_t> solvable; // contacts that can be solved, in the order given
	std::vector<Touched> bodies;
	std::vector<char> atWall; // of each solvable contact: whether it touches a wall
	std::vector<int32_t> colourOf; // of each block in the order given; -1: all of it is swept with the walls
	std::vector<int32_t> filled; // of each colour: how many blocks it has
};

} // namespace cd
