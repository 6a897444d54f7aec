// What the accounts of the plane and of space have in common: sums over the contacts of a step, and those of sleeping islands.
#pragma once

#include "step/account.hpp"

#include <algorithm>

namespace cd {

inline SpringEnergies<double> operator+(const SpringEnergies<double>& a, const SpringEnergies<double>& b)
{
	return { a.stored + b.stored, a.before + b.before, a.absorbed + b.absorbed, a.dashpots + b.dashpots };
}

struct Totals {
	int loaded = 0, sliding = 0;
	double dissipated = 0, work = 0; // [J]
	SpringEnergies<double> springs {};

	Totals operator+(const Totals& b) const
	{
		return { loaded + b.loaded, sliding + b.sliding, dissipated + b.dissipated, work + b.work, springs + b.springs };
	}
	void addTo(StepReport& report) const
	{
		report.loadedContacts += loaded;
		report.slidingContacts += sliding;
		report.dissipated = dissipated; // it began with what the report had
		report.work = work;
		report.stored = springs.stored;
		report.storedBefore = springs.before;
		report.absorbed = springs.absorbed;
		report.dashpots = springs.dashpots;
	}
};

template <std::size_t freedoms> void add(std::array<double, freedoms>& to, const std::array<double, freedoms>& of)
{
	for (std::size_t k = 0; k < freedoms; k++)
		to[k] += of[k];
}

// Nothing is left of what the contact of a pair has carried. An island in which a force changes does not sleep.
template <class Space> void release(const Pair& pair, typename Space::Carried& was, Sleepers<Space>& sleepers)
{
	if (!was.any())
		return;
	sleepers.disturb(pair.a, pair.b);
	was = {};
}

// book(from, to): the Totals of a range of contacts. Pairs that are no contacts are released.
template <class Space, class Book>
void bookAll(WorldOf<Space>& world, const StepView<Space>& step, const ContactFinder<Space>& finder, std::size_t contacts, Sleepers<Space>& sleepers,
    const Book& book, StepReport& report)
{
	// Only one thread may report what it wakes.
	reduceRanges<Totals>(sleepers.none() ? &step.threads : nullptr, contacts, book, std::plus<Totals>()).addTo(report);
	if (contacts < world.awake.size())
		for (const int32_t i : world.awake)
			if (!finder.isContact(i))
				release<Space>(world.pairs[i], world.carried[i], sleepers);
}

// Sums the impulses, and adds what sleeping islands contribute: those that this step has examined and the others. Of contact i:
// slides(i); stored(i), the energy of its springs [J]; giveBoth(i, give), which calls give(body, impulse).
template <class Space, class Slides, class Stored, class GiveBoth>
void addSleeping(const WorldOf<Space>& world, const ContactFinder<Space>& finder, const ContactRows<Space>& contacts, const Slides& slides,
    const Stored& stored, const GiveBoth& giveBoth, std::vector<typename Account<Space>::Impulse>& sums, Sleepers<Space>& sleepers,
    StepReport& report)
{
	sums.resize(world.bodies.size());
	sleepers.powerless.clear();
	for (std::size_t i = 0; i < contacts.size(); i++) {
		const ContactRow<Space>& c = contacts[i];
		const int32_t index = finder.pairs()[i];
		const Pair& pair = world.pairs[index];
		SleepingIsland* const asleep = sleepers.islandAt(pair.a, pair.b);
		if (asleep && !(c.wnn > 0)) {
			sleepers.powerless.push_back(index);
			continue;
		}
		if (asleep) {
			report.contacts--;
			asleep->contacts++;
			asleep->deepest = std::max(asleep->deepest, -finder.gap(world, index));
			if (i >= finder.foundFirst()) // a contact that was added later is none in the next step
				sleepers.disturb(asleep->name, "a contact came late", pair.a);
			asleep->loaded += c.pn > 0;
			asleep->sliding += c.pn > 0 && slides(i);
			if (world.compliant())
				asleep->stored += stored(i);
		}
		if (asleep || c.pn > 0)
			giveBoth(i, [&](int32_t body, const typename Account<Space>::Impulse& impulse) {
				if (!asleep || sleepers.sleeps(body))
					add(sums[body], impulse);
				else
					sleepers.addBoundaryImpulse({ asleep->name, static_cast<int32_t>(i), body, impulse });
			});
	}
	for (const SleepingIsland& island : sleepers.islands()) {
		report.contacts += island.contacts;
		report.loadedContacts += island.loaded;
		report.slidingContacts += island.sliding;
		report.stored += island.stored;
		report.maxPenetration = std::max(report.maxPenetration, island.deepest);
	}
	for (const auto& of : sleepers.boundaryImpulses())
		add(sums[of.body], of.impulse);
}

} // namespace cd
