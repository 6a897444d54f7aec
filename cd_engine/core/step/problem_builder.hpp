// Sets up the contact problem of a step: a row each contact (ContactRow), with its first guess and what restitution demands of it.
//
// If the contacts are those of the step before, and nothing needs a row of each, the rows are postponed: contacts between disks then go straight into
// the groups of the sweeps (GroupSource). Without this, steps of packings at rest take 13 to 30 % longer.
#pragma once

#include "kernels/kernels.hpp"
#include "step/contact_finder.hpp"
#include "step/rebounds.hpp"

namespace cd {

template <class Space> class ProblemBuilder;

template <> class ProblemBuilder<Plane> : GroupSource<Plane> {
    public:
	// Sets up all contacts, or postpones their rows. In this case the first two arguments must live until the rows are made or the system has
	// forgotten its source. same: the contacts are those of the last step. postpones: nobody reads all rows for sure.
	void build(const StepView<Plane>&, const ContactFinder<Plane>&, ContactSystem<Plane>&, bool same, bool postpones);
	// Adds the contacts that the finder has added. The first guess is the impulse that would stop this contact alone: with 0 a large system's
	// error may not show it.
	void append(const StepView<Plane>&, const ContactFinder<Plane>&, ContactSystem<Plane>&);
	// Restores the first guess, or sets it to zero if not `warm`. Contacts that were added have none.
	void guessAgain(const StepView<Plane>&, const ContactFinder<Plane>&, ContactSystem<Plane>&, bool warm) const;
	// Whether the step must be solved again because its rebounds demand more than the energy allows, or make it unsolvable. last: it can be
	// solved only once more.
	bool lowerRebounds(const StepView<Plane>&, ContactSystem<Plane>&, const SolverReport&, double tolerance, bool last);
	// Whether rebounds that are all given up still add energy.
	bool energyRemains() const { return rebounds.energyRemains(); }

	// Whether the kernels cannot make the row of a contact, nor tell what its impulse does.
	bool isSpecial(std::size_t contact) const { return specialOf[contact] >= 0; }
	const ContactRow<Plane>& specialRow(std::size_t contact) const { return specialRows[specialOf[contact]]; } // if all rows are postponed

    private:
	std::array<double, 2> guess(const StepView<Plane>&, std::size_t pair) const;
	ContactRow<Plane> makeRow(const StepView<Plane>&, const ContactFinder<Plane>&, std::size_t pair, double& turned) const;
	void fillRows(const StepView<Plane>&, const ContactFinder<Plane>&, ContactRow<Plane>* all, std::size_t from, std::size_t to);
	void fillAll(ContactRow<Plane>*, std::size_t count);
	static void soften(const StepView<Plane>&, const ContactFinder<Plane>&, std::size_t pair, double turned, ContactRow<Plane>&);
	static void moveOn(const StepView<Plane>&, double kn, ContactRow<Plane>&);
	void demandRebound(const StepView<Plane>&, const ContactFinder<Plane>&, std::size_t contact, ContactRow<Plane>&, double turned);
	bool makeSpecials();

	void makeRows(std::vector<ContactRow<Plane>>&) override;
	ContactRow<Plane> row(int32_t contact) const override;
	void fill(const int32_t* contacts, std::size_t count, const double* inverseRadius, Group<Plane>* groups, GroupSprings<Plane>* springs,
	    uint8_t* left) const override;

	// Of each contact: its place in `specials`, or 0 while they are not numbered; -1: it is none.
	std::vector<int32_t> specialOf;
	bool numbered = false;
	std::vector<int32_t> specials; // contacts
	std::vector<ContactRow<Plane>> specialRows; // their rows, if all rows are postponed
	// What postponed rows are made from.
	const StepView<Plane>* step = nullptr;
	const ContactFinder<Plane>* finder = nullptr;
	Rebounds<Plane> rebounds;
};

} // namespace cd
