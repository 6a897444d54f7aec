// What the impulses of a step do: the forces that contacts carry on to the next step, sliding and loaded contacts, dissipated energy, and the
// impulses on the bodies. Few steps are published, so these are summed only when somebody asks for them, except in a step with sleeping islands,
// which keep theirs.
#pragma once

#include "step/problem_builder.hpp"

namespace cd {

template <class Space> class Account;

template <> class Account<Plane> {
    public:
	using Impulse = std::array<double, 3>; // on a body: [N s], [N s], about its centre [N m s]

	// Before a step: the impulses of the last one can no longer be summed.
	void begin();
	// Before a step puts its islands to sleep: those of bodies that sleep already stay.
	void clear(const Sleepers<Plane>&);
	// Writes the forces into the world and adds to the counts and the energy. Wakes the islands in which a force changes. If rows are postponed
	// they must be solved beside. rolling: the same contacts with their moments; null: no pair resists rolling.
	void book(World&, const StepView<Plane>&, const ContactFinder<Plane>&, const ProblemBuilder<Plane>&, const ContactRows<Plane>&,
	    const ContactRow<RollingPlane>* rolling, Sleepers<Plane>&, StepReport&);
	// The impulses of all contacts on each body in the step that has left the world, those of sleeping islands included.
	const std::vector<Impulse>& impulses(
	    const World&, const ContactFinder<Plane>&, const BodyMotion<Plane>&, const ContactRows<Plane>&, const ContactRow<RollingPlane>* rolling);

	// Whether nobody has read a row of the last step's contacts, so that none was made.
	bool sparedRows() const { return spared; }

    private:
	void bookSleeping(const World&, const StepView<Plane>&, const ContactFinder<Plane>&, const ContactRows<Plane>&,
	    const ContactRow<RollingPlane>*, Sleepers<Plane>&, StepReport&);

	std::vector<Impulse> sums;
	bool known = false; // whether they are summed; if not, nothing sleeps, and they can be summed from the contacts of the last step
	bool spared = false;
};

} // namespace cd
