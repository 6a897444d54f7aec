// Solves one contact in space exactly. Tried in this order: open; sticking; sliding.
//
// A sliding contact has u_n = 0 and u_t = -s p_t with some s > 0 [1/kg] and |p_t| = mu p_n. With p_n = -(q_n + w_nt p_t)/w_nn eliminated, S the Schur
// complement of w_nn, b = q_t - w_tn q_n/w_nn and D(s) = det(S + s):
//   p_t D(s) = -(a + s b),  a = adj(S) b;   p_n D(s) = Q(s) = P D(s) + c (a + s b),  P = -q_n/w_nn,  c = w_nt/w_nn.
// What remains is F(s) = mu Q(s) - |a + s b| = 0: squared, a quartic in s. F(0) >= 0 means that the contact can stick, and F > 0 for large s, so that
// a contact that cannot stick has a solution in which it slides. Where mu |w_nt| is of the size of w_nn, there may be three such, or one beside
// sticking. The one taken is sticking if it is possible, else the one with the largest s: that which slides fastest for its friction.
#include "problem/cone_law.hpp"

#include <cassert>
#include <limits>

namespace cd {
namespace {

	class Sliding {
	    public:
		Sliding(const ConeBlock& w, double friction, const Triple& q)
		    : mu(friction)
		{
			const double P = -q[0] / w[0];
			c[0] = w[1] / w[0];
			c[1] = w[2] / w[0];
			const double s11 = w[4] - w[3] * c[0], s12 = w[5] - w[3] * c[1], s21 = w[7] - w[6] * c[0], s22 = w[8] - w[6] * c[1];
			b[0] = q[1] + w[3] * P;
			b[1] = q[2] + w[6] * P;
			a[0] = s22 * b[0] - s12 * b[1];
			a[1] = s11 * b[1] - s21 * b[0];
			trace = s11 + s22;
			determinant = s11 * s22 - s12 * s21;
			size = std::abs(s11 * s22) + std::abs(s12 * s21);
			normal = P;
			quadratic[0] = P * determinant + c[0] * a[0] + c[1] * a[1];
			quadratic[1] = P * trace + c[0] * b[0] + c[1] * b[1];
			quadratic[2] = P;
		}

		bool regular() const { return determinant > 1e-14 * size; }
		bool sticks() const { return regular() && value(0) >= 0; }

		// F(s)
		double value(double s) const { return mu * (quadratic[0] + s * (quadratic[1] + s * quadratic[2])) - length(s); }

		// The largest s with F = 0; F(0) < 0.
		double root() const
		{
			double high = beyond();
			if (!(convex(0) && descend(high)))
				high = isolated(high);
			return high;
		}

		Triple impulses(double s) const
		{
			const double D = determinant + s * (trace + s);
			// Without motion along one tangent D and a vanish together with s.
			const double t1 = regular() || s > 0 ? -(a[0] + s * b[0]) / D : 0, t2 = regular() || s > 0 ? -(a[1] + s * b[1]) / D : 0;
			return { normal - c[0] * t1 - c[1] * t2, t1, t2 };
		}

	    private:
		static double norm(const double* x) { return std::sqrt(x[0] * x[0] + x[1] * x[1]); }
		double length(double s) const
		{
			const double x[2] = { a[0] + s * b[0], a[1] + s * b[1] };
			return norm(x);
		}
		double slope(double s) const
		{
			const double l = length(s);
			return mu * (quadratic[1] + 2 * s * quadratic[2])
			    - (l > 0 ? ((a[0] + s * b[0]) * b[0] + (a[1] + s * b[1]) * b[1]) / l : norm(b));
		}

		// An s above all roots: |a + s b| <= |a| + s |b|, which leaves a quadratic equation.
		double beyond() const
		{
			const double two = mu * quadratic[2], one = mu * quadratic[1] - norm(b), none = mu * quadratic[0] - norm(a);
			const double root = std::sqrt(std::max(0., one * one - 4 * two * none));
			return one <= 0 ? (root - one) / (2 * two) : std::max(0., -2 * none / (one + root));
		}

		// Whether F is convex from s on: |a + s b| bends most where it is least.
		bool convex(double s) const
		{
			const double cross = a[0] * b[1] - a[1] * b[0], bb = b[0] * b[0] + b[1] * b[1], least = -(a[0] * b[0] + a[1] * b[1]) / bb;
			const double l = length(std::max(s, least));
			return cross * cross <= 2 * mu * quadratic[2] * l * l * l;
		}

		// Newton's method from above, which descends to the largest root of a convex F.
		bool descend(double& s) const
		{
			for (int k = 0; k < 60; k++) {
				const double f = value(s), d = slope(s);
				if (!(f > 0))
					return true;
				if (!(d > 0))
					return false;
				const double next = s - f / d;
				if (!(next < s * (1 - 1e-15)))
					return true;
				s = std::max(next, 0.);
			}
			return true;
		}

		// The largest root below `high` of the quartic mu^2 Q^2 - |a + s b|^2 with Q > 0, between the roots of its derivatives.
		double isolated(double high) const
		{
			const double m = mu * mu, *Q = quadratic;
			double polynomial[5] = { m * Q[0] * Q[0] - a[0] * a[0] - a[1] * a[1], 2 * (m * Q[0] * Q[1] - a[0] * b[0] - a[1] * b[1]),
				m * (Q[1] * Q[1] + 2 * Q[0] * Q[2]) - b[0] * b[0] - b[1] * b[1], 2 * m * Q[1] * Q[2], m * Q[2] * Q[2] };
			double roots[4], before[6];
			int count = 0;
			for (int degree = 1; degree <= 4; degree++) {
				double d[5]; // the derivative of this degree
				for (int i = 0; i <= degree; i++) {
					d[i] = polynomial[i + 4 - degree];
					for (int k = 1; k <= 4 - degree; k++)
						d[i] *= i + k;
				}
				const auto at = [&](double s) {
					double sum = d[degree];
					for (int i = degree - 1; i >= 0; i--)
						sum = sum * s + d[i];
					return sum;
				};
				before[0] = 0;
				std::copy_n(roots, count, before + 1);
				before[count + 1] = high;
				const int intervals = count + 1;
				count = 0;
				for (int i = 0; i < intervals && count < 4; i++)
					if ((at(before[i]) < 0) != (at(before[i + 1]) < 0))
						roots[count++] = bisected(before[i], before[i + 1], at);
			}
			for (; count > 0; count--) {
				const double s = roots[count - 1];
				if (Q[0] + s * (Q[1] + s * Q[2]) >= 0)
					return polish(s);
			}
			return bisected(0, high, [this](double s) { return value(s); });
		}

		// A few digits of the quartic are lost where Q and |a + s b| cancel.
		double polish(double s) const
		{
			for (int k = 0; k < 4; k++) {
				const double f = value(s), next = s - f / slope(s);
				if (!(next >= 0 && std::abs(value(next)) < std::abs(f)))
					break;
				s = next;
			}
			return s;
		}

		template <class F> static double bisected(double low, double high, const F& f)
		{
			const bool below = f(low) < 0;
			for (int k = 0; k < 200; k++) {
				const double middle = 0.5 * (low + high);
				if (middle <= low || middle >= high)
					break;
				((f(middle) < 0) == below ? low : high) = middle;
			}
			return 0.5 * (low + high);
		}

		const double mu;
		double a[2], b[2], c[2];
		double quadratic[3]; // Q
		double trace, determinant, size, normal;
	};

} // namespace

Triple solveLocal(const ConeBlock& w, double mu, const Triple& q)
{
	assert(w[0] > 0 && w[4] > 0 && w[8] > 0);
	if (!(q[0] < 0))
		return { 0, 0, 0 };
	if (!(mu > 0))
		return { -q[0] / w[0], 0, 0 };
	if (w[1] == 0 && w[2] == 0 && w[3] == 0 && w[5] == 0 && w[6] == 0 && w[7] == 0 && w[4] == w[8])
		return cutToDisk({ -q[0] / w[0], -q[1] / w[4], -q[2] / w[8] }, mu);
	const Sliding contact(w, mu, q);
	return contact.impulses(contact.sticks() ? 0 : contact.root());
}

} // namespace cd
