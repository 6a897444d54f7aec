// Which contacts can be swept at the same time: blocks of neighbours in the order given, in colours. No two blocks of a colour share a body that
// can move. The sweep goes colour by colour, within a block in the order given. The cut is a function of the contacts alone: not of the number of
// threads.
//
// Blocks, and not single contacts, since the order of a sweep is part of the method: orders that jump from contact to contact have cost 2.5 times the
// sweeps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cd {

enum class Part : int32_t { none, loose, grouped }; // of a contact in the sweeps; none: of two immobile bodies

// All that the order of the sweeps and the grouping ask of a contact.
struct Link {
	int32_t a, b;
	Part part;
	bool operator==(const Link& other) const { return a == other.a && b == other.b && part == other.part; }
};

class Blocks {
    public:
	// Below so many contacts there is one block: of fewer a colour would have about as much work as it takes two threads to meet.
	static constexpr std::size_t worthwhile = 8192;
	static constexpr std::size_t size = 512; // contacts a block

	// freedom: of every body, how many of its velocities can change.
	void cut(const std::vector<Link>& links, const std::vector<uint8_t>& freedom);

	std::vector<int32_t> contacts; // that can be solved, in the order of the sweep
	std::vector<int32_t> block; // first contact of each block, and the end
	std::vector<int32_t> colour; // first block of each colour, and the end

	std::size_t count() const { return block.size() - 1; }
	std::size_t colours() const { return colour.size() - 1; }

    private:
	// Blocks in which a body may have contacts. One that has more, a wall, would set all of them apart from each other: its contacts come last,
	// in a block of their own.
	static constexpr int mostOfBody = 16;
	static constexpr int mostColours = 64;

	struct Touched {
		int32_t last; // block in which it was met
		int32_t blocks; // how many; 0: it cannot move
		uint64_t colours; // of these
	};

	void findWalls(const std::vector<Link>&, const std::vector<uint8_t>& freedom);
	void findColours(const std::vector<Link>&);
	void sort();

	std::vector<int32_t> solvable; // contacts, in the order given
	std::vector<Touched> bodies;
	std::vector<char> atWall; // of the solvable contacts
	std::vector<int32_t> colourOf; // of each block in the order given; -1: it is swept with the walls
	std::vector<int32_t> filled; // by colour: its blocks
};

} // namespace cd
