#include "search/pair_order.hpp"

#include <algorithm>

namespace cd {
namespace {

	constexpr int blockBits = 5; // a block has 32 disks that follow one another along the curve
	constexpr int keyBits = 40; // of the key, below the number of the block

	// Pairs of the disks of one block stay together, for locality, and are scattered within the block. Contacts near each other in the list then
	// mostly share no body and can be solved eight at a time (grouping.hpp).
	uint64_t keyOf(const NearPair& pair, const std::vector<int>& rank)
	{
		const uint64_t low = std::min(pair.a, pair.b), high = std::max(pair.a, pair.b);
		uint64_t h = (low << 32 | high) * 0x9E3779B97F4A7C15ull; // Fibonacci hashing (Knuth, vol. 3, section 6.4)
		h ^= h >> 32;
		h *= 0xD6E8FEB86659FD93ull;
		// A body has no rank if it was not a disk when the ranks were made.
		const uint64_t first = rank.empty() ? low : std::min<uint64_t>(std::min(rank[pair.a], rank[pair.b]), rank.size());
		return first >> blockBits << keyBits | h >> (64 - keyBits);
	}

	// Different pairs may have the same key. Then the numbers of their bodies decide.
	struct ComesFirst {
		bool operator()(const NearPair& p, const NearPair& q) const
		{
			return p.key != q.key ? p.key < q.key : std::minmax(p.a, p.b) < std::minmax(q.a, q.b);
		}
	};
	constexpr ComesFirst comesFirst;

} // namespace

void sortPairs(std::vector<NearPair>& pairs, const std::vector<int>& rank)
{
	for (NearPair& pair : pairs)
		pair.key = keyOf(pair, rank);
	std::sort(pairs.begin(), pairs.end(), comesFirst);
}

void findAgain(const std::vector<NearPair>& now, const std::vector<NearPair>& before, std::vector<int32_t>& from, std::vector<int32_t>& left)
{
	from.clear();
	left.clear();
	const auto count = static_cast<int32_t>(before.size());
	int32_t old = 0;
	for (const NearPair& pair : now) {
		for (; old < count && comesFirst(before[old], pair); old++)
			left.push_back(old);
		from.push_back(old < count && !comesFirst(pair, before[old]) ? old++ : -1);
	}
	for (; old < count; old++)
		left.push_back(old);
}

} // namespace cd
