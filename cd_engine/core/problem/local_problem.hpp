// The local problem of one contact while all others are held: Signorini's condition and Coulomb's law with a full 2 x 2 block.
#pragma once

#include <cmath>

namespace cd {

// Finds p such that u = w p + q obeys the contact law, with w = (wnn, wnt; wtn, wtt). Tries in this order: open, sticking, sliding either way.
// If mu |W_nt| >= W_nn or W_tt (a contact that can wedge), several cases may hold; the first one is taken.
inline void solveLocal(double wnn, double wnt, double wtn, double wtt, double mu, double qn, double qt, double& pn, double& pt)
{
	pn = pt = 0;
	if (!(qn < 0))
		return;
	const double determinant = wnn * wtt - wnt * wtn;
	const bool regular = determinant > 1e-14 * wnn * wtt;
	if (regular) {
		pn = (-qn * wtt + qt * wnt) / determinant;
		pt = (-qt * wnn + qn * wtn) / determinant;
		if (pn >= 0 && std::abs(pt) <= mu * pn)
			return;
	}
	pn = -qn / wnn;
	pt = 0;
	// No impulse changes the velocity along t, which is qt + wtn pn. Where bodies are driven so that they slide, friction opposes it. Where they
	// do not, up to round-off (beside the velocity -qn with which they would close), any friction within the cone would do, and none is taken.
	if (!regular && wtt <= 1e-14 * wnn && !(std::abs(qt * wnn - wtn * qn) > 1e-12 * std::abs(qt * wnn) - 1e-10 * qn * wnn))
		return;
	for (const double side : { -1., 1. }) {
		const double w = wnn + side * mu * wnt;
		if (w <= 0)
			continue;
		const double slidingPn = -qn / w;
		if (side * (qt + (wtn + side * mu * wtt) * slidingPn) > 0)
			continue; // friction would push along the motion
		pn = slidingPn;
		pt = side * mu * slidingPn;
		return;
	}
}

} // namespace cd
