// The initial state that every method changes: free velocities and first guess. It is stored so that another method can start there, too. What is
// asked of it is found in the same pass over bodies and contacts.
#pragma once

#include "contact_system.hpp"
#include "delassus_system.hpp"
#include "solver.hpp"
#include "threads.hpp"
#include "verdict.hpp"
#include "workspace.hpp"

#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>

namespace cd {

class Start {
    public:
	explicit Start(const ContactSystem& s, Threads* t)
	    : threads(t)
	    , kept(s.memory)
	{
		velocities.resize(3 * s.bodies.size());
		impulses.resize(2 * s.contacts.size());
		std::atomic<bool> driven { false };
		forRanges(threads, s.bodies.size(), [&](std::size_t from, std::size_t to) {
			for (std::size_t i = from; i < to; i++) {
				std::memcpy(&velocities[3 * i], s.bodies[i].v, sizeof s.bodies[i].v); // std::copy_n would be a call
				if (isDriven(s.bodies[i]))
					driven = true;
			}
		});
		const auto keep = [&](std::size_t from, std::size_t to) {
			double square = 0;
			bool pushed = false;
			for (std::size_t i = from; i < to; i++) {
				const ContactRow& c = s.contacts[i];
				impulses[2 * i] = c.pn;
				impulses[2 * i + 1] = c.pt;
				square += c.wnn * (c.pn * c.pn + c.pt * c.pt);
				pushed = pushed || !(c.bias >= 0);
			}
			if (pushed)
				driven = true;
			return square;
		};
		weight = std::sqrt(reduceRanges<double>(threads, s.contacts.size(), keep, std::plus<double>()));
		solvable = !driven;
	}
	explicit Start(const DelassusSystem& s, Threads* t)
	    : weight(weighted(s))
	    , threads(t)
	    , kept(s.memory)
	{
		impulses = s.p;
	}

	// Restores the free velocities. A method leaves the velocities of its impulses, but the next one needs the free ones.
	void free(ContactSystem& s) const
	{
		forRanges(threads, s.bodies.size(), [&](std::size_t from, std::size_t to) {
			for (std::size_t i = from; i < to; i++)
				std::memcpy(s.bodies[i].v, &velocities[3 * i], sizeof s.bodies[i].v);
		});
	}
	void free(DelassusSystem&) const { } // it has no velocities

	void guess(ContactSystem& s) const
	{
		for (std::size_t i = 0; i < s.contacts.size(); i++) {
			s.contacts[i].pn = impulses[2 * i];
			s.contacts[i].pt = impulses[2 * i + 1];
		}
	}
	void guess(DelassusSystem& s) const { s.p = impulses; }

	const std::vector<double>& freeVelocity() const { return velocities; } // three a body; none for a matrix

	double weight = 0; // of the guess: sqrt(sum W_nn |p|^2)
	bool solvable = false; // surelySolvable()

    private:
	Threads* const threads;
	struct State {
		std::vector<double> velocities, impulses; // three a body, none for a matrix; two a contact
	};
	Borrowed<State> kept;
	std::vector<double>&velocities = kept->velocities, &impulses = kept->impulses;
};

// Refers to the Start that the caller keeps, or else makes its own.
class Kept {
    public:
	template <class System>
	Kept(const System& s, const SolverSettings& settings)
	    : start(settings.start ? settings.start : &own.emplace(s, settings.threads))
	{
	}
	operator const Start&() const { return *start; }
	const Start* operator->() const { return start; }

    private:
	std::optional<Start> own;
	const Start* start;
};

} // namespace cd
