// Searches velocities v of the movable bodies with  J v + b >= 0.  J v are normal relative velocities, b those that boundaries and biases prescribe.
// The least total closing velocity,
//   min over v of |min(J v + b, 0)|^2,
// is 0 if and only if such velocities exist. If it is not 0, y = -min(J v + b, 0) at the minimum is the proof (Farkas' lemma): y >= 0, J^T y = 0 and
// b . y = -|y|^2 < 0. The minimum is found by Newton's method: each step solves the least squares problem of the contacts that now close by
// conjugate gradients (CGLS).
#include "solvability/feasibility.hpp"
#include "solvability/resolution.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numeric>

namespace cd {
namespace {

	constexpr double solved = 1e-15; // a gradient below this share of its terms is round-off
	constexpr double bound = 1e8; // velocities beyond so many times the prescribed ones, both weighted by the masses, are none
	constexpr double share = 1e-8; // the work b . y must exceed this share of its terms: normals are not exact

	double square(const std::vector<double>& a) { return std::inner_product(a.begin(), a.end(), a.begin(), 0.); }

	void add(std::vector<double>& to, double factor, const std::vector<double>& what)
	{
		for (std::size_t i = 0; i < to.size(); i++)
			to[i] += factor * what[i];
	}

	// The normal relative velocity of a contact for the freedoms of each body.
	template <class Space> double normalVelocity(const ContactRow<Space>& c, const std::vector<double>& v)
	{
		return relativeVelocity<false>(c, motionOf<Space>(&v[Space::freedoms * c.a]), motionOf<Space>(&v[Space::freedoms * c.b])).n;
	}

	// What a unit impulse along the normal does: on a and on b, along each of their freedoms.
	void normalActions(const ContactRow<Plane>& c, double (&of)[2][3])
	{
		const double arms[2][3] = { { -c.nx, -c.ny, -c.an }, { c.nx, c.ny, c.bn } };
		std::memcpy(of, arms, sizeof arms);
	}
	void normalActions(const ContactRow<Space3>& c, double (&of)[2][6])
	{
		const double arms[2][6] = { { -c.nx, -c.ny, -c.nz, 0, 0, 0 }, { c.nx, c.ny, c.nz, 0, 0, 0 } };
		std::memcpy(of, arms, sizeof arms);
	}

	// Adds to the velocity of a point what the rotation of a body about another point gives it.
	void turnAlong(std::array<double, 2> arm, double* v)
	{
		if (v[2] == 0)
			return;
		v[0] -= v[2] * arm[1];
		v[1] += v[2] * arm[0];
	}
	void turnAlong(std::array<double, 3> arm, double* v)
	{
		const Vector3 turned = cross(vectorOf(v + 3), vectorOf(arm.data()));
		for (int k = 0; k < 3; k++)
			v[k] += turned[k];
	}

	// The velocities at which blocked freedoms move as they do, and all others along with `boundary` as one rigid body; -1: they rest.
	template <class Space>
	void moveAlong(const ContactSystem<Space>& s, int32_t boundary, const std::vector<double>& free, std::vector<double>& v)
	{
		constexpr int n = Space::freedoms;
		v = free;
		for (std::size_t i = 0; i < s.bodies.size(); i++) {
			double along[n] = {};
			if (boundary >= 0) {
				std::copy_n(&free[n * static_cast<std::size_t>(boundary)], n, along);
				std::array<double, Space::components> arm {};
				for (int k = 0; k < Space::components && !s.places.empty(); k++)
					arm[k] = s.places[i][k] - s.places[boundary][k];
				turnAlong(arm, along);
			}
			for (int k = 0; k < n; k++)
				if (s.bodies[i].w[k] > 0)
					v[n * i + k] = along[k];
		}
	}

	// Rows are weighted by 1/sqrt(W_nn) and velocities by the square roots of the masses, so that the rows of J have length 1.
	class LeastSquares {
	    public:
		template <class Space> void read(const ContactSystem<Space>& s, const std::vector<double>& free)
		{
			constexpr int n = Space::freedoms;
			clear(free.size());
			moveAlong(s, -1, free, v);
			for (std::size_t i = 0; i < s.contacts.size(); i++) {
				const ContactRow<Space>& c = s.contacts[i];
				if (!(c.wnn > 0))
					continue;
				const double un = relativeVelocity(c, s.bodies[c.a], s.bodies[c.b]).n;
				double terms = std::abs(c.bias), arms[2][n];
				normalActions(c, arms);
				for (const int side : { 0, 1 })
					for (int k = 0; k < n; k++) {
						const int32_t unknown = n * (side == 0 ? c.a : c.b) + k;
						const double w = s.bodies[unknown / n].w[k];
						if (w > 0)
							entry(unknown, arms[side][k] * std::sqrt(w / c.wnn));
						else
							terms += std::abs(arms[side][k] * v[unknown]);
					}
				row(static_cast<int32_t>(i), std::sqrt(c.wnn), normalVelocity(c, v) + c.bias, terms, un + c.bias);
			}
		}
		void read(const DelassusSystem& s)
		{
			clear(s.p.size());
			const auto root = [&](std::size_t i, bool t) {
				const Block& own = s.blocks[s.diagonal[i]];
				return std::sqrt(t ? own.tt : own.nn);
			};
			for (std::size_t i = 0; i < s.contacts(); i++) {
				double un = s.q[2 * i];
				for (std::size_t k = s.start[i]; k < s.start[i + 1]; k++) {
					const int32_t j = s.column[k];
					un += s.blocks[k].nn * s.p[2 * j] + s.blocks[k].nt * s.p[2 * j + 1];
					entry(2 * j, s.blocks[k].nn / root(i, false) / root(j, false));
					entry(2 * j + 1, s.blocks[k].nt / root(i, false) / root(j, true));
				}
				row(static_cast<int32_t>(i), root(i, false), s.q[2 * i], std::abs(s.q[2 * i]), un);
			}
		}
		void read(const ConeSystem& s)
		{
			clear(3 * s.contacts());
			for (std::size_t i = 0; i < s.contacts(); i++) {
				const double root = std::sqrt(s.own(i)[0]);
				for (std::size_t k = s.start[i]; k < s.start[i + 1]; k++)
					for (int c = 0; c < 3; c++) {
						const int32_t j = s.column[k];
						entry(3 * j + c, s.blocks[k][c] / root / std::sqrt(s.own(j)[4 * c]));
					}
				row(static_cast<int32_t>(i), root, s.q[i][0], std::abs(s.q[i][0]), s.velocity(i, s.p)[0]);
			}
		}

		Feasibility search(double least, int products)
		{
			left = products;
			const double scale = std::sqrt(closing(b));
			while (left > 0) {
				if (!(fastest() > least))
					break;
				const double before = closing(r);
				descent(r);
				if (square(g) <= solved * solved * 2 * before)
					break;
				descend();
				if (square(step) > bound * bound * scale * scale)
					break;
				along(step, change);
				add(r, best(), change);
				if (!(closing(r) < before))
					break;
			}
			if (!(fastest() > least))
				return { true, -1 };
			return { false, proof(scale) };
		}

	    private:
		void clear(std::size_t size)
		{
			unknowns = size;
			for (auto* of : { &b, &terms, &roots, &r, &value })
				of->clear();
			for (auto* of : { &contact, &column })
				of->clear();
			end.clear();
		}
		void entry(int32_t unknown, double j)
		{
			column.push_back(unknown);
			value.push_back(j);
		}
		void row(int32_t i, double root, double prescribed, double sum, double now)
		{
			contact.push_back(i);
			end.push_back(column.size());
			roots.push_back(root);
			b.push_back(prescribed / root);
			terms.push_back(sum / root);
			r.push_back(now / root);
		}

		double fastest() const // closing [m/s]
		{
			double most = 0;
			for (std::size_t i = 0; i < r.size(); i++)
				most = std::max(most, -r[i] * roots[i]);
			return most;
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
			to.assign(end.size(), 0);
			for (std::size_t i = 0, k = 0; i < end.size(); i++)
				for (; k < end[i]; k++)
					to[i] += value[k] * x[column[k]];
		}

		// Puts -J^T y, summed over the contacts that now close, into g.
		void descent(const std::vector<double>& y)
		{
			g.assign(unknowns, 0);
			for (std::size_t i = 0; i < end.size(); i++)
				for (std::size_t k = i == 0 ? 0 : end[i - 1]; r[i] < 0 && k < end[i]; k++)
					g[column[k]] -= value[k] * y[i];
		}

		// Solves the least squares problem of the contacts that now close. The result goes to `step`.
		void descend()
		{
			step.assign(unknowns, 0);
			rest = r;
			descent(rest);
			direction = g;
			double gg = square(g);
			const double goal = gg * 1e-2;
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
			while (high - low > solved) {
				const double middle = (low + high) / 2;
				(falls(middle) ? low : high) = middle;
			}
			return low;
		}

		// The contact that closes most if y is a proof, else -1. Velocities without closing would have to be larger than |y|^2/|J^T y|.
		int32_t proof(double scale)
		{
			descent(r);
			double work = 0, sum = 0;
			std::size_t most = 0;
			for (std::size_t i = 0; i < r.size(); i++) {
				const double y = std::max(-r[i], 0.);
				work -= y * b[i];
				sum += y * terms[i];
				if (r[i] < r[most])
					most = i;
			}
			return work > share * sum && work > bound * scale * std::sqrt(square(g)) ? contact[most] : -1;
		}

		int left = 0; // products that may still be made
		std::size_t unknowns = 0;
		std::vector<int32_t> contact, column; // of each row of J; of each of its entries, the unknown
		std::vector<std::size_t> end; // of each row, among the entries
		std::vector<double> value;
		std::vector<double> roots, b, terms; // of W_nn; the prescribed velocities, and the magnitude of their terms
		std::vector<double> r; // J v + b
		std::vector<double> g, step, direction, v; // of the unknowns
		std::vector<double> w, rest, change; // of the contacts
	};

} // namespace

template <class Space> Feasibility feasibility(const ContactSystem<Space>& s, const std::vector<double>& freeVelocity, double least, int products)
{
	const Borrowed<LeastSquares> search(s.memory);
	search->read(s, freeVelocity);
	return search->search(least, products);
}
template Feasibility feasibility(const ContactSystem<Plane>&, const std::vector<double>&, double, int);
template Feasibility feasibility(const ContactSystem<Space3>&, const std::vector<double>&, double, int);
template Feasibility feasibility(const ContactSystem<RollingPlane>&, const std::vector<double>&, double, int);
Feasibility feasibility(const DelassusSystem& s, double least, int products)
{
	const Borrowed<LeastSquares> search(s.memory);
	search->read(s);
	return search->search(least, products);
}
Feasibility feasibility(const ConeSystem& s, double least, int products)
{
	const Borrowed<LeastSquares> search(s.memory);
	search->read(s);
	return search->search(least, products);
}

template <class Space> bool surelySolvable(const ContactSystem<Space>& s, Threads* threads)
{
	if (s.contacts.compliant)
		return true;
	return !anyOf(threads, s.bodies.size(), [&](std::size_t i) { return !s.isStill(i) && isDriven(s.bodies[i]); })
	    && (s.contacts.postponed() // they push nothing
		|| !anyOf(threads, s.contacts.size(), [&](std::size_t i) { return !(s.contacts[i].bias >= 0); }));
}
template bool surelySolvable(const ContactSystem<Plane>&, Threads*);
template bool surelySolvable(const ContactSystem<Space3>&, Threads*);
template bool surelySolvable(const ContactSystem<RollingPlane>&, Threads*);

template <class Space> double closingOfBoundaries(const ContactSystem<Space>& s, const std::vector<double>& freeVelocity)
{
	const Borrowed<std::vector<double>, LeastSquares> borrowed(s.memory);
	std::vector<double>& v = *borrowed;
	const auto closing = [&](int32_t along) {
		moveAlong(s, along, freeVelocity, v);
		double fastest = 0;
		for (const ContactRow<Space>& c : s.contacts)
			if (c.wnn > 0) {
				constexpr int n = Space::freedoms;
				// What a turning face adds in the second order depends on how the body slides along it, and presses nothing.
				const double bias = s.contacts.pushing ? c.bias : std::max(c.bias, 0.);
				const double size = sizeOf(c, bias, motionOf<Space>(&v[n * c.a]), motionOf<Space>(&v[n * c.b]));
				fastest = std::max(fastest, -(normalVelocity(c, v) + bias) - roundOff * size);
			}
		return fastest;
	};
	const auto turns = [&](int32_t i) {
		const double* const v = &freeVelocity[Space::freedoms * i];
		return std::any_of(v + Space::components, v + Space::freedoms, [](double spin) { return spin != 0; });
	};
	for (const ContactRow<Space>& c : s.contacts)
		for (const int32_t i : { c.a, c.b })
			if (c.wnn > 0 && inverseMass(s.bodies[i]) == 0 && (!turns(i) || !s.places.empty())) {
				const double alongside = closing(i);
				return alongside > 0 ? std::min(alongside, closing(-1)) : 0;
			}
	return closing(-1);
}
template double closingOfBoundaries(const ContactSystem<Plane>&, const std::vector<double>&);
template double closingOfBoundaries(const ContactSystem<Space3>&, const std::vector<double>&);
template double closingOfBoundaries(const ContactSystem<RollingPlane>&, const std::vector<double>&);

} // namespace cd
