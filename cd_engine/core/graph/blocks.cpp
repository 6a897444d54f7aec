#include "graph/blocks.hpp"

#include <algorithm>
#include <cassert>

namespace cd {

void Blocks::cut(const std::vector<Link>& links, const std::vector<uint8_t>& freedom)
{
	assert(std::all_of(links.begin(), links.end(), [n = static_cast<int32_t>(freedom.size())](const Link& l) { return l.a < n && l.b < n; }));
	solvable.clear();
	for (std::size_t i = 0; i < links.size(); i++)
		if (links[i].solvable)
			solvable.push_back(static_cast<int32_t>(i));
	if (solvable.size() < worthwhile) {
		contacts.swap(solvable);
		block = { 0, static_cast<int32_t>(contacts.size()) };
		colour = { 0, 1 };
		return;
	}
	findWalls(links, freedom);
	findColours(links);
	sort();
}

void Blocks::findWalls(const std::vector<Link>& links, const std::vector<uint8_t>& freedom)
{
	bodies.assign(freedom.size(), { -1, 0, 0 });
	for (std::size_t k = 0; k < solvable.size(); k++)
		for (const int32_t body : { links[solvable[k]].a, links[solvable[k]].b }) {
			Touched& t = bodies[body];
			const auto in = static_cast<int32_t>(k / size);
			t.blocks += freedom[body] > 0 && t.last != in;
			t.last = in;
		}
	const auto wall = [&](int32_t body) { return bodies[body].blocks > mostOfBody; };
	atWall.resize(solvable.size());
	for (std::size_t k = 0; k < solvable.size(); k++)
		atWall[k] = wall(links[solvable[k]].a) || wall(links[solvable[k]].b);
}

// Gives each block the least used colour among those that no block with a common body has.
void Blocks::findColours(const std::vector<Link>& links)
{
	const std::size_t blocks = (solvable.size() + size - 1) / size;
	colourOf.assign(blocks, -1);
	filled.clear();
	for (std::size_t i = 0; i < blocks; i++) {
		const std::size_t first = i * size, end = std::min(first + size, solvable.size());
		const auto each = [&](const auto& f) {
			for (std::size_t k = first; k < end; k++)
				for (const int32_t body : { links[solvable[k]].a, links[solvable[k]].b })
					if (!atWall[k] && bodies[body].blocks > 0)
						f(bodies[body]);
		};
		uint64_t taken = 0;
		each([&](const Touched& t) { taken |= t.colours; });
		int best = -1;
		for (int c = 0; c < static_cast<int>(filled.size()); c++)
			if (!(taken >> c & 1) && (best < 0 || filled[c] < filled[best]))
				best = c;
		if (best < 0 && filled.size() < mostColours) {
			best = static_cast<int>(filled.size());
			filled.push_back(0);
		}
		if (best < 0)
			continue;
		colourOf[i] = best;
		filled[best]++;
		each([&](Touched& t) { t.colours |= uint64_t(1) << best; });
	}
}

void Blocks::sort()
{
	contacts.clear();
	block.clear();
	colour.clear();
	const auto mark
	    = [](std::vector<int32_t>& beginnings, const std::vector<int32_t>& of) { beginnings.push_back(static_cast<int32_t>(of.size())); };
	const auto take = [&](std::size_t i, bool walls) {
		for (std::size_t k = i * size; k < std::min((i + 1) * size, solvable.size()); k++)
			if ((colourOf[i] < 0 || atWall[k]) == walls)
				contacts.push_back(solvable[k]);
	};
	for (std::size_t c = 0; c < filled.size(); c++) {
		mark(colour, block);
		for (std::size_t i = 0; i < colourOf.size(); i++)
			if (colourOf[i] == static_cast<int32_t>(c)) {
				mark(block, contacts);
				take(i, false);
			}
	}
	mark(colour, block);
	mark(block, contacts);
	for (std::size_t i = 0; i < colourOf.size(); i++)
		take(i, true);
	if (contacts.size() > static_cast<std::size_t>(block.back())) {
		mark(colour, block);
		mark(block, contacts);
	}
}

} // namespace cd
