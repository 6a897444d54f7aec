// When near pairs must be searched anew, and how far around each body.
#pragma once

#include "search/near_pairs.hpp"
#include "base/base.hpp"

namespace cd {

// Each body has its own margin, up to which pairs are listed. The list stays complete until the bodies have used up their margins by moving. A fast
// body has a wide margin, which does not widen those of others. Further pairs in the list do not change the result (pair_order.hpp).
class PairSearch {
    public:
	// Whether the list may lack a pair that this step needs, with the bodies as they are now; else fills World::listed. least: the margin of slow
	// bodies as a fraction of the smallest radius. outran: StepReport::outran if a step is repeated, else empty.
	bool needed(World&, double dt, double least, const std::vector<double>& outran, Threads* = nullptr);
	// Finds the pairs, in no particular order, and fills World::listed. Call `needed` first.
	void find(World&, std::vector<NearPair>&);

	// The body that has left all others behind, -1: none, or nothing has been searched since the last call.
	int lost(const World&);
	// The largest way of a body in this step, in radii of the smallest disk.
	double longestWay() const { return longest; }
	// The first body that `needed` has found beyond its margin, -1: none, since bodies have come or gone.
	int32_t mover() const { return beyond; }
	double marginOf(int32_t body) const { return margins[body]; }

    private:
	void chooseMargins(const World&);
	double used(const World&, std::size_t body) const;

	int32_t beyond = -1;
	double least = 0; // margin of slow bodies [m]
	double fastest = 0, longest = 0; // largest way of a body in this step [m], and the same over the smallest radius
	std::vector<double> ways, needs; // of the bodies: ways in this step, and distances up to which pairs must be listed [m]
	std::vector<std::size_t> quick; // the fastest disks
	std::vector<double> margins; // of the bodies at the last search [m]
	std::vector<Place> seen; // the bodies at that search
	std::vector<Shape> seenShapes;
	std::vector<int32_t> seenMasks;
	int32_t seenApart = 0;
	NearPairs nearPairs;
};

// The first of the bodies `some` that has left the scene, -1: none. A body has left if it is further from the smallest rectangle around the scene
// than the diagonal of this rectangle and than 50 of its own radii, if it moves away, and if no force or Wall brings it back. The scene is the
// boundaries, fixed disks among them, and the disks that do not leave these; without boundaries of finite size, all bodies but `some`. So a whole
// group that leaves is noticed. Looks at all bodies if `some` is not empty.
int leftBehind(const World&, const std::vector<std::size_t>& some);

} // namespace cd
