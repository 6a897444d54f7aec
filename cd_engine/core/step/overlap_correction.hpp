// Moves bodies apart that overlap, without giving them a velocity.
//
// A velocity that removes an overlap within some steps stays when it is removed, and throws the bodies. So overlaps are removed from the places that
// a step leaves, by displacements d of a problem of their own, whose multipliers l act as normal impulses do (a split impulse; Catto 2005, "Iterative
// dynamics with temporal coherence", and Bullet's penetration impulse):
//   d = M^-1 H_n l,   0 <= d_n - c _|_ l >= 0
// with c the share of the overlap to be removed, or less than zero by what the contact may still close. A few plain sweeps there and back suffice,
// because the next step goes on with what is left. Where nothing overlaps they cost nothing, and elsewhere most contacts have no part.
#pragma once

#include "step/finder_in_space.hpp"

namespace cd {

template <class Space> class OverlapCorrection {
    public:
	using Row = ContactRow<Space>;
	// Whether a contact of the step overlaps so much that the correction reads the rows.
	static bool isDue(const WorldOf<Space>&, const StepSettings<Space>&, const ContactFinder<Space>&);
	// To be called after the bodies have moved. Returns whether it has moved any.
	bool operator()(WorldOf<Space>&, const StepView<Space>&, const ContactFinder<Space>&, const std::vector<Row>&);

    private:
	void sweep(const Row&, std::size_t contact, const std::vector<BodyVelocity<Space>>& masses);

	std::vector<double> least; // of each contact: c [m]
	std::vector<double> multiplier; // [kg m]
	std::vector<MotionOf<Space>> displacement; // of the bodies [m], [rad]
};

} // namespace cd
