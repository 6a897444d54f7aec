// Which pairs are contacts in a step.
//
// A pair is a contact if its bodies may close its gap at their present velocities. This depends only on its gap and on its two bodies' velocities, so
// a fast body makes no contacts elsewhere. With restitution only those are that are closed, or that these velocities close. Pairs that are left out
// but whose gap the solution closes join later, and the step is solved again.
#pragma once

#include "step/found_contacts.hpp"

#include <vector>

namespace cd {

template <class Space> class ContactFinder;

template <> class ContactFinder<Plane> : public FoundContacts<Plane> {
    public:
	// Finds the contacts. Stops disks whose centre has come through a face. Where the surfaces of a pair are apart, its reference overlap ends.
	// Returns whether the contacts are those of the last step.
	bool find(World&, const StepView<Plane>&, BodyMotion<Plane>&, const BodyMotion<Plane>::Start&);
	// If the solution lets a pair that was left out cross its gap, adds it and all others whose gap the bodies are fast enough to close, since an
	// impact may spread from body to body. Returns whether there were such pairs.
	bool addClosing(const StepView<Plane>&);
	// Finds the overlaps at these places, up to round-off those of an earlier step.
	void locateAll(const World&, const BodyMotion<Plane>&);
	// Where the contact of a pair that carries a force touched at these places, at which it was located last.
	Touch touchOf(const World& world, std::size_t pair, const BodyMotion<Plane>& motion) const
	{
		const Carried& carried = world.carried[pair];
		return touchAt(carried.nx, carried.ny, -overlaps[pair], motion.places()[world.pairs[pair].b]);
	}

	double overlap(std::size_t pair) const { return overlaps[pair]; } // the geometric one; negative: apart [m]
	double gap(const World& world, std::size_t pair) const { return world.pairs[pair].reference - overlaps[pair]; } // [m]
	void prefetch(std::size_t pair) const { __builtin_prefetch(&overlaps[pair]); }

    private:
	struct Examined {
		double overlap, gap; // [m]
		bool contact, through;
	};

	Found searchRange(const StepView<Plane>&, std::size_t from, std::size_t to);
	Found search(const StepView<Plane>&);
	Examined examine(const StepView<Plane>&, const Pair&, double beyond, double overlap, double gap) const;
	bool fastEnough(const StepView<Plane>&, std::size_t pair) const;
	bool crosses(const StepView<Plane>&, std::size_t pair) const;

	std::vector<double> overlaps; // of the pairs examined [m]
	HiddenCorners corners;
};

} // namespace cd
