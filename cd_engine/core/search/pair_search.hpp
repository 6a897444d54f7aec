// When near pairs must be searched anew, and how far around each shape.
#pragma once

#include "search/near_pairs.hpp"
#include "base/base.hpp"

#include <cassert>
#include <utility>

namespace cd {

// Each shape has its own margin, up to which pairs are listed. The list stays complete until the shapes have used up their margins by moving. A fast
// one has a wide margin, which does not widen those of others. Further pairs in the list do not change the result (pair_order.hpp).
template <class Space> class PairSearchOf {
	using World = WorldOf<Space>;

    public:
	// Whether the list may lack a pair that this step needs, with the bodies as they are now; else fills World::listed. least: the margin of slow
	// bodies as a fraction of the smallest radius. outran: StepReport::outran if a step is repeated, else empty.
	bool needed(World&, double dt, double least, const std::vector<double>& outran, Threads* = nullptr);
	// Lists the pairs anew in World::pairs, in the order of the sweeps (pair_order.hpp); those that were listed before keep their data and what
	// they carry. Fills World::listed. Call `needed` first. If `rank` is another than in the last call, pairs may not be found again.
	void find(World&, const std::vector<int>& rank);
	// Of every pair that `find` has listed its index in the list before, or -1; and the indices in that list of the pairs that are gone.
	const std::vector<int32_t>& from() const { return origin; }
	const std::vector<int32_t>& left() const { return gone; }
	// Moves what belongs to the pairs to their new indices. New pairs get T(). In place: both lists have the same order, so none overtakes
	// another.
	template <class T> void rearrange(std::vector<T>& of) const
	{
		of.resize(before.size());
		std::size_t kept = 0;
		for (const int32_t from : origin)
			if (from >= 0)
				of[kept++] = std::move(of[from]);
		of.resize(origin.size());
		for (std::size_t k = origin.size(); k-- > kept;) // below, all have their places
			of[k] = origin[k] >= 0 ? std::move(of[--kept]) : T();
	}

	// The shape that has left all others behind, -1: none, or nothing has been searched since the last call.
	int lost(const World&);
	// The largest way of a body in this step, in radii of the smallest disk.
	double longestWay() const { return longest; }
	// The first shape that `needed` has found beyond its margin, -1: none, since bodies have come or gone.
	int32_t mover() const { return beyond; }
	double marginOf(int32_t shape) const { return margins[shape]; }

    private:
	void chooseMargins(const World&);
	double used(const World&, std::size_t shape) const;

	int32_t beyond = -1;
	long known = 0; // World::reading of the last step
	double least = 0; // margin of slow bodies [m]
	double fastest = 0, longest = 0; // largest way of a body in this step [m], and the same over the smallest radius
	std::vector<double> ways, needs; // of the shapes: ways in this step, and distances up to which pairs must be listed [m]
	std::vector<std::size_t> quick; // the fastest disks
	// At the last search:
	std::vector<double> margins;
	std::vector<PlaceOf<Space>> seen;
	std::vector<ShapeOf<Space>> seenShapes;
	std::vector<int32_t> seenMasks;
	int32_t seenApart = 0;
	NearPairsOf<Space> nearPairs;
	std::vector<NearPair> near, before; // the pairs of the last search and of the one before, in order
	std::vector<int32_t> origin, gone;
};
using PairSearch = PairSearchOf<Plane>;

// The first of the shapes `some` that has left the scene, -1: none. A body has left if it is further from the smallest rectangle, in space the
// smallest box, around the scene than its diagonal and than 50 of its own radii, if it moves away, and if no force or Wall brings it back. The scene
// is the boundaries, fixed disks among them, and the disks that do not leave these; without boundaries of finite size, all bodies but `some`. So a
// whole group that leaves is noticed. Looks at all bodies if `some` is not empty.
template <class Space> int leftBehind(const WorldOf<Space>&, const std::vector<std::size_t>& some);

} // namespace cd
