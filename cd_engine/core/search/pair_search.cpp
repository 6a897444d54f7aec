#include "search/pair_order.hpp"
#include "search/pair_search.hpp"
#include "search/reach.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {
namespace {

	constexpr std::size_t fewQuick = 8;
	// A margin covers this many ways of its body, each the motion in one step: at least, at most, and at most for the few fastest disks.
	constexpr double leastWays = 1.1, mostWays = 8, mostQuick = 50;
	// Target for the mean margin of the disks, in radii.
	constexpr double meanMargin = 1;
	// Largest margin, in its radii, that a slow disk gets because others are fast.
	constexpr double hitRadius = 0.5;

	double moved(const Body& b, const Place& seen)
	{
		const double x = b.x - seen.x, y = b.y - seen.y;
		return std::sqrt(x * x + y * y);
	}
	double moved(const SpaceBody& b, const SpacePlace& seen) { return length(b.at - seen.at); }

	// How far the outline of a boundary has moved by turning, at most; infinite if it is another shape.
	double turnedWay(const Shape& now, const Shape& then)
	{
		if (now.kind != then.kind || now.ex != then.ex || now.ey != then.ey || now.axis != then.axis || now.sense != then.sense)
			return endless;
		if (now.kind != ShapeKind::box)
			return 0;
		return std::hypot(now.ex, now.ey) * (std::abs(now.cosine - then.cosine) + std::abs(now.sine - then.sine));
	}

} // namespace

// Chooses margins that last for several steps. Those of the few fastest disks last as long as that of the next fastest, which may be far slower. If
// some bodies are fast, slow ones get a margin for the impact that they may suffer.
template <class Space> void PairSearchOf<Space>::chooseMargins(const World& world)
{
	const std::size_t count = world.shapes.size();
	quick.clear();
	for (std::size_t i = 0; i < count; i++)
		if (!isBoundary(world.bodyOf(i)) && ways[i] > least)
			quick.push_back(i);
	const std::size_t many = std::min(fewQuick + 1, quick.size());
	std::partial_sort(quick.begin(), quick.begin() + static_cast<long>(many), quick.end(),
	    [this](std::size_t i, std::size_t j) { return ways[i] != ways[j] ? ways[i] > ways[j] : i < j; });
	margins.resize(count);
	double radii = 0, need = 0, way = 0; // sums over the disks; a disk far faster than the others counts with its radius at most
	for (std::size_t i = 0; i < count; i++)
		if (const double radius = world.bodyOf(i).radius; !isBoundary(world.bodyOf(i))) {
			radii += radius;
			need += std::min(needs[i], radius);
			way += std::min(ways[i], radius);
		}
	const double spareWays = way > 0 ? std::clamp((meanMargin * radii - need) / way, leastWays, mostWays) : mostWays;
	for (std::size_t i = 0; i < count; i++) {
		const double hit = std::min(world.bodyOf(i).radius * hitRadius, fastest);
		margins[i] = std::max({ least, hit, needs[i] + spareWays * ways[i] });
	}
	double quickWays = mostQuick;
	if (quick.size() > fewQuick) {
		const std::size_t next = quick[fewQuick];
		quickWays = std::min(quickWays, (margins[next] - needs[next]) / ways[next]);
		quick.resize(fewQuick);
	}
	for (const std::size_t i : quick)
		margins[i] = std::max(margins[i], needs[i] + quickWays * ways[i]);
}

// The part of its margin that a body has used up by moving [m]; infinite if its radius, mask or shape has changed.
template <class Space> double PairSearchOf<Space>::used(const World& world, std::size_t i) const
{
	const BodyOf<Space>& b = world.bodyOf(i);
	if (b.radius != seen[i].radius || world.masks[i] != seenMasks[i])
		return endless;
	return isBoundary(b) ? moved(b, seen[i]) + turnedWay(world.shapes[i], seenShapes[i]) : moved(b, seen[i]);
}

template <class Space>
bool PairSearchOf<Space>::needed(World& world, double dt, double leastMargin, const std::vector<double>& outran, Threads* threads)
{
	const std::size_t count = world.shapes.size();
	assert(
	    dt > 0 && leastMargin >= 0 && count == world.bodies.size() && count == world.masks.size() && (outran.empty() || outran.size() <= count));
	ways.resize(count);
	needs.resize(count);
	world.listed.resize(count);
	struct Seen {
		double fastest = 0, smallest = endless;
		int32_t beyond = -1;
	};
	const bool searched = seen.size() == count && world.apart == seenApart;
	const uint8_t* const still = searched ? world.stillSince(known) : nullptr;
	const auto measure = [&](std::size_t from, std::size_t to) {
		Seen all;
		for (std::size_t i = from; i < to; i++) {
			if (still && still[i])
				continue;
			const BodyOf<Space>& b = world.bodyOf(i);
			const bool joins = world.masks[i] != 0;
			ways[i] = joins ? wayOf(b, world.shapes[i], dt) : 0;
			needs[i] = joins ? reachOf(b, ways[i]) : 0;
			if (joins && i < outran.size())
				needs[i] = std::max(needs[i], outran[i]);
			all.fastest = std::max(all.fastest, ways[i]);
			all.smallest = isBoundary(b) ? all.smallest : std::min(all.smallest, b.radius);
			if (!searched || all.beyond >= 0)
				continue;
			world.listed[i] = !joins && seenMasks[i] == 0 ? endless : margins[i] - used(world, i);
			all.beyond = needs[i] <= world.listed[i] ? -1 : static_cast<int32_t>(i);
		}
		return all;
	};
	const Seen all = reduceRanges<Seen>(threads, count, measure, [](const Seen& a, const Seen& b) {
		return Seen { std::max(a.fastest, b.fastest), std::min(a.smallest, b.smallest), a.beyond >= 0 ? a.beyond : b.beyond };
	});
	beyond = all.beyond;
	fastest = all.fastest;
	least = std::isinf(all.smallest) ? 0 : leastMargin * all.smallest;
	longest = fastest / all.smallest;
	known = world.reading;
	return !searched || beyond >= 0;
}

template <class Space> void PairSearchOf<Space>::find(World& world, const std::vector<int>& rank)
{
	assert(world.firstContact.empty() && needs.size() == world.shapes.size() && (rank.empty() || rank.size() == world.shapes.size()));
	chooseMargins(world);
	seen.clear();
	for (std::size_t i = 0; i < world.shapes.size(); i++)
		seen.push_back(placeAhead(world.bodyOf(i), 0));
	seenShapes = world.shapes;
	seenMasks = world.masks;
	seenApart = world.apart;
	world.listed = margins;
	for (std::size_t i = 0; i < seenMasks.size(); i++)
		if (seenMasks[i] == 0)
			world.listed[i] = endless;
	before.swap(near);
	nearPairs.find(world, margins, near);
	sortPairs(near, rank);
	findAgain(near, before, origin, gone);
	rearrange(world.pairs);
	rearrange(world.carried);
	for (std::size_t k = 0; k < near.size(); k++) { // also of known pairs, since a disk may have become a boundary
		world.pairs[k].a = near[k].a;
		world.pairs[k].b = near[k].b;
	}
}

template <class Space> int PairSearchOf<Space>::lost(const World& world)
{
	const int id = leftBehind(world, quick);
	quick.clear();
	return id;
}

template class PairSearchOf<Plane>;
template class PairSearchOf<Space3>;

} // namespace cd
