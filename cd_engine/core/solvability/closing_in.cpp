// Tests whether boundaries close in on bodies, so that no velocities at all keep every contact from overlapping further.
//
// A problem is solvable along the normals if velocities v of the movable bodies exist with  J v + b >= 0.  J v are normal relative velocities, b
// those that the boundaries and the biases prescribe. Friction does not help, as it cannot open a contact. The least total closing velocity,
//   min over v of |min(J v + b, 0)|^2,
// is 0 if and only if such velocities exist. If it is not 0, y = -min(J v + b, 0) at the minimum is the proof (Farkas' lemma): y >= 0, J^T y = 0 and
// b . y = -|y|^2 < 0. The proof does not use the impulses. It serves where impulses that balance each other for other reasons hide a press.
#include "problem/problem.hpp"
#include "solvability/verdict.hpp"
#include "base/base.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cd {
namespace {

	constexpr int rounds = 30; // of Newton's method, at most; each finds which contacts close
	constexpr int halvings = 50; // bisections in the line search of a Newton step
	constexpr double solved = 1e-15; // a gradient below this share of its terms, twice closing(r), is round-off
	// In a step that counts as solved, contacts together may close by this many tolerances. (A single contact may by ten, see solver.cpp.)
	constexpr double missed = 3;
	constexpr double share = 1e-8; // the work b . y must exceed this share of its terms

	double square(const std::vector<double>& a) { return std::inner_product(a.begin(), a.end(), a.begin(), 0.); }

	void add(std::vector<double>& to, double factor, const std::vector<double>& what)
	{
		for (std::size_t i = 0; i < to.size(); i++)
			to[i] += factor * what[i];
	}

	// Rows are weighted by 1/sqrt(W_nn) and velocities by the square roots of the masses, so that the rows of J have length 1.
	class LeastSquares {
	    public:
		int operator()(const ContactSystem& s, const std::vector<double>& free, double tolerance, double bound, int mostProducts)
		{
			system = &s;
			left = mostProducts;
			const double ofFree = read(free), scale = std::sqrt(closing(b)), all = std::max(scale, std::sqrt(ofFree));
			const double least = std::max(share * scale, missed * tolerance * all);
			tryRigidMotion(free);
			if (!(closing(r) > least * least))
				return -1;
			for (int k = 0; k < rounds && left > 0; k++) {
				const double before = closing(r);
				if (!(before > share * share * scale * scale))
					return -1;
				descent(r);
				if (square(g) <= solved * solved * 2 * closing(r))
					break;
				descend();
				along(step, change);
				add(r, best(), change);
				if (!(closing(r) < before))
					break;
			}
			return proof(scale, bound);
		}

	    private:
		// Returns what closing() is with the free velocities of all bodies.
		double read(const std::vector<double>& free)
		{
			double ofFree = 0;
			roots.clear();
			for (const BodyVelocity& body : system->bodies)
				for (const double w : body.w)
					roots.push_back(std::sqrt(w));
			links.clear();
			b.clear();
			r.clear();
			size.clear();
			for (std::size_t i = 0; i < system->contacts.size(); i++) {
				const ContactRow& c = system->contacts[i];
				if (!(c.wnn > 0))
					continue;
				const double root = std::sqrt(c.wnn);
				double prescribed = c.bias, terms = std::abs(c.bias), all = c.bias;
				Link link { static_cast<int32_t>(i), { { 3 * c.a, {} }, { 3 * c.b, {} } } };
				for (const int side : { -1, 1 }) {
					const int32_t body = side < 0 ? c.a : c.b;
					const double arms[3] = { c.nx, c.ny, side < 0 ? c.an : c.bn };
					for (int k = 0; k < 3; k++) {
						const double velocity = side * arms[k] * free[3 * body + k];
						all += velocity;
						if (!(system->bodies[body].w[k] > 0)) {
							prescribed += velocity;
							terms += std::abs(velocity);
						}
						link.ends[side > 0].row[k] = side * roots[3 * body + k] * arms[k] / root;
					}
				}
				links.push_back(link);
				b.push_back(prescribed / root);
				ofFree += all < 0 ? (all / root) * (all / root) : 0;
				size.push_back(terms / root);
				double un, ut;
				relativeVelocity(c, system->bodies[c.a], system->bodies[c.b], un, ut);
				r.push_back((un + c.bias) / root);
			}
			return ofFree;
		}

		// Starts from the rigid motion of all bodies that best fits the prescribed ones, if contacts close less in it. Examples: a turning
		// drum, a shaken box.
		void tryRigidMotion(const std::vector<double>& free)
		{
			const RigidMotion rigid(*system, free, touched);
			if (!rigid.any())
				return;
			motion = free;
			for (std::size_t i = 0; i < touched.size(); i++) {
				const std::array<double, 3> along = rigid.of(system->places[i]);
				for (int k = 0; k < 3; k++)
					if (system->bodies[i].w[k] > 0)
						motion[3 * i + k] = along[k];
			}
			w.clear();
			for (const Link& link : links) {
				const ContactRow& c = system->contacts[link.contact];
				const double un = relativeVelocity<false>(c, motionOf(&motion[3 * c.a]), motionOf(&motion[3 * c.b])).n;
				w.push_back((un + c.bias) / std::sqrt(c.wnn));
			}
			if (closing(w) < closing(r))
				r = w;
		}

		static double closing(const std::vector<double>& r)
		{
			double sum = 0;
			for (const double e : r)
				sum += e < 0 ? e * e : 0;
			return sum;
		}

		// J x
		void along(const std::vector<double>& x, std::vector<double>& to) const
		{
			to.resize(links.size());
			for (std::size_t i = 0; i < links.size(); i++) {
				const auto& [a, b] = links[i].ends;
				double u = 0;
				for (int k = 0; k < 3; k++)
					u += a.row[k] * x[a.first + k] + b.row[k] * x[b.first + k];
				to[i] = u;
			}
		}

		// Puts -J^T y, summed over the contacts that now close, into g.
		void descent(const std::vector<double>& y)
		{
			g.assign(roots.size(), 0);
			for (std::size_t i = 0; i < links.size(); i++) {
				if (!(r[i] < 0))
					continue;
				for (const Link::End& end : links[i].ends)
					for (int k = 0; k < 3; k++)
						g[end.first + k] -= end.row[k] * y[i];
			}
		}

		// Solves the least squares problem of the contacts that now close, by conjugate gradients (CGLS). The result goes to `step`.
		void descend()
		{
			step.assign(roots.size(), 0);
			rest = r;
			descent(rest);
			direction = g;
			double gg = square(g);
			const double goal = gg * 1e-24;
			while (gg > goal && gg > solved * solved * 2 * closing(r) && left-- > 0) {
				along(direction, w);
				double ww = 0;
				for (std::size_t i = 0; i < w.size(); i++)
					ww += r[i] < 0 ? w[i] * w[i] : 0;
				if (!(ww > 0))
					return;
				const double length = gg / ww;
				add(step, length, direction);
				add(rest, length, w);
				descent(rest);
				const double next = square(g);
				for (std::size_t i = 0; i < step.size(); i++)
					direction[i] = g[i] + next / gg * direction[i];
				gg = next;
			}
		}

		// The share of the step, at most 1, at which the contacts close least. Along the step the set of closing contacts may change.
		double best() const
		{
			const auto falls = [this](double length) {
				double slope = 0;
				for (std::size_t i = 0; i < r.size(); i++)
					slope += std::min(r[i] + length * change[i], 0.) * change[i];
				return slope <= 0;
			};
			if (falls(1))
				return 1;
			double low = 0, high = 1;
			for (int k = 0; k < halvings; k++) {
				const double middle = (low + high) / 2;
				(falls(middle) ? low : high) = middle;
			}
			return low;
		}

		// The contact that closes most if y is a proof, else -1. Velocities without closing would have to be larger than |y|^2/|J^T y|.
		int proof(double scale, double bound)
		{
			descent(r);
			const double all = closing(r);
			double work = 0, sum = 0;
			std::size_t most = 0;
			for (std::size_t i = 0; i < links.size(); i++) {
				const double y = std::max(-r[i], 0.);
				work -= y * b[i];
				sum += y * size[i];
				if (r[i] < r[most])
					most = i;
			}
			const bool proven = all > 0 && work > share * sum && work > bound * scale * std::sqrt(square(g));
			return proven ? links[most].contact : -1;
		}

		const ContactSystem* system = nullptr;
		int left = 0; // products that may still be made
		std::vector<double> roots; // square roots of the inverse masses, one an unknown
		struct Link { // a row of J
			int32_t contact; // one with a body that can move along the normal
			struct End {
				int32_t first; // unknown of the body
				double row[3];
			} ends[2];
		};
		std::vector<Link> links;
		std::vector<double> b, size; // the prescribed closing velocities, and the magnitude of their terms
		std::vector<double> r; // J v + b; at first with the velocities in the system
		std::vector<char> touched; // whether a body is a boundary that has a contact
		std::vector<double> motion; // of the bodies
		std::vector<double> g, step, direction; // of the bodies
		std::vector<double> w, rest, change; // of the contacts
	};

} // namespace

int closingIn(const ContactSystem& system, const std::vector<double>& freeVelocity, double tolerance, double bound, int mostProducts)
{
	return (*Borrowed<LeastSquares>(system.memory))(system, freeVelocity, tolerance, bound, mostProducts);
}

} // namespace cd
