// What the finders of contacts in the plane and in space have in common: the list of contacts, and what it tells beside them.
#pragma once

#include "search/search.hpp"
#include "step/step_view.hpp"

#include <algorithm>
#include <vector>

namespace cd {

template <class Space> class FoundContacts {
    public:
	void forgetSeparated() { apart.clear(); }

	const std::vector<int32_t>& pairs() const { return pairOf; } // the pair of each contact
	std::size_t foundFirst() const { return early; } // contacts before any has been added
	bool isContact(int32_t pair) const { return contact[pair]; }
	double deepest() const { return largestOverlap; } // of the contacts, beyond the reference one [m]
	const std::vector<int32_t>& separated() const { return apart; } // pairs whose reference overlap has ended

    protected:
	using World = WorldOf<Space>;

	// What a search has found in one part of the pairs.
	struct Found {
		int32_t* first = nullptr; // its contacts
		std::size_t contacts = 0;
		bool through = false; // a disk must be taken back to a face
		bool same = true; // the contacts are those of the last search
		bool apart = false; // a reference overlap has ended
		bool ahead = false; // some are with facets around a concave edge
		double deepest = 0, narrowest = endless; // largest overlap beyond the reference, smallest gap left out [m]
	};

	// Whether the flags tell which pairs were contacts in the last step.
	bool knowsLast(const World& world, bool sameMasses) const
	{
		return sameMasses && world.listing != 0 && world.listing == listing && !added && contact.size() == world.pairs.size()
		    && world.awake.size() == world.pairs.size();
	}
	void makeRoom(const World& world)
	{
		if (contact.size() != world.pairs.size() || world.awake.size() != world.pairs.size())
			contact.assign(world.pairs.size(), 0);
		pairOf.resize(world.awake.size());
	}
	// search(from, to): what is found in these of the pairs that are awake. Its contacts are listed from `from` on.
	template <class Search> Found searchAll(const World& world, Threads& threads, const Search& search)
	{
		const Found all = reduceRanges<Found>(&threads, world.awake.size(), search, [](const Found& a, const Found& b) {
			if (a.first + a.contacts < b.first)
				std::copy_n(b.first, b.contacts, a.first + a.contacts);
			return Found { a.first, a.contacts + b.contacts, a.through || b.through, a.same && b.same, a.apart || b.apart,
				a.ahead || b.ahead, std::max(a.deepest, b.deepest), std::min(a.narrowest, b.narrowest) };
		});
		pairOf.resize(all.contacts);
		return all;
	}
	// overlapOf(pair): the geometric one [m]. guides: there is a disk that no force moves.
	template <class OverlapOf> void keep(World& world, const Found& found, bool guides, const OverlapOf& overlapOf)
	{
		for (std::size_t k = 0; found.apart && k < world.awake.size(); k++)
			if (Pair& pair = world.pairs[world.awake[k]]; pair.reference > 0 && overlapOf(world.awake[k]) <= 0) {
				pair.reference = 0;
				apart.push_back(world.awake[k]);
			}
		narrowest = found.narrowest;
		largestOverlap = found.deepest;
		if (guides) {
			largestOverlap = 0;
			for (const int32_t i : pairOf)
				if (!isGuided(world, world.pairs[i]))
					largestOverlap = std::max(largestOverlap, overlapOf(i) - world.pairs[i].reference);
		}
		early = pairOf.size();
		listing = world.listing;
		added = false;
	}
	// crosses(pair): whether the solution lets a pair that was left out cross its gap; fastEnough(pair): whether its bodies may close it;
	// gap(pair) [m]. Adds the latter if there is one of the former.
	template <class Crosses, class FastEnough, class Gap>
	bool add(const StepView<Space>& step, const Crosses& crosses, const FastEnough& fastEnough, const Gap& gap)
	{
		const std::vector<int32_t>& awake = step.world.awake;
		const auto violated = [&](std::size_t k) { return !contact[awake[k]] && crosses(awake[k]); };
		if (!(narrowest <= 2 * contact_limits::quick * step.dt() * step.motion.fastest()) || !anyOf(&step.threads, awake.size(), violated))
			return false;
		added = true;
		for (const int32_t i : awake)
			if (!contact[i] && fastEnough(i)) {
				pairOf.push_back(i);
				contact[i] = 1;
				largestOverlap = std::max(largestOverlap, -gap(i));
			}
		return true;
	}

	std::vector<int32_t> pairOf;
	std::vector<char> contact; // of each pair; 1: it is one

    private:
	std::size_t early = 0;
	double largestOverlap = 0;
	double narrowest = 0; // smallest gap of a pair that was left out [m]
	std::vector<int32_t> apart;
	long listing = 0; // World::listing of the last step
	bool added = false; // the last step has added contacts
};

} // namespace cd
