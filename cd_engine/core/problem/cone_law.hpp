// The contact law in space (cone_system.hpp) in formulas: Coulomb's cone is circular.
#pragma once

#include "problem/cone_system.hpp"
#include "problem/law.hpp"

#include <cmath>

namespace cd {

inline double square(const Triple& x) { return x[0] * x[0] + x[1] * x[1] + x[2] * x[2]; }
inline Triple difference(const Triple& a, const Triple& b) { return { a[0] - b[0], a[1] - b[1], a[2] - b[2] }; }
inline double tangential(const Triple& x) { return std::sqrt(x[1] * x[1] + x[2] * x[2]); }

// p_n >= 0 and the tangential part scaled into the disk |p_t| <= mu p_n; a NaN is kept. It solves, exactly, a contact whose own block is diagonal
// with W_tt a multiple of the identity, as between two spheres.
inline Triple cutToDisk(const Triple& z, double mu)
{
	const double n = std::max(z[0], 0.), length = tangential(z), scale = length > mu * n ? mu * n / length : 1;
	return { n, scale * z[1], scale * z[2] };
}

// The nearest point of Coulomb's cone.
inline Triple projectedOnCone(const Triple& z, double mu)
{
	const double length = tangential(z);
	if (z[0] >= 0 && length <= mu * z[0])
		return z;
	if (mu * length <= -z[0])
		return { 0, 0, 0 };
	const double along = (z[0] + mu * length) / (1 + mu * mu), across = length > 0 ? mu * along / length : 0;
	return { along, across * z[1], across * z[2] };
}

// |p - P_K(p - (u + mu |u_t| n)/W_nn)|^2 (residual.hpp), with the bias in u. size: the magnitudes of the terms that add up to u, whose round-off is
// no violation of the law.
inline Miss<double> missOf(const Triple& p, const Triple& u, double mu, double wnn, double size)
{
	constexpr double roundOff = 4 * 2.220446049250313e-16;
	const Triple z = { p[0] - (u[0] + mu * tangential(u)) / wnn, p[1] - u[1] / wnn, p[2] - u[2] / wnn };
	const double miss = square(difference(p, projectedOnCone(z, mu))), known = roundOff * size / wnn;
	return miss <= known * known ? Miss<double> { 0, 0 } : Miss<double> { miss, miss * wnn * wnn };
}

// The impulses of one contact with u = w p + q, exactly; w is any 3 x 3 block whose diagonal is positive (cone_local.cpp).
Triple solveLocal(const ConeBlock& w, double mu, const Triple& q);

} // namespace cd
