// Which contacts of a system make an island: those that feel each other, through bodies that can move. Impulses do not pass through a body that
// nothing can move, so two heaps on one fixed floor are two islands, and a loaded wall joins all that touch it.
#pragma once

#include "contact_system.hpp"
#include "threads.hpp"

namespace cd {

class Partition {
    public:
	// Of this system; false if its contacts and freedoms are those of the last one, whose islands these then are.
	bool update(const ContactSystem&, Threads* = nullptr);

	struct Island {
		int32_t first = 0; // contact
		int32_t contacts = 0; // how many
	};

	std::vector<Island> islands; // in the order of their first contacts
	std::vector<int32_t> ofContact; // its island; -1: it has nothing that can move along its normal
	std::vector<int32_t> ofBody; // -1: it cannot move or touches nothing
	std::vector<int32_t> name; // of every body: the first of the bodies that can move of its island
	std::vector<uint8_t> freedom; // of every body: how many of its velocities can change

	// The body that gives an island its name.
	int32_t nameOf(const Island& island) const { return name[mobileOf(links[island.first])]; }

    private:
	struct Link {
		int32_t a, b;
		bool solvable;
	};

	bool sameLinks(const ContactSystem&, Threads*);
	int32_t mobileOf(const Link& link) const { return freedom[link.a] > 0 ? link.a : link.b; }
	int32_t root(int32_t body);
	void number();

	std::vector<Link> links; // the contacts
};

int freedoms(const BodyVelocity&);

} // namespace cd
