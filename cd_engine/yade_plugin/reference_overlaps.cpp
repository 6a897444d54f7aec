// Overlaps that count as touching: what springs have left behind.
#include "scene_link.hpp"

#include <algorithm>
#include <set>

namespace cd_engine {

void SceneLink::collectOverlaps(const ReferenceOverlaps& all) const
{
	std::vector<const cd::Pair*> kept;
	for (const cd::Pair& pair : world.pairs)
		if (pair.reference > 0)
			kept.push_back(&pair);
	std::sort(kept.begin(), kept.end(), [](const cd::Pair* p, const cd::Pair* q) { return std::minmax(p->a, p->b) < std::minmax(q->a, q->b); });
	all.ids.clear();
	all.overlaps.clear();
	for (const cd::Pair* pair : kept) {
		all.ids.push_back(std::min(pair->a, pair->b));
		all.ids.push_back(std::max(pair->a, pair->b));
		all.overlaps.push_back(pair->reference);
	}
}

// By bisection: the pairs are sorted by their ids.
std::size_t ReferenceOverlaps::find(int id1, int id2) const
{
	const std::pair<int, int> wanted = std::minmax(id1, id2);
	std::size_t low = 0, high = overlaps.size();
	while (low < high) {
		const std::size_t middle = (low + high) / 2;
		if (std::make_pair(ids[2 * middle], ids[2 * middle + 1]) < wanted)
			low = middle + 1;
		else
			high = middle;
	}
	return low < overlaps.size() && std::make_pair(ids[2 * low], ids[2 * low + 1]) == wanted ? low : overlaps.size();
}

double ReferenceOverlaps::of(int id1, int id2) const
{
	const std::size_t found = find(id1, id2);
	return found < overlaps.size() ? overlaps[found] : 0;
}

void ReferenceOverlaps::forget(const std::vector<cd::Pair>& pairs, const std::vector<int32_t>& which)
{
	for (const int32_t i : which)
		if (const std::size_t found = find(pairs[i].a, pairs[i].b); found < overlaps.size())
			overlaps[found] = 0;
	dropZeros();
}

void ReferenceOverlaps::forgetBodies(const std::vector<int>& which) const
{
	if (which.empty() || overlaps.empty())
		return;
	const std::set<int> bodies(which.begin(), which.end());
	for (std::size_t i = 0; i < overlaps.size(); i++)
		if (bodies.count(ids[2 * i]) > 0 || bodies.count(ids[2 * i + 1]) > 0)
			overlaps[i] = 0;
	dropZeros();
}

void ReferenceOverlaps::dropZeros() const
{
	std::size_t kept = 0;
	for (std::size_t i = 0; i < overlaps.size(); i++) {
		if (overlaps[i] == 0)
			continue;
		ids[2 * kept] = ids[2 * i];
		ids[2 * kept + 1] = ids[2 * i + 1];
		overlaps[kept++] = overlaps[i];
	}
	ids.resize(2 * kept);
	overlaps.resize(kept);
}

} // namespace cd_engine
