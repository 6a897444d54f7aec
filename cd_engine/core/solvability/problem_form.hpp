// Reads a contact problem row by row, whatever its form: given by bodies and contacts, or by a matrix.
#pragma once

#include "problem/problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace cd {

// One form of a problem: its rows, and products with W. `sizes` are the sums of the absolute values of the terms of a product. Keeps its memory
// from one problem to the next.
class BodyForm {
    public:
	// In a press (verdict.hpp), contacts give way with at least this share of the prescribed motion's power: other boundaries may move, too.
	static constexpr double ofPrescribed = 0.1;
	static constexpr double ofProof = std::numeric_limits<double>::infinity(); // large impulses alone start no proof, since power reveals a press
	static constexpr double ofTerms = 1e-8; // the work against a self-stress must exceed this share of the terms of its sum

	const BodyForm& of(const ContactSystem& s, const std::vector<double>& free)
	{
		system = &s;
		rows.clear();
		for (std::size_t i = 0; i < s.contacts.size(); i++)
			if (s.contacts[i].wnn > 0)
				rows.push_back(static_cast<int32_t>(i));
		data.resize(rows.size());
		v = free;
		size.resize(free.size());
		std::transform(free.begin(), free.end(), size.begin(), [](double x) { return std::abs(x); });
		collect(q, sums);
		for (std::size_t i = 0; i < rows.size(); i++)
			data[i] = std::max(sums[2 * i], sums[2 * i + 1]) + std::abs(s.contacts[rows[i]].bias);
		const RigidMotion frame(s, free, touched);
		const bool moves = frame.ofAll();
		for (std::size_t i = 0; i < s.bodies.size(); i++) {
			const std::array<double, 3> along = moves ? frame.of(s.places[i]) : std::array<double, 3> {};
			for (int k = 0; k < 3; k++)
				v[3 * i + k] = s.bodies[i].w[k] > 0 ? 0 : v[3 * i + k] - along[k];
		}
		collect(prescribed, sums);
		for (std::size_t i = 0; i < rows.size(); i++) {
			q[2 * i] += s.contacts[rows[i]].bias;
			prescribed[2 * i] += s.contacts[rows[i]].bias;
		}
		return *this;
	}
	std::size_t contacts() const { return rows.size(); }
	int32_t row(std::size_t i) const { return rows[i]; }
	double mu(std::size_t i) const { return system->contacts[rows[i]].mu; }
	double pn(std::size_t i) const { return system->contacts[rows[i]].pn; }
	double pt(std::size_t i) const { return system->contacts[rows[i]].pt; }
	double own(std::size_t i) const { return system->contacts[rows[i]].wnn; }
	double ownTangential(std::size_t i) const { return system->contacts[rows[i]].wtt > 0 ? system->contacts[rows[i]].wtt : own(i); }

	// The heaviest body over the lightest one.
	double massRatio() const
	{
		double least = std::numeric_limits<double>::infinity(), most = 0;
		for (const BodyVelocity& b : system->bodies)
			for (const int k : { 0, 1 })
				if (b.w[k] > 0) {
					least = std::min(least, b.w[k]);
					most = std::max(most, b.w[k]);
				}
		return most > 0 ? most / least : 1;
	}

	void product(const std::vector<double>& p, std::vector<double>& u, std::vector<double>& sizes) const
	{
		std::fill(v.begin(), v.end(), 0.);
		std::fill(size.begin(), size.end(), 0.);
		for (std::size_t i = 0; i < rows.size(); i++) {
			const ContactRow& c = system->contacts[rows[i]];
			const Action<double> of = actionOf(c, Components<double> { p[2 * i], p[2 * i + 1] });
			add(c.a, -of.x, -of.y, -of.turnA);
			add(c.b, of.x, of.y, of.turnB);
		}
		collect(u, sizes);
	}

	std::vector<double> q;
	// The part of q that no impulse can change: from blocked freedoms and from the biases. Of boundaries that move together, as those of a drum,
	// it is what an observer who moves along sees.
	std::vector<double> prescribed;
	std::vector<double> data; // magnitude of the terms of q, one number a contact

    private:
	void add(int32_t body, double x, double y, double turn) const
	{
		const double* const w = system->bodies[body].w;
		const double dv[3] = { w[0] * x, w[1] * y, w[2] * turn };
		for (int k = 0; k < 3; k++) {
			v[3 * body + k] += dv[k];
			size[3 * body + k] += std::abs(dv[k]);
		}
	}
	void collect(std::vector<double>& u, std::vector<double>& sizes) const
	{
		u.resize(2 * rows.size());
		sizes.resize(2 * rows.size());
		for (std::size_t i = 0; i < rows.size(); i++) {
			const ContactRow& c = system->contacts[rows[i]];
			const double *a = &v[3 * c.a], *b = &v[3 * c.b], *sa = &size[3 * c.a], *sb = &size[3 * c.b];
			const Components<double> now = relativeVelocity<true>(c, motionOf(a), motionOf(b));
			u[2 * i] = now.n;
			u[2 * i + 1] = now.t;
			const double sum = sa[0] + sa[1] + sb[0] + sb[1];
			sizes[2 * i] = sum + std::abs(c.bn) * sb[2] + std::abs(c.an) * sa[2];
			sizes[2 * i + 1] = sum + std::abs(c.bt) * sb[2] + std::abs(c.at) * sa[2];
		}
	}

	const ContactSystem* system = nullptr;
	std::vector<int32_t> rows;
	mutable std::vector<double> v, size; // of the bodies
	std::vector<char> touched; // whether a body is a boundary that has a contact
	std::vector<double> sums;
};

class MatrixForm {
    public:
	static constexpr double ofPrescribed = 1e-4; // relative to all of q, since a matrix does not tell which part is prescribed
	// From this growth of the impulses on, a self-stress is searched for whatever the powers are: the rest of q may hide a press. Gravity, for
	// example, has no power on a self-stress.
	static constexpr double ofProof = 100;
	static constexpr double ofTerms = 1e-11; // far above round-off; smaller than for bodies, because no inexact geometry is computed here

	const MatrixForm& of(const DelassusSystem& s)
	{
		system = &s;
		q = prescribed = s.q;
		data.resize(s.contacts());
		for (std::size_t i = 0; i < data.size(); i++)
			data[i] = std::max(std::abs(q[2 * i]), std::abs(q[2 * i + 1]));
		return *this;
	}
	std::size_t contacts() const { return system->contacts(); }
	int32_t row(std::size_t i) const { return static_cast<int32_t>(i); }
	double mu(std::size_t i) const { return system->mu[i]; }
	double pn(std::size_t i) const { return system->p[2 * i]; }
	double pt(std::size_t i) const { return system->p[2 * i + 1]; }
	double own(std::size_t i) const { return system->blocks[system->diagonal[i]].nn; }
	double ownTangential(std::size_t i) const { return system->blocks[system->diagonal[i]].tt; }
	double massRatio() const { return std::numeric_limits<double>::infinity(); } // a matrix does not contain the masses

	void product(const std::vector<double>& p, std::vector<double>& u, std::vector<double>& sizes) const
	{
		u.assign(2 * contacts(), 0);
		sizes.assign(2 * contacts(), 0);
		for (std::size_t i = 0; i < contacts(); i++)
			for (std::size_t k = system->start[i]; k < system->start[i + 1]; k++) {
				const Block& w = system->blocks[k];
				const double n = p[2 * system->column[k]], t = p[2 * system->column[k] + 1];
				u[2 * i] += w.nn * n + w.nt * t;
				u[2 * i + 1] += w.tn * n + w.tt * t;
				sizes[2 * i] += std::abs(w.nn * n) + std::abs(w.nt * t);
				sizes[2 * i + 1] += std::abs(w.tn * n) + std::abs(w.tt * t);
			}
	}

	std::vector<double> q;
	std::vector<double> prescribed; // all of q, see ofPrescribed
	std::vector<double> data;

    private:
	const DelassusSystem* system = nullptr;
};

} // namespace cd
