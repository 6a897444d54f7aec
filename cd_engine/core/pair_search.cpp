#include "pair_search.hpp"
#include "lost.hpp"
#include "time_step.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	constexpr std::size_t fewQuick = 8;
	// A margin covers this many ways of its body, each the motion in one step: at least, at most, and for the few fastest disks.
	constexpr double leastWays = 1.1, mostWays = 4, spareQuick = 50;
	// Target for the mean margin of the disks, in radii.
	constexpr double meanMargin = 0.5;
	// Largest margin, in its radii, that a slow disk gets because others are fast.
	constexpr double hitRadius = 0.5;

} // namespace

// Computes the ways of the bodies in this step, and how far around them pairs must be listed.
void PairSearch::measure(const World& world, double dt, const std::vector<double>& outran, Threads* threads)
{
	const std::size_t count = world.bodies.size();
	ways.resize(count);
	needs.resize(count);
	const auto range = [&](std::size_t from, std::size_t to) {
		double most = 0;
		for (std::size_t i = from; i < to; i++) {
			const bool joins = world.masks[i] != 0;
			ways[i] = joins ? wayOf(world.bodies[i], world.shapes[i], dt) : 0;
			needs[i] = joins ? reachOf(world.bodies[i], ways[i]) : 0;
			if (joins && i < outran.size())
				needs[i] = std::max(needs[i], outran[i]);
			most = std::max(most, ways[i]);
		}
		return most;
	};
	fastest = reduceRanges<double>(threads, count, range, [](double a, double b) { return std::max(a, b); });
}

// Chooses margins that last for several steps. The few fastest disks, which may be far from all others, get the widest. If some bodies are fast, slow
// ones get a margin for the impact that they may suffer.
void PairSearch::chooseMargins(const World& world)
{
	const std::size_t count = world.bodies.size();
	quick.clear();
	for (std::size_t i = 0; i < count; i++)
		if (world.bodies[i].radius > 0 && ways[i] > least)
			quick.push_back(i);
	const std::size_t many = std::min(fewQuick, quick.size());
	std::partial_sort(quick.begin(), quick.begin() + static_cast<long>(many), quick.end(),
	    [this](std::size_t i, std::size_t j) { return ways[i] != ways[j] ? ways[i] > ways[j] : i < j; });
	quick.resize(many);
	margins.resize(count);
	double radii = 0, need = 0, way = 0; // sums over the disks; a disk far faster than the others counts with its radius at most
	for (std::size_t i = 0; i < count; i++)
		if (const double radius = world.bodies[i].radius; radius > 0) {
			radii += radius;
			need += std::min(needs[i], radius);
			way += std::min(ways[i], radius);
		}
	const double spareWays = way > 0 ? std::clamp((meanMargin * radii - need) / way, leastWays, mostWays) : mostWays;
	for (std::size_t i = 0; i < count; i++) {
		const double hit = std::min(world.bodies[i].radius * hitRadius, fastest);
		margins[i] = std::max({ least, hit, needs[i] + spareWays * ways[i] });
	}
	for (const std::size_t i : quick)
		margins[i] = needs[i] + spareQuick * ways[i];
}

// The part of its margin that a body has used up by moving [m]; infinite if its radius, mask or shape has changed.
double PairSearch::used(const World& world, std::size_t i) const
{
	const Body& b = world.bodies[i];
	if (b.radius != seen[i].radius || world.masks[i] != seenMasks[i])
		return endless;
	const double x = b.x - seen[i].x, y = b.y - seen[i].y;
	double way = std::sqrt(x * x + y * y);
	if (b.radius == 0) {
		const Shape &now = world.shapes[i], &then = seenShapes[i];
		if (now.kind != then.kind || now.ex != then.ex || now.ey != then.ey || now.axis != then.axis || now.sense != then.sense)
			return endless;
		if (now.kind == ShapeKind::box)
			way += std::hypot(now.ex, now.ey) * (std::abs(now.cosine - then.cosine) + std::abs(now.sine - then.sine));
	}
	return way;
}

// Whether the rest of every margin is enough. Fills World::listed.
bool PairSearch::stillComplete(World& world, Threads* threads) const
{
	world.listed.resize(seen.size());
	return !anyOf(threads, seen.size(), [&](std::size_t i) {
		world.listed[i] = world.masks[i] == 0 && seenMasks[i] == 0 ? endless : margins[i] - used(world, i);
		return !(needs[i] <= world.listed[i]);
	});
}

bool PairSearch::needed(World& world, double dt, double leastMargin, const std::vector<double>& outran, Threads* threads)
{
	const double smallest = smallestRadius(world);
	least = std::isinf(smallest) ? 0 : leastMargin * smallest;
	measure(world, dt, outran, threads);
	longest = fastest / smallest;
	return seen.size() != world.bodies.size() || world.apart != seenApart || !stillComplete(world, threads);
}

void PairSearch::find(World& world, std::vector<NearPair>& found)
{
	chooseMargins(world);
	seen.clear();
	for (const Body& b : world.bodies)
		seen.push_back({ b.x, b.y, b.radius });
	seenShapes = world.shapes;
	seenMasks = world.masks;
	seenApart = world.apart;
	world.listed = margins;
	for (std::size_t i = 0; i < seenMasks.size(); i++)
		if (seenMasks[i] == 0)
			world.listed[i] = endless;
	nearPairs.find(world, margins, found);
}

int PairSearch::lost(const World& world) const { return leftBehind(world, quick); }

} // namespace cd
