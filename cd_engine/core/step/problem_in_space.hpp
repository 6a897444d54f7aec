// Sets up the contact problem of a step in space: problem_builder.hpp says what the members do.
//
// A row holds only contacts whose normal passes through the centre of what turns. A boundary that turns as prescribed is met elsewhere. So each of
// its contacts gets a body of its own that no impulse moves, after the bodies of the world: the point of the boundary's surface, with its velocity.
#pragma once

#include "step/finder_in_space.hpp"
#include "step/problem_builder.hpp"

namespace cd {

template <> class ProblemBuilder<Space3> {
    public:
	void build(const StepView<Space3>&, const ContactFinder<Space3>&, ContactSystem<Space3>&, bool same, bool postpones);
	void append(const StepView<Space3>&, const ContactFinder<Space3>&, ContactSystem<Space3>&);
	void guessAgain(const StepView<Space3>&, const ContactFinder<Space3>&, ContactSystem<Space3>&, bool warm) const;
	bool lowerRebounds(const StepView<Space3>&, ContactSystem<Space3>&, const SolverReport&, double tolerance, bool last);
	bool energyRemains() const { return rebounds.energyRemains(); }

    private:
	void fill(const StepView<Space3>&, const ContactFinder<Space3>&, ContactSystem<Space3>&, std::size_t first);
	void addPoints(const StepView<Space3>&, const ContactFinder<Space3>&, ContactSystem<Space3>&, std::size_t first);
	ContactRow<Space3> makeRow(const StepView<Space3>&, const ContactFinder<Space3>&, std::size_t contact);
	void demandRebound(const StepView<Space3>&, const ContactFinder<Space3>&, std::size_t contact, ContactRow<Space3>&, double turned);

	std::vector<int32_t> pointOf; // of each contact: the body that is a point of its boundary, or -1; empty: no boundary turns
	Rebounds<Space3> rebounds;
};

} // namespace cd
