// The initial state that every method changes: free velocities and first guess. It is stored so that another method can start there, too. What is
// asked of it is found in the same pass over bodies and contacts.
#pragma once

#include "problem/problem.hpp"
#include "solvers/solver.hpp"
#include "base/base.hpp"
#include "solvability/solvability.hpp"

#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>

namespace cd {

class Start {
    public:
	Start(ContactSystem<Plane>& s, Threads* t)
	    : threads(t)
	    , kept(s.memory)
	{
		velocities.resize(3 * s.bodies.size());
		if (s.contacts.solvedBeside()) // else the source of postponed rows still knows the guess
			s.contacts.make();
		source = s.contacts.postponed();
		std::atomic<bool> driven { false };
		forRanges(threads, s.bodies.size(), [&](std::size_t from, std::size_t to) {
			for (std::size_t i = from; i < to; i++) {
				std::memcpy(&velocities[3 * i], s.bodies[i].v, sizeof s.bodies[i].v); // std::copy_n would be a call
				if (isDriven(s.bodies[i]))
					driven = true;
			}
		});
		impulses.resize(source ? 0 : 2 * s.contacts.size());
		forRanges(threads, impulses.size() / 2, [&](std::size_t from, std::size_t to) { // postponed contacts push nothing
			bool pushed = false;
			for (std::size_t i = from; i < to; i++) {
				const ContactRow<Plane>& c = s.contacts[i];
				impulses[2 * i] = c.pn;
				impulses[2 * i + 1] = c.pt;
				pushed = pushed || !(c.bias >= 0);
			}
			if (pushed)
				driven = true;
		});
		solvable = !driven;
	}
	Start(const DelassusSystem& s, Threads* t)
	    : threads(t)
	    , kept(s.memory)
	{
		impulses = s.p;
	}
	Start(const ConeSystem& s, Threads* t)
	    : threads(t)
	    , kept(s.memory)
	{
		impulses.clear();
		for (const Triple& p : s.p)
			impulses.insert(impulses.end(), p.begin(), p.end());
	}

	// Restores the free velocities. A method leaves the velocities of its impulses, but the next one needs the free ones.
	void free(ContactSystem<Plane>& s) const
	{
		forRanges(threads, s.bodies.size(), [&](std::size_t from, std::size_t to) {
			for (std::size_t i = from; i < to; i++)
				std::memcpy(s.bodies[i].v, &velocities[3 * i], sizeof s.bodies[i].v);
		});
	}
	void free(DelassusSystem&) const { } // it has no velocities
	void free(ConeSystem&) const { }

	void guess(ContactSystem<Plane>& s) const
	{
		if (s.contacts.postponed())
			return s.contacts.forgetSolution();
		for (std::size_t i = 0; i < s.contacts.size(); i++) {
			const auto [pn, pt] = guessOf(i);
			s.contacts[i].pn = pn;
			s.contacts[i].pt = pt;
		}
	}
	void guess(DelassusSystem& s) const { s.p = impulses; }
	void guess(ConeSystem& s) const
	{
		for (std::size_t i = 0; i < impulses.size(); i++)
			s.p[i / 3][i % 3] = impulses[i];
	}

	const std::vector<double>& freeVelocity() const { return velocities; } // three a body; none for a matrix

	// Of the guess: sqrt(sum W_nn |p|^2).
	double weight(const ContactSystem<Plane>& s) const
	{
		const auto add = [&](std::size_t from, std::size_t to) {
			double square = 0;
			for (std::size_t i = from; i < to; i++) {
				const auto [pn, pt] = guessOf(i);
				square += s.contacts[i].wnn * (pn * pn + pt * pt);
			}
			return square;
		};
		return std::sqrt(reduceRanges<double>(threads, s.contacts.size(), add, std::plus<double>()));
	}
	double weight(const DelassusSystem& s) const
	{
		double square = 0;
		for (std::size_t i = 0; i < s.contacts(); i++)
			square += s.blocks[s.diagonal[i]].nn * (impulses[2 * i] * impulses[2 * i] + impulses[2 * i + 1] * impulses[2 * i + 1]);
		return std::sqrt(square);
	}
	double weight(const ConeSystem& s) const
	{
		double square = 0;
		for (std::size_t i = 0; i < impulses.size(); i++)
			square += s.own(i / 3)[0] * impulses[i] * impulses[i];
		return std::sqrt(square);
	}
	bool solvable = false; // surelySolvable()

    private:
	std::array<double, 2> guessOf(std::size_t i) const
	{
		if (!source)
			return { impulses[2 * i], impulses[2 * i + 1] };
		const ContactRow<Plane> row = source->row(static_cast<int32_t>(i));
		return { row.pn, row.pt };
	}

	Threads* const threads;
	const RowSource<Plane>* source = nullptr; // of the guess, while the rows were not made
	struct State {
		std::vector<double> velocities, impulses; // three a body, none for a matrix; two a contact, three in space
	};
	Borrowed<State> kept;
	std::vector<double>&velocities = kept->velocities, &impulses = kept->impulses;
};

} // namespace cd
