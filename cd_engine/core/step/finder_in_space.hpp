// Which pairs are contacts in a step in space: contact_finder.hpp has the rules and says what the members do.
#pragma once

#include "step/contact_finder.hpp"
#include "step/view_in_space.hpp"

namespace cd {

template <> class ContactFinder<Space3> : public FoundContacts<Space3> {
    public:
	bool find(WorldOf<Space3>&, const StepView<Space3>&, BodyMotion<Space3>&, const BodyMotion<Space3>::Start&);
	bool addClosing(const StepView<Space3>&);
	void locateAll(const WorldOf<Space3>&, const BodyMotion<Space3>&);
	SpaceTouch touchOf(const WorldOf<Space3>& world, std::size_t pair, const BodyMotion<Space3>& motion) const
	{
		return touchAt(world.carried[pair].n, -meetings[pair].overlap, motion.places()[world.pairs[pair].b]);
	}

	double gap(const WorldOf<Space3>& world, std::size_t pair) const { return world.pairs[pair].reference - meetings[pair].overlap; }
	// Where the bodies of a pair met when they were located last, half a step ahead.
	SpaceTouch touch(const StepView<Space3>& step, std::size_t pair) const
	{
		return touchAt(meetings[pair].n, -meetings[pair].overlap, step.place(step.world.pairs[pair].b));
	}

    private:
	void locate(const StepView<Space3>&);
	Found choose(const StepView<Space3>&, std::size_t from, std::size_t to);
	bool closes(const StepView<Space3>&, std::size_t pair, const SpaceMeeting&, double gap) const;
	bool fastEnough(const StepView<Space3>&, std::size_t pair) const;
	bool crosses(const StepView<Space3>&, std::size_t pair) const;
	HiddenFeatures::Standing standing(const StepView<Space3>&) const;
	bool isHidden(const StepView<Space3>&, std::size_t pair) const;
	bool isThrough(const StepView<Space3>&, const Pair&, SpaceFoot&) const;
	bool stopAtFaces(const StepView<Space3>&, BodyMotion<Space3>&);
	void passSprings(WorldOf<Space3>&) const;

	std::vector<SpaceMeeting> meetings; // of the pairs examined
	std::vector<SpaceMeeting> ahead; // of contacts with facets around a concave edge (HiddenFeatures::meetsAhead), else without a meaning
	HiddenFeatures features;
};

} // namespace cd
