// The list of solvers. Each solves a problem by a method and tests whether the result is a solution (room solvability).
#include "solvers/solver.hpp"
#include "solvers/start.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace cd {
namespace {

	// How fast contacts may close, relative to the fastest closing without impulses, or where loaded contacts close rather than part, to the
	// closing of the boundaries: in tolerances, and at most.
	constexpr double mostTolerances = 10, mostClosing = 0.1;
	constexpr double refinement = 0.1; // factor on the tolerance where they close faster
	constexpr double finest = 1e-15; // smallest tolerance; below is the round-off of a sum
	// A refinement is in vain if the impulses grow by more than the first factor (without a bound: tenfold) and the misses fall by less than the
	// other.
	constexpr double grows = 3, falls = 0.5;
	// Products with J that a search for velocities may take. One costs about four sweeps.
	int productsAfter(int sweeps) { return 200 + sweeps / 10; }

	// Of a matrix problem, in the plane or in space. It does not tell boundaries from bodies.
	template <class Matrix> double closingOfBoundaries(const Matrix&, const std::vector<double>&)
	{
		return std::numeric_limits<double>::infinity();
	}
	template <class Matrix> Resolution resolution(const Matrix& s, const std::vector<double>&) { return resolution(s); }
	template <class Matrix> Feasibility feasibility(const Matrix& s, const std::vector<double>&, double least, int products)
	{
		return feasibility(s, least, products);
	}

	template <class Space> std::size_t contactsIn(const ContactSystem<Space>& s) { return s.contacts.size(); }
	template <class Matrix> std::size_t contactsIn(const Matrix& s) { return s.contacts(); }
	// Products of a search where the velocities are resolved already: a small part of a step of a large problem.
	template <class System> int mostProducts(const System& s) { return 20 + 20000 / (1 + static_cast<int>(contactsIn(s))); }

	template <class Space> void clearImpulses(ContactSystem<Space>& s)
	{
		s.contacts.make();
		for (ContactRow<Space>& c : s.contacts)
			setImpulse(c, ImpulseOf<Space> {});
	}

	template <class Space> void makeRows(ContactSystem<Space>& s) { s.contacts.make(); }
	template <class Matrix> void makeRows(Matrix&) { }

	template <class System> using Method = SolverReport (*)(System&, const SolverSettings&);

	// Continues from the impulses in the system with `method`, with the iterations left of `settings.maxIterations`.
	template <class System>
	SolverReport goOn(System& system, const Start& start, SolverSettings settings, const SolverReport& before, Method<System> method)
	{
		settings.maxIterations -= before.iterations;
		start.free(system);
		SolverReport report = method(system, settings);
		report.iterations += before.iterations;
		report.factorizations += before.factorizations;
		return report;
	}

	// No method may fail where plain sweeps succeed. They do wherever W is positive definite and friction is not too large.
	template <class System>
	void tryPlain(System& system, const Start& start, const SolverSettings& settings, SolverReport& report, Method<System> method)
	{
		if (method == static_cast<Method<System>>(nsgs) || report.status != Status::stagnated || report.iterations >= settings.maxIterations)
			return;
		const Borrowed<System> copy(system.memory);
		System& other = *copy;
		other = system;
		start.guess(other);
		SolverReport plain = goOn<System>(other, start, settings, report, nsgs);
		report.iterations = plain.iterations;
		if (plain.status != Status::converged) {
			report.status = plain.status == Status::max_iterations ? plain.status : report.status; // more of them may help
			return;
		}
		plain.plain = true;
		report = plain;
		std::swap(system, other);
	}

	// Sweeps that are kept for tryClosed, which needs few where it helps at all; only where many are allowed.
	constexpr int forClosed = 50;
	template <class System> int keptForClosed(const SolverSettings& s)
	{
		return std::is_same_v<System, ContactSystem<Space3>> && s.fixedIterations == 0 && s.maxIterations > 10 * forClosed ? forClosed : 0;
	}

	// Gaps that errors of earlier steps have left, far below the tolerance, may not let all loaded contacts stay closed and stick at once. The
	// impulses then move along a self-stress for 1e4 sweeps and more (accelerated.cpp), as in lattices of equal spheres. With these gaps closed
	// they come to rest, and what this changes is within the tolerance: the error is that of the problem as it is. (In the plane Newton's method
	// solves such steps.)
	void tryClosed(ContactSystem<Space3>& system, const Start& start, const SolverSettings& settings, SolverReport& report)
	{
		if ((report.status != Status::stagnated && report.status != Status::max_iterations) || system.contacts.compliant)
			return;
		system.contacts.make();
		const Borrowed<ContactSystem<Space3>> copy(system.memory);
		ContactSystem<Space3>& other = *copy;
		other = system;
		start.free(other);
		start.guess(other);
		double fastest = 0; // without impulses [m/s]
		for (const ContactRow<Space3>& c : other.contacts)
			fastest = std::max(fastest, std::abs(relativeVelocity(c, other.bodies[c.a], other.bodies[c.b]).n));
		bool any = false;
		for (ContactRow<Space3>& c : other.contacts)
			if (c.bias != 0 && std::abs(c.bias) <= settings.tolerance * fastest) {
				c.bias = 0;
				any = true;
			}
		if (!any)
			return;
		SolverSettings finer = settings;
		finer.tolerance *= refinement; // the guess has about the error that was asked for
		finer.maxIterations = std::min(settings.maxIterations, report.iterations + forClosed);
		SolverReport closed = goOn<ContactSystem<Space3>>(other, start, finer, report, nsgs);
		report.iterations = closed.iterations;
		for (std::size_t i = 0; i < system.contacts.size(); i++)
			other.contacts[i].bias = system.contacts[i].bias;
		closed.measure(residual(other, start.freeVelocity()));
		if (!(closed.error <= settings.tolerance))
			return;
		closed.status = Status::converged;
		closed.plain = true;
		report = closed;
		std::swap(system, other);
	}
	template <class System> void tryClosed(System&, const Start&, const SolverSettings&, SolverReport&) { }

	// Whether the impulses are far larger than those of the first guess, which have been accepted before.
	template <class System> bool exceedsGuess(System& s, const Start& start) { return Start(s, nullptr).weight(s) > 10 * start.weight(s); }

	// Whether impulses have more than doubled the energy of a scene in which nothing drives bodies. Impulses that balance each other may be so
	// large that all velocities they cause are within the tolerance. Those of the first guess have been accepted before.
	template <class Space> bool createEnergy(ContactSystem<Space>& s, const Start& start, const SolverReport& report)
	{
		if (s.contacts.compliant || report.status != Status::converged || !(energyGain(s, start.freeVelocity()) > 2))
			return false;
		s.contacts.make();
		return exceedsGuess(s, start);
	}

	// Plain sweeps from zero impulses create none that balance each other.
	template <class Space>
	void solveFromNothing(ContactSystem<Space>& system, const Start& start, const SolverSettings& settings, SolverReport& report)
	{
		clearImpulses(system);
		report = goOn<ContactSystem<Space>>(system, start, settings, report, nsgs);
		report.plain = true;
		if (createEnergy(system, start, report)) {
			report.status = Status::stagnated;
			report.contact = resolution(system, start.freeVelocity()).contact;
		}
	}

	// Where the velocities are not resolved, searches for some at which no contact closes, and solves to smaller and smaller tolerances. Ends
	// with impulses that resolve the velocities, with the proof that there is no solution, or with a contact in a report that says that neither
	// was reached. Most flows that miss a few tolerances more are accepted at the first look: velocities exist, and as many loaded contacts part
	// as close. Where boundaries close in on bodies, the impulses grow with each refinement while the contacts close as before.
	template <class System> void resolve(System& system, const Start& start, SolverSettings settings, SolverReport& report, Method<System> method)
	{
		const double asked = settings.tolerance;
		bool possible = false; // whether velocities are known at which no contact closes
		int inVain = 0; // refinements in a row
		int32_t contact = -1; // at the last look
		double boundaries = -1; // how fast they close in [m/s], once it is known
		Resolution before;
		for (bool first = true;; first = false) {
			const Resolution now = resolution(system, start.freeVelocity());
			if (!now.finite) {
				report.status = Status::diverged;
				report.contact = now.contact;
				return;
			}
			const bool solved = report.error <= asked;
			// Whether errors within the tolerance, or round-off, may be as large as the velocities that the impulses must stop.
			const bool large = now.growth * std::max(settings.tolerance, 1 / mostGrowth) > 1 && exceedsGuess(system, start);
			const double closing = std::min(mostTolerances * asked, mostClosing), least = closing * now.free;
			const bool bounded = first && solved && refinement * refinement * now.miss <= least;
			bool accepted = now.miss <= least || report.error <= finest;
			if (boundaries < 0 && (bounded || accepted) && (now.yields || !accepted))
				boundaries = closingOfBoundaries(system, start.freeVelocity());
			accepted = !large && (accepted || (bounded && boundaries <= least));
			// Bodies that fall or fly must not hide that boundaries slowly close in on others.
			const bool hidden = accepted && now.yields && boundaries > 0;
			if ((!accepted || hidden) && !possible) {
				const double slowest = hidden ? closing * std::min(boundaries, now.free) : least;
				const int search = productsAfter(report.iterations),
					  products = hidden ? std::min(search, mostProducts(system)) : search;
				const Feasibility found = feasibility(system, start.freeVelocity(), slowest, products);
				if (found.contact >= 0) {
					report.status = Status::no_solution;
					report.contact = found.contact;
					return;
				}
				possible = found.possible;
				accepted = hidden || (!large && bounded && possible && !now.yields && refinement * now.miss <= least);
			}
			if (accepted) {
				report.contact = contact;
				report.status = solved ? Status::converged : report.status;
				return;
			}
			contact = solved || large ? now.contact : -1;
			const bool vain = !first && now.growth > grows * before.growth && now.miss > falls * before.miss;
			inVain = vain ? inVain + 1 : 0;
			before = now;
			if (report.status != Status::converged || (large && now.growth > mostGrowth) || inVain == 2 || settings.tolerance <= finest
			    || report.iterations >= settings.maxIterations) {
				report.contact = contact;
				if (now.indefinite)
					report.status = Status::indefinite;
				else if (report.status == Status::converged)
					report.status = report.iterations < settings.maxIterations ? Status::stagnated : Status::max_iterations;
				return;
			}
			settings.tolerance = std::max(finest, refinement * settings.tolerance);
			report = goOn<System>(system, start, settings, report, method);
		}
	}

	// Solves a problem by a method. What counts as converged resolves the velocities, too.
	template <class System, Method<System> method> SolverReport solved(System& system, const SolverSettings& settings)
	{
		const Start start(system, settings.threads);
		SolverSettings part = settings;
		part.start = &start;
		SolverSettings first = part;
		first.maxIterations -= keptForClosed<System>(part);
		SolverReport report = goOn<System>(system, start, first, {}, method);
		tryClosed(system, start, part, report);
		tryPlain<System>(system, start, part, report, method);
		if (settings.fixedIterations > 0)
			return report;
		if (!start.solvable) {
			makeRows(system);
			resolve<System>(system, start, part, report, method);
		} else if constexpr (!std::is_same_v<System, DelassusSystem> && !std::is_same_v<System, ConeSystem>)
			if (createEnergy(system, start, report))
				solveFromNothing(system, start, part, report);
		return report;
	}

	struct Entry {
		const char* name = nullptr;
		Solver<Plane> solver = nullptr;
		Solver<RollingPlane> rollingSolver = nullptr;
		DelassusSolver delassusSolver = nullptr;
		ConeSolver coneSolver = nullptr;
		Solver<Space3> spaceSolver = nullptr;
	};
	template <Method<ContactSystem<Space3>> method> constexpr Solver<Space3> inSpace = solved<ContactSystem<Space3>, method>;
	const Entry entries[] = {
		{ "nsgs", solved<ContactSystem<Plane>, nsgs>, solved<ContactSystem<RollingPlane>, nsgs>, solved<DelassusSystem, nsgs>,
		    solved<ConeSystem, nsgs>, inSpace<nsgs> },
		{ "accelerated", solved<ContactSystem<Plane>, accelerated>, solved<ContactSystem<RollingPlane>, accelerated>,
		    solved<DelassusSystem, accelerated>, solved<ConeSystem, accelerated>, inSpace<accelerated> },
		{ "newton", solved<ContactSystem<Plane>, newton>, nullptr, solved<DelassusSystem, newton>, solved<ConeSystem, newton> },
		{ "auto", solved<ContactSystem<Plane>, automatic>, solved<ContactSystem<RollingPlane>, accelerated>,
		    solved<DelassusSystem, automatic>, solved<ConeSystem, automatic>, inSpace<accelerated> },
	};

	const Entry& find(const std::string& method)
	{
		static const Entry none {};
		const auto found = std::find_if(std::begin(entries), std::end(entries), [&](const Entry& e) { return method == e.name; });
		return found != std::end(entries) ? *found : none;
	}

} // namespace

template <> Solver<Plane> findSolver<Plane>(const std::string& method) { return find(method).solver; }
template <> Solver<RollingPlane> findSolver<RollingPlane>(const std::string& method) { return find(method).rollingSolver; }
template <> Solver<Space3> findSolver<Space3>(const std::string& method) { return find(method).spaceSolver; }
DelassusSolver findDelassusSolver(const std::string& method) { return find(method).delassusSolver; }
ConeSolver findConeSolver(const std::string& method) { return find(method).coneSolver; }

std::vector<std::string> solverNames()
{
	std::vector<std::string> names;
	for (const Entry& e : entries)
		names.emplace_back(e.name);
	return names;
}

std::string solvedBy(const std::string& method, const SolverReport& report)
{
	if (report.status != Status::converged)
		return "none";
	if (report.plain)
		return "nsgs";
	if (report.factorizations > 0)
		return "newton";
	return method == "newton" || method == "auto" ? "accelerated" : method; // both begin with these sweeps
}

const char* name(Status s)
{
	constexpr const char* names[] // in the order of the declaration
	    = { "converged", "fixed_iterations", "max_iterations", "stagnated", "diverged", "no_solution", "indefinite" };
	return names[static_cast<int>(s)];
}

} // namespace cd
