// What restitution asks of a step's contacts, and how much of it the energy allows.
//
// Moreau's law (1988, Unilateral contact and dry friction in finite freedom dynamics, section 4): every contact that is closed, or that the
// velocities before the step would close within it, takes
//   0 <= u_n' + e u_n  _|_  p_n >= 0,   u_n before the step,
// also one that parts already: it may be pushed back at up to e u_n by what hits its bodies elsewhere. Without friction the step's energy then
// changes by -(1 - e)/(1 + e) p.W p/2 <= 0, whatever the contacts have in common; a law that asks u_n' >= 0 of those that part makes energy.
//
// With friction the same law can make energy where contacts are coupled (Kane and Levinson 1985), at e = 0 it cannot. So e is lowered, in
// the islands of contacts that would make some, until they do not. A wedged disk may have no velocities that part from both sides as fast as asked:
// there e = 0 at once.
#pragma once

#include "contact_system.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cd {

class Rebounds {
    public:
	// Of m |dv|^2, which a step may add to the energy at a loose tolerance; dv is the velocity that the impulses have changed. What is asked
	// again is solved to this at least.
	static constexpr double mostGain = 1e-5;

	// The bias of a contact in an impact: e u_n, or what its gap asks for where that pushes harder (plain < 0).
	static double bias(double plain, double rebound) { return plain < 0 && plain < rebound ? plain : rebound; }

	void clear();
	void resize(std::size_t contacts) { asked.resize(contacts); }
	// Of a contact of the system: its bias without restitution, and e u_n [m/s]; a NaN if it has no part in an impact.
	void set(std::size_t row, double plain, double rebound) { asked[row] = { plain, rebound }; }
	// Whether any contact has a part in an impact.
	bool any() const;

	// Lowers the biases in the islands whose impulses have added energy by more than round-off, `tolerance` and mostGain leave open; says whether
	// there are such islands. To be asked again after the next solution. `before`: the velocities before the step, `free`: those that the
	// external forces alone would leave. The energy is that over the step and that over the impulses alone: if only one of them grows, by what
	// the forces do in a step, that is not the rebounds' doing.
	bool lower(ContactSystem&, const std::vector<double>& before, const std::vector<double>& free, double tolerance);

	// Whether the last look has found an island that adds energy without any rebound, by what its solution leaves open.
	bool energyRemains() const { return remains; }

	// Asks no rebound any more in the island of contact `row`, of a step that has no solution with it; in every island where that is negative.
	// Says whether there was one to be given up.
	bool giveUp(ContactSystem&, int32_t row);

    private:
	int32_t islandOf(int32_t body);
	void findIslands(const ContactSystem&);

	struct Asked {
		double plain, rebound;
	};
	// Of an island, kept where the body stands that names it.
	struct Account {
		double sinceBefore = 0, sinceFree = 0; // work of its impulses [J]
		double scale = 0; // sum of m |dv|^2, dv being what the impulses have changed the velocities by [J]
		double energy = 0; // of its bodies after the step [J]
		bool gains = false;
		int lowered = 0; // how often
	};
	Account& accountOf(const ContactSystem&, const ContactRow&);
	bool askAgain(ContactSystem&);

	bool remains = false;
	std::vector<Asked> asked; // of the contacts
	std::vector<int32_t> parent; // of every body, towards the one that names its island; empty: not looked for yet
	std::vector<Account> accounts; // by body
};

} // namespace cd
