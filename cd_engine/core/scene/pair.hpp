// Pairs of shapes that may touch, and the force of their contact from step to step.
#pragma once

#include "scene/plane.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace cd {

// Two shapes near each other. If one of them is a boundary, it is `a`. Two boundaries never touch.
struct Pair {
	int32_t a, b;
	double mu = 0; // friction coefficient
	double reference = 0; // overlap that counts as zero gap [m], left behind by springs; reset to 0 once the bodies separate
};

// The stiffness of a pair [N/m]; kt may be 0 (no friction) or infinite (friction without a spring).
struct Stiffness {
	double kn, kt;
};

// How a pair resists rolling.
struct Rolling {
	double bound; // of the moment, over the normal force [m]; 0: it does not
	double stiffness; // of the spring against rolling, if contacts have a stiffness [N m]; 0: there is none, and no moment

	bool operator==(const Rolling& o) const { return bound == o.bound && stiffness == o.stiffness; }
};

// The force of a contact after the last step, as a scene keeps it. Times the length of the next step it is that step's first guess.
struct alignas(64) Carried {
	static constexpr long nothing = std::numeric_limits<long>::min();
	double nx = 0, ny = 0; // unit normal a -> b in that step
	double fn[Plane::components] = {}, ft[Plane::components] = {}; // normal and tangential force on b [N]
	long since = nothing; // step in which the contact became loaded; `nothing`: it carries nothing, and the other members are 0
	double moment = 0; // on b, where the contact resists rolling [N m]

	bool any() const { return since != nothing; }
	// Whether it is the same force; `since` may differ.
	bool same(const Carried& o) const
	{
		return any() == o.any() && nx == o.nx && ny == o.ny && fn[0] == o.fn[0] && fn[1] == o.fn[1] && ft[0] == o.ft[0] && ft[1] == o.ft[1]
		    && moment == o.moment;
	}
	// Along the normal, and across it, times dt [N s].
	std::array<double, 2> impulse(double dt) const
	{
		const double normal = nx * fn[0] + ny * fn[1], tangential = nx * ft[1] - ny * ft[0];
		if (!(normal > 0) || !std::isfinite(tangential))
			return { 0, 0 }; // springs may pull; a rigid contact does not
		// n is a unit vector only to its last digit. Without this division, forces that are stored and read again would grow by that step by
		// step.
		const double square = nx * nx + ny * ny;
		return { dt * normal / square, dt * tangential / square };
	}
};
static_assert(sizeof(Carried) == 64 && offsetof(Carried, ft) == 32);

} // namespace cd
