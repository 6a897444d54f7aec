// Accelerated sweeps, and where they stagnate or run out, Newton's method: from the best they found, and where that stagnates, too, from the
// first guess.
//
// Sweeps come first and go to their end: one factorization costs as much as 300 of them and more, and what they solve at all they mostly solve in
// a few hundred. Newton's method can stagnate from one start and solve from another: of twelve frozen packings with mu = 0.5 it solves ten
// from where sweeps stagnate (1e-5) and eleven from e = 1e-3. Sweeps from where Newton's method stagnates gain nothing, on none of the problems
// tried.
#include "solver.hpp"

#include <algorithm>

namespace cd {
namespace {

	// Bodies, or contacts of a problem given by its matrix, above which Newton's method is not tried: a few of its steps would take seconds.
	constexpr std::size_t large = 10000;
	// So much Newton's method may take from each of its starts: about 0.7 s whatever the size, 760 steps for 400 disks.
	constexpr double mostWork = 2e9;
	constexpr int mostSteps = 3000; // in all; what can be solved at all takes 10 to 1000

	std::size_t size(const ContactSystem& s) { return s.bodies.size(); }
	std::size_t size(const DelassusSystem& s) { return s.contacts(); }

	// The free velocities and the first guess: what a method changes.
	struct Start {
		std::vector<double> v, p;
	};

	void save(const ContactSystem& s, Start& start)
	{
		start.v.resize(3 * s.bodies.size());
		start.p.resize(2 * s.contacts.size());
		for (std::size_t i = 0; i < s.bodies.size(); i++)
			std::copy_n(s.bodies[i].v, 3, &start.v[3 * i]);
		for (std::size_t i = 0; i < s.contacts.size(); i++) {
			start.p[2 * i] = s.contacts[i].pn;
			start.p[2 * i + 1] = s.contacts[i].pt;
		}
	}
	void save(const DelassusSystem& s, Start& start) { start.p = s.p; }

	// A method leaves the velocities that belong to its impulses; the next begins with the free ones again.
	void freeVelocities(ContactSystem& s, const Start& start)
	{
		for (std::size_t i = 0; i < s.bodies.size(); i++)
			std::copy_n(&start.v[3 * i], 3, s.bodies[i].v);
	}
	void freeVelocities(DelassusSystem&, const Start&) { }

	void firstGuess(ContactSystem& s, const Start& start)
	{
		for (std::size_t i = 0; i < s.contacts.size(); i++) {
			s.contacts[i].pn = start.p[2 * i];
			s.contacts[i].pt = start.p[2 * i + 1];
		}
	}
	void firstGuess(DelassusSystem& s, const Start& start) { s.p = start.p; }

	// Newton's method from the impulses in the system, and anew from the first guess; the better of both stays.
	template <class System> SolverReport newtonTwice(System& system, const Start& start, SolverSettings settings)
	{
		freeVelocities(system, start);
		const SolverReport first = newton(system, settings);
		settings.maxIterations -= first.iterations;
		if (first.status != Status::stagnated || settings.maxIterations <= 0)
			return first;
		System anew = system;
		freeVelocities(anew, start);
		firstGuess(anew, start);
		const SolverReport second = newton(anew, settings);
		const bool better = second.error < first.error;
		if (better)
			std::swap(system, anew);
		SolverReport report = better ? second : first;
		report.iterations = first.iterations + second.iterations;
		report.factorizations = first.factorizations + second.factorizations;
		return report;
	}

	template <class System> SolverReport solve(System& system, const SolverSettings& settings)
	{
		const int most = std::min(mostSteps, settings.maxIterations / 6); // these are left for Newton's method
		if (settings.fixedIterations > 0 || size(system) > large || most == 0)
			return accelerated(system, settings);
		static thread_local Start start; // its memory serves every step
		save(system, start);
		SolverSettings part = settings;
		part.maxIterations -= most;
		const SolverReport sweeps = accelerated(system, part);
		if (sweeps.status == Status::converged || sweeps.status == Status::diverged)
			return sweeps;
		part.maxIterations = most;
		part.mostWork = mostWork;
		SolverReport report = newtonTwice(system, start, part);
		report.iterations += sweeps.iterations;
		return report;
	}

} // namespace

SolverReport automatic(ContactSystem& system, const SolverSettings& settings) { return solve(system, settings); }
SolverReport automatic(DelassusSystem& system, const SolverSettings& settings) { return solve(system, settings); }

} // namespace cd
