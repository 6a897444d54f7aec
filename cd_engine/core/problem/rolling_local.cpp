// A contact that resists rolling and couples its three components, as those of free boxes do, and those of bodies that can hardly move.
#include "problem/law_rolling.hpp"

#include <array>
#include <utility>

namespace cd {
namespace {

	using Three = std::array<double, 3>;

	// Solves A x = b for the first `count` unknowns by elimination. Returns false if A is singular.
	bool solve(std::array<Three, 3> A, Three b, std::size_t count, Three& x)
	{
		for (std::size_t i = 0; i < count; i++) {
			std::size_t pivot = i;
			for (std::size_t k = i + 1; k < count; k++)
				pivot = std::abs(A[k][i]) > std::abs(A[pivot][i]) ? k : pivot;
			std::swap(A[i], A[pivot]);
			std::swap(b[i], b[pivot]);
			double size = 0;
			for (std::size_t j = i; j < count; j++)
				size = std::max(size, std::abs(A[i][j]));
			if (!(std::abs(A[i][i]) > 1e-14 * size) || A[i][i] == 0)
				return false;
			for (std::size_t k = i + 1; k < count; k++) {
				const double factor = A[k][i] / A[i][i];
				for (std::size_t j = i; j < count; j++)
					A[k][j] -= factor * A[i][j];
				b[k] -= factor * b[i];
			}
		}
		for (std::size_t i = count; i-- > 0;) {
			double sum = b[i];
			for (std::size_t j = i + 1; j < count; j++)
				sum -= A[i][j] * x[j];
			x[i] = sum / A[i][i];
		}
		return true;
	}

} // namespace

// Tries the states in this order: open; t and r hold; one of them yields, either way; both. If friction couples so strongly to the normal that
// several hold, the first one is taken.
RollingComponents<double> solveCoupled(const ContactRow<RollingPlane>& c, const RollingComponents<double>& free)
{
	if (!(free.n < 0))
		return { 0, 0, 0 };
	const std::array<Three, 3> W { { { c.nn(), c.wnt, c.wnr }, { c.wnt, c.tt(), c.wtr }, { c.wnr, c.wtr, c.rr() } } };
	const Three q { free.n, free.t, free.r }, most { 1, c.mu, c.eta };
	// A component whose own impulse moves nothing yields if it is driven. If not, any impulse within its bound would do, and none is taken.
	const auto moves = [&](std::size_t k) { return W[k][k] > 1e-14 * W[0][0]; };
	const auto driven
	    = [&](std::size_t k) { return std::abs(q[k] * W[0][0] - W[k][0] * q[0]) > 1e-12 * std::abs(q[k] * W[0][0]) - 1e-10 * q[0] * W[0][0]; };
	const auto canYield = [&](std::size_t k) { return most[k] > 0 && (moves(k) || driven(k)); };
	constexpr int states[9][2] = { { 0, 0 }, { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 }, { -1, -1 }, { -1, 1 }, { 1, -1 }, { 1, 1 } };
	for (const auto& state : states) {
		std::size_t unknowns[3] = { 0, 0, 0 }, count = 1;
		Three along { 1, 0, 0 }; // of a unit p_n
		bool possible = true;
		for (const std::size_t k : { 1, 2 }) {
			const int side = state[k - 1];
			along[k] = side * most[k];
			if (side != 0)
				possible = possible && canYield(k);
			else if (most[k] > 0 && moves(k))
				unknowns[count++] = k;
			else
				possible = possible && !canYield(k);
		}
		std::array<Three, 3> A {};
		Three b {}, x {};
		for (std::size_t i = 0; i < count; i++) {
			b[i] = -q[unknowns[i]];
			for (std::size_t k = 0; k < 3; k++)
				A[i][0] += W[unknowns[i]][k] * along[k];
			for (std::size_t j = 1; j < count; j++)
				A[i][j] = W[unknowns[i]][unknowns[j]];
		}
		if (!possible || !solve(A, b, count, x) || !(x[0] >= 0))
			continue;
		Three p { x[0], along[1] * x[0], along[2] * x[0] };
		for (std::size_t j = 1; j < count; j++)
			p[unknowns[j]] = x[j];
		bool holds = true;
		for (const std::size_t k : { 1, 2 }) {
			const double u = q[k] + W[k][0] * p[0] + W[k][1] * p[1] + W[k][2] * p[2];
			holds = holds && std::abs(p[k]) <= most[k] * p[0] && !(state[k - 1] * u > 0);
		}
		if (holds)
			return { p[0], p[1], p[2] };
	}
	return { -free.n / c.nn(), 0, 0 };
}

} // namespace cd
