// A contact problem packed for sweeps. Left in the memory of the system, where the next sweeps find it: they fill in new numbers, as long as contacts
// and bodies are of the same kind, as in most steps of a packing at rest.
#pragma once

#include "sweeps/packed_contacts.hpp"

namespace cd {

template <class Space> struct PackedProblem {
	using ContactSystem = cd::ContactSystem<Space>;

	// What is the same as in the problem before.
	struct Same {
		bool groups, masses;
	};

	// Packs a problem, in blocks for the threads.
	Same pack(ContactSystem&, Threads*);
	// Copies impulses and velocities back to the system. To be called once (PackedBodies::store).
	void store(ContactSystem&, Threads*) const;

	Partition partition; // of the system
	Blocks blocks;
	PackedBodies<Space> bodies;
	PackedContacts<Space> contacts;
	bool twisted = false; // whether external forces turn any body

    private:
	bool fill(const ContactSystem&, Threads*);
};

} // namespace cd
