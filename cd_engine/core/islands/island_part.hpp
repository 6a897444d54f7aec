// Some islands of a system, as a system with a body numbering of its own.
#pragma once

#include "error/error.hpp"
#include "graph/graph.hpp"

namespace cd {

template <class Space> struct IslandPart {
	using ContactSystem = cd::ContactSystem<Space>;

	ContactSystem system;
	std::vector<double> freeVelocity; // of its bodies, the freedoms of each
	std::vector<int32_t> bodies, contacts; // their numbers in the whole system
	std::vector<int32_t> islandOf; // of each contact, in the whole system
	std::vector<int32_t> place; // of each body of the whole system: its number here; -1: not in it

	// Takes the islands that are wanted: contacts in the order of the whole, bodies with their free velocities.
	template <class Wanted>
	void take(const ContactSystem& whole, const std::vector<double>& free, const Partition& partition, const Wanted& wanted)
	{
		system.bodies.clear();
		system.places.clear();
		system.contacts.clear();
		system.contacts.compliant = whole.contacts.compliant;
		system.contacts.pushing = whole.contacts.pushing;
		freeVelocity.clear();
		bodies.clear();
		contacts.clear();
		islandOf.clear();
		system.memory = whole.memory;
		place.assign(whole.bodies.size(), -1);
		for (std::size_t i = 0; i < whole.contacts.size(); i++) {
			const int32_t island = partition.ofContact[i];
			if (island < 0 || !wanted(island))
				continue;
			system.contacts.push_back(whole.contacts[i]);
			ContactRow<Space>& c = system.contacts.back();
			c.a = takeBody(whole, free, c.a);
			c.b = takeBody(whole, free, c.b);
			contacts.push_back(static_cast<int32_t>(i));
			islandOf.push_back(island);
		}
	}

	// Gives the impulses of the islands that are wanted back to the whole.
	template <class Wanted> void giveBack(ContactSystem& whole, const Wanted& wanted) const
	{
		for (std::size_t i = 0; i < contacts.size(); i++)
			if (wanted(islandOf[i]))
				setImpulse(whole.contacts[contacts[i]], impulseOf(system.contacts[i]));
	}

	// Replaces the errors of its islands by new ones.
	void measure(std::vector<ResidualSum>& errors) const
	{
		for (const int32_t k : islandOf)
			errors[k] = {};
		addResiduals(system, freeVelocity, islandOf, errors, bodies.data());
	}

    private:
	int32_t takeBody(const ContactSystem& whole, const std::vector<double>& free, int32_t body)
	{
		if (place[body] < 0) {
			place[body] = static_cast<int32_t>(bodies.size());
			bodies.push_back(body);
			system.bodies.push_back(whole.bodies[body]);
			const double* const v = &free[Space::freedoms * static_cast<std::size_t>(body)];
			freeVelocity.insert(freeVelocity.end(), v, v + Space::freedoms);
			std::copy_n(v, Space::freedoms, system.bodies.back().v);
			if (!whole.places.empty())
				system.places.push_back(whole.places[body]);
		}
		return place[body];
	}
};

} // namespace cd
