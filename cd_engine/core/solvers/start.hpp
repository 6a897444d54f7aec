// The initial state that every method changes: free velocities and first guess. It is stored so that another method can start there, too. What is
// asked of it is found in the same pass over bodies and contacts.
#pragma once

#include "problem/problem.hpp"
#include "solvers/solver.hpp"
#include "base/base.hpp"
#include "solvability/solvability.hpp"

#include <atomic>
#include <cassert>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <type_traits>

namespace cd {

class Start {
    public:
	template <class Space>
	Start(ContactSystem<Space>& s, Threads* t)
	    : threads(t)
	    , kept(s.memory)
	{
		velocities.resize(Space::freedoms * s.bodies.size());
		if (s.contacts.solvedBeside()) // else the source of postponed rows still knows the guess
			s.contacts.make();
		source = s.contacts.postponed();
		std::atomic<bool> driven { false };
		forRanges(threads, s.bodies.size(), [&](std::size_t from, std::size_t to) {
			for (std::size_t i = from; i < to; i++) {
				std::memcpy(&velocities[Space::freedoms * i], s.bodies[i].v, sizeof s.bodies[i].v); // std::copy_n would be a call
				if (isDriven(s.bodies[i]))
					driven = true;
			}
		});
		impulses.resize(source ? 0 : numbers<Space> * s.contacts.size());
		forRanges(threads, impulses.size() / numbers<Space>, [&](std::size_t from, std::size_t to) { // postponed contacts push nothing
			bool pushed = false;
			for (std::size_t i = from; i < to; i++) {
				const ContactRow<Space>& c = s.contacts[i];
				const ImpulseOf<Space> p = impulseOf(c);
				std::memcpy(&impulses[numbers<Space> * i], &p, sizeof p);
				pushed = pushed || !(c.bias >= 0);
			}
			if (pushed)
				driven = true;
		});
		solvable = s.contacts.compliant || !driven;
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
	template <class Space> void free(ContactSystem<Space>& s) const
	{
		forRanges(threads, s.bodies.size(), [&](std::size_t from, std::size_t to) {
			for (std::size_t i = from; i < to; i++)
				std::memcpy(s.bodies[i].v, &velocities[Space::freedoms * i], sizeof s.bodies[i].v);
		});
	}
	void free(DelassusSystem&) const { } // it has no velocities
	void free(ConeSystem&) const { }

	template <class Space> void guess(ContactSystem<Space>& s) const
	{
		if (s.contacts.postponed())
			return s.contacts.forgetSolution();
		for (std::size_t i = 0; i < s.contacts.size(); i++)
			setImpulse(s.contacts[i], guessOf<Space>(i));
	}
	void guess(DelassusSystem& s) const { s.p = impulses; }
	void guess(ConeSystem& s) const
	{
		for (std::size_t i = 0; i < impulses.size(); i++)
			s.p[i / 3][i % 3] = impulses[i];
	}

	const std::vector<double>& freeVelocity() const { return velocities; } // the freedoms of each body; none for a matrix

	// Of the guess: sqrt(sum W_nn |p|^2).
	template <class Space> double weight(const ContactSystem<Space>& s) const
	{
		const auto add = [&](std::size_t from, std::size_t to) {
			double square = 0;
			for (std::size_t i = from; i < to; i++) {
				const ImpulseOf<Space> p = guessOf<Space>(i);
				square += s.contacts[i].wnn * dot(p, p);
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
	template <class Space> static constexpr std::size_t numbers = sizeof(ImpulseOf<Space>) / sizeof(double); // that an impulse has

	template <class Space> ImpulseOf<Space> guessOf(std::size_t i) const
	{
		if (source)
			return impulseOf(static_cast<const RowSource<Space>*>(source)->row(static_cast<int32_t>(i)));
		ImpulseOf<Space> p;
		std::memcpy(&p, &impulses[numbers<Space> * i], sizeof p);
		return p;
	}

	Threads* const threads;
	const void* source = nullptr; // the RowSource of the guess, while the rows were not made
	struct State {
		std::vector<double> velocities, impulses; // the freedoms of a body, none for a matrix; what an impulse has
	};
	Borrowed<State> kept;
	std::vector<double>&velocities = kept->velocities, &impulses = kept->impulses;
};

} // namespace cd
