// What restitution asks of a step's contacts, and how much of it the energy allows.
//
// Moreau's law (1988, Unilateral contact and dry friction in finite freedom dynamics, section 4): every contact that is closed, or that the
// velocities before the step would close within it, takes
//   0 <= u_n' + e u_n  _|_  p_n >= 0,   u_n before the step,
// also if it separates already: impacts elsewhere on its bodies may push it back at up to e u_n. Without friction the energy of the step then changes
// by -(1 - e)/(1 + e) p.W p/2 <= 0, however the contacts are coupled. A law that demands u_n' >= 0 of separating contacts creates energy.
//
// Bodies that are held, by two loaded contacts or by one with a body that can move, do not rebound from each other at speeds up to what the forces of
// a step, such as gravity, give each of them: this is no impact, but what is left of motions that steps do not resolve. So a packing comes to rest:
// 1900 spheres with e = 0.5 in a silo take 2 to 10 sweeps a step then; they rattled on, with 470 to 760, without this.
//
// With friction the same law can create energy where contacts are coupled (Kane and Levinson 1985); with e = 0 it cannot. So e is lowered in the
// islands of contacts that would create energy, until they do not. A disk wedged between two faces may be unable to leave both as fast as
// the law demands, so that the step has no solution. Then e is set to 0 at once in its island, as in islands that create energy in a step that is
// not solved.
#pragma once

#include "graph/graph.hpp"
#include "scene/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cd {

template <class Space> struct StepView;

template <class Space> class Rebounds {
	using ContactSystem = cd::ContactSystem<Space>;

    public:
	// Energy that the error of a solution may add in a step at a loose tolerance, as a share of the sum of m |dv|^2, with dv the velocity change
	// by the impulses. Rebounds dissipate up to (1 - e)/(1 + e) of half this sum themselves; beside that it is little, so it does not add up. A
	// step that adds more is first solved again to this tolerance, which takes most errors away. What then remains counts as made by the law.
	static double mostGain(double e) { return 1e-5 + 1e-2 * (1 - e); }

	// A new step, of so many contacts; 0: none rebounds.
	void restart(const StepView<Space>&, std::size_t contacts);
	// Of a contact of the system, before the step: gap, what turning faces change of it in the step [m], normal velocity [m/s].
	struct Approach {
		double gap, turned, un;
	};
	// Notes what restitution asks of the contact of a pair, a row whose bias knows of none yet. Returns its bias.
	double demand(std::size_t contact, const StepView<Space>&, int32_t pair, const Approach&, const ContactRow<Space>&);
	// Whether any contact has a part in an impact.
	bool any() const;

	// Lowers the biases in the islands whose impulses have added more energy than round-off, `tolerance` and mostGain(e) allow. Returns whether
	// this changed a bias. To be called again after the next solution. `before`: the bodies before the step of dt. Islands are lowered only if
	// the energy grows both over the whole step and over the impulses alone. If only one of the two grows, the work of the forces in the step
	// causes it, not the rebounds. atOnce: give up all rebounds of such an island. Where `tolerance` is above mostGain(e), only says that there
	// are such islands. e: the largest of the scene.
	bool lower(ContactSystem&, const std::vector<BodyOf<Space>>& before, double dt, double tolerance, double e, bool atOnce);

	// Whether the last call of lower() found an island that adds energy although its rebounds are all given up.
	bool energyRemains() const { return remains; }

	// Gives up all rebounds in the island of contact `row`, in a step that has no solution with them; if `row` is negative, in every island.
	// Returns whether there was a rebound to give up.
	bool giveUp(ContactSystem&, int32_t row);

    private:
	struct Demand {
		double plain; // bias without restitution [m/s]
		double rebound; // e u_n [m/s]; NaN: the contact has no part in an impact
	};
	// The bias of a contact in an impact: e u_n, or the bias of its gap if this one pushes harder (plain < 0).
	static double bias(double plain, double rebound) { return plain < 0 && plain < rebound ? plain : rebound; }
	// Balance of an island, stored at the body that names the island.
	struct Balance {
		double sinceBefore = 0, sinceFree = 0; // work of its impulses, from the velocities before the step and from the free ones on [J]
		double scale = 0; // sum of m |dv|^2, dv the velocity change by the impulses [J]
		double energy = 0; // kinetic energy of its bodies after the step [J]
		int lowered = 0; // how often its rebounds were lowered
	};

	void findIslands(const ContactSystem&);
	Balance& balanceOf(std::size_t contact) { return balances[partition.nameAt(contact)]; }
	bool reduce(ContactSystem&);

	bool remains = false;
	std::vector<Demand> demands; // of the contacts
	std::vector<int> loads; // of each body: its loaded contacts in the step before, those with bodies that can move twice
	Partition partition; // of the system
	std::vector<Balance> balances; // by body; empty: no islands found yet in this step
};

} // namespace cd
