// The part of a step that contacts with rolling resistance need beside others.
//
// A step finds and sets up its contacts as ever. If any of its pairs resists rolling (World::rollings), the contacts are then copied into rows with a
// third component, solved by kernels of their own, and their impulses copied back; only moments stay here. So a step without rolling resistance
// costs the same as if there were none, and gets the same bits. The copies take some 50 ns a contact, as much as ten sweeps.
#pragma once

#include "step/contact_finder.hpp"

#include <utility>

namespace cd {

// In a space whose contacts have no moments.
template <class Space> class RollingResistance {
    public:
	static bool acts() { return false; }
	void guess(const StepView<Space>&, const ContactFinder<Space>&, bool) { }
	SolverReport solve(
	    const StepView<Space>&, const ContactFinder<Space>&, ContactSystem<Space>&, const SolverSettings&, const Stillness<Space>&, Effort&)
	{
		return {};
	}
	void putToSleep(Sleepers<Space>&, const WorldOf<Space>&) const { }
	static const ContactRow<RollingPlane>* rows() { return nullptr; }
};

template <> class RollingResistance<Plane> {
    public:
	// Whether any pair of the step resists rolling.
	bool acts() const { return any; }
	// Begins a step, or the same anew, from the moments that contacts have carried, or from none if not `warm`.
	void guess(const StepView<Plane>&, const ContactFinder<Plane>&, bool warm);
	// Solves the contacts of a system from its first guess, islands and sleep included. Contacts that are new have no moment yet.
	SolverReport solve(
	    const StepView<Plane>&, const ContactFinder<Plane>&, ContactSystem<Plane>&, const SolverSettings&, const Stillness<Plane>&, Effort&);
	void putToSleep(Sleepers<Plane>& sleepers, const World& world) const { islands.putToSleep(sleepers, world); }
	// Of the solution; null: no pair resists rolling.
	const ContactRow<RollingPlane>* rows() const { return any ? system.contacts.all().data() : nullptr; }

    private:
	void makeRows(const StepView<Plane>&, const ContactFinder<Plane>&, const ContactSystem<Plane>&);

	bool any = false, fresh = false; // fresh: the guesses are those of contacts, not of a solution
	std::vector<double> guesses; // of p_r of each contact; after a solution, that one [N s]
	ContactSystem<RollingPlane> system;
	IslandSolver<RollingPlane> islands;
};

} // namespace cd
