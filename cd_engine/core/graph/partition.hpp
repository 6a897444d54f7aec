// Divides the contacts of a system into islands: sets of contacts that are connected through movable bodies. No impulse passes through an
// immobile body, so two heaps on one fixed floor are two islands, while a movable wall joins all that touch it. None passes through a
// contact along whose normal nothing can move, either.
#pragma once

#include "problem/problem.hpp"
#include "base/base.hpp"

namespace cd {

// What islands and the order of the sweeps need to know about a contact. solvable: whether a body can move along the normal.
struct Link {
	int32_t a, b;
	bool solvable;
	bool operator==(const Link& other) const { return a == other.a && b == other.b && solvable == other.solvable; }
};
template <class Space> Link linkOf(const ContactRow<Space>& c) { return { c.a, c.b, c.wnn > 0 }; }

// How many of the velocity components of a body can change.
template <class Space> int freedoms(const BodyVelocity<Space>& b)
{
	return static_cast<int>(std::count_if(b.w, b.w + Space::freedoms, [](double w) { return w > 0; }));
}

class Partition {
    public:
	// Finds the islands of this system, whose rows are made unless they are known. Returns false if its contacts and freedoms, and so its
	// islands, are those of the last system.
	template <class Space> bool update(const ContactSystem<Space>&, Threads* = nullptr);
	// Whether the rows of this system are postponed and link the same bodies as those of the last one, all of which could be solved.
	template <class Space> bool knows(const ContactSystem<Space>& s) const { return s.contacts.postponed() && s.contactSet == contactSet; }

	struct Island {
		int32_t first = 0; // index of the first contact
		int32_t contacts = 0; // number of contacts
	};

	std::vector<Link> links; // one a contact
	std::vector<Island> islands; // in the order of their first contacts
	std::vector<int32_t> ofContact; // island of each contact; -1: neither body can move along the normal
	std::vector<int32_t> ofBody; // island of each body; -1: the body cannot move or touches nothing
	std::vector<int32_t> name; // of each body: the first movable body of its island
	std::vector<uint8_t> freedom; // of each body: how many of its velocity components can change

	// The name of the island of a contact.
	int32_t nameAt(std::size_t contact) const { return name[mobileOf(links[contact])]; }

    private:
	template <class Space> bool sameLinks(const ContactSystem<Space>&, Threads*);
	int32_t mobileOf(const Link& link) const { return freedom[link.a] > 0 ? link.a : link.b; }
	int32_t root(int32_t body);
	void number();

	std::size_t contactSet = 0; // of the last system
};

} // namespace cd
