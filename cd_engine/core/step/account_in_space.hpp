// What the impulses of a step in space do: account.hpp says what the members do.
#pragma once

#include "step/account.hpp"
#include "step/problem_in_space.hpp"

namespace cd {

template <> class Account<Space3> {
    public:
	using Impulse = std::array<double, 6>; // on a body: [N s], about its centre [N m s]

	void begin();
	void clear(const Sleepers<Space3>&);
	void book(WorldOf<Space3>&, const StepView<Space3>&, const ContactFinder<Space3>&, const ProblemBuilder<Space3>&, const ContactRows<Space3>&,
	    const ContactRow<RollingPlane>* none, Sleepers<Space3>&, StepReport&); // no contact in space resists rolling
	const std::vector<Impulse>& impulses(const WorldOf<Space3>&, const ContactFinder<Space3>&, const BodyMotion<Space3>&,
	    const ContactRows<Space3>&, const ContactRow<RollingPlane>* none);
	bool sparedRows() const { return false; }

    private:
	void bookSleeping(const WorldOf<Space3>&, const StepView<Space3>&, const ContactFinder<Space3>&, const ContactRows<Space3>&,
	    Sleepers<Space3>&, StepReport&);

	std::vector<Impulse> sums;
	bool known = false;
};

} // namespace cd
