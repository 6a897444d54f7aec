// What a step knows of contacts whose rows nobody has read: they are those of the step before, so they go straight into the groups of the sweeps
// (GroupSource).
#include "step/load_pairs.hpp"

namespace cd {

void TimeStep::makeRows(std::vector<ContactRow>& all)
{
	forRanges(&threads, all.size(), [&](std::size_t from, std::size_t to) { fillRows(*source, *sourceSettings, all.data(), from, to); });
	for (std::size_t k = 0; k < specials.size(); k++) // made before the solution, which may have turned a box
		all[specials[k]] = specialRows[k];
}

ContactRow TimeStep::row(int32_t contact) const
{
	if (specialOf[contact] >= 0)
		return specialRows[specialOf[contact]];
	double turned;
	return rowOf(*source, rowPair[contact], *sourceSettings, turned);
}

void TimeStep::fill(const int32_t* contacts, std::size_t count, const double* inverseRadius, Group* groups, uint8_t* left) const
{
	PairLanes pairs[batch / PairLanes::lanes];
	const std::size_t most = batch / PairLanes::lanes;
	const RowSettings settings = asked(*sourceSettings);
	for (std::size_t from = 0; from < count; from += most, contacts += batch) {
		const std::size_t here = std::min(most, count - from);
		const auto which = [&](std::size_t k) { return rowPair[std::max(contacts[k], 0)]; };
		if (from + most < count) // the next ones: no processor predicts the addresses in the order of the groups
			for (std::size_t k = batch; k < 2 * batch && k < (count - from) * PairLanes::lanes; k++) {
				__builtin_prefetch(&source->pairs[which(k)]);
				__builtin_prefetch(&source->carried[which(k)]);
			}
		load<true>(*source, here * PairLanes::lanes, pairs, which, inverseRadius);
		for (std::size_t k = 0; k < here; k++) {
			unsigned unknown = groupKernel().assembleGroup(
			    places.data(), system.bodies.data(), source->carried.data(), pairs[k], groups[from + k], settings);
			for (std::size_t lane = 0; lane < PairLanes::lanes; lane++)
				unknown |= static_cast<unsigned>(contacts[k * PairLanes::lanes + lane] < 0) << lane;
			left[from + k] = static_cast<uint8_t>(unknown);
		}
	}
}

// What the solved impulses of postponed contacts do.
void TimeStep::effectsOf(const World& world, double rate, std::size_t from, std::size_t count, PairEffects* effects) const
{
	PairLanes pairs[batch / PairLanes::lanes];
	const std::size_t groups = load<false>(world, count, pairs, [&](std::size_t k) { return rowPair[from + k]; });
	groupKernel().effects(places.data(), means.data(), system.contacts.solution() + 2 * from, count, rate, pairs, effects, groups);
}

// The rows that the kernel cannot make, for contacts that are the same as in the last step. Returns whether none of them has a negative bias and all
// can be solved, as is so of all others.
bool TimeStep::findSpecial(const World& world, const StepSettings& settings)
{
	if (specialFor != system.contactSet) {
		specialFor = system.contactSet;
		specials.clear();
		specialOf.assign(special.size(), -1);
		for (std::size_t i = 0; i < special.size(); i++)
			if (special[i]) {
				specialOf[i] = static_cast<int32_t>(specials.size());
				specials.push_back(static_cast<int32_t>(i));
			}
	}
	specialRows.resize(specials.size());
	for (std::size_t k = 0; k < specials.size(); k++) {
		// They are far from each other in memory: first the pairs are prefetched, then their bodies.
		if (k + 8 < specials.size()) {
			const int32_t pair = rowPair[specials[k + 8]];
			__builtin_prefetch(&world.pairs[pair]);
			__builtin_prefetch(&world.carried[pair]);
			__builtin_prefetch(&overlaps[pair]);
		}
		if (k + 4 < specials.size()) {
			const Pair& pair = world.pairs[rowPair[specials[k + 4]]];
			__builtin_prefetch(&places[pair.b]);
			__builtin_prefetch(&system.bodies[pair.b]);
		}
		double turned;
		specialRows[k] = rowOf(world, rowPair[specials[k]], settings, turned);
		if (!(specialRows[k].wnn > 0) || !(specialRows[k].bias >= 0))
			return false;
	}
	return true;
}

} // namespace cd
