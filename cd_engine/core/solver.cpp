#include "solver.hpp"
#include "verdict.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	// Growth of impulses from which a small error alone is no sign of a solution; loosely solved piles of 10 000 disks stay below.
	constexpr double largeGrowth = 1e4;
	constexpr double refinement = 1e-3; // of the tolerance, where doubts have to be cleared
	constexpr double finest = 1e-15; // tolerance, below the round-off of a sum
	constexpr int sweepsToTell = 1000; // kept for the question whether there is a solution, as far as a tenth of all

	// What a method changes, and what it needs to begin again.
	struct Free {
		explicit Free(const ContactSystem& s)
		    : v(3 * s.bodies.size())
		{
			for (std::size_t i = 0; i < s.bodies.size(); i++)
				std::copy_n(s.bodies[i].v, 3, &v[3 * i]);
		}
		explicit Free(const DelassusSystem&) { }

		void giveBack(ContactSystem& s) const
		{
			for (std::size_t i = 0; i < s.bodies.size(); i++)
				std::copy_n(&v[3 * i], 3, s.bodies[i].v);
		}
		void giveBack(DelassusSystem&) const { }

		Verdict of(const ContactSystem& s, double guess) const { return judge(s, v, guess); }
		Verdict of(const DelassusSystem& s, double guess) const { return judge(s, guess); }

		std::vector<double> v;
	};

	void clearImpulses(ContactSystem& s)
	{
		for (ContactRow& c : s.contacts)
			c.pn = c.pt = 0;
	}
	void clearImpulses(DelassusSystem& s) { std::fill(s.p.begin(), s.p.end(), 0.); }

	// Whether the verdict says why there is no solution; the report then does, too.
	bool named(const Verdict& v, SolverReport& report)
	{
		if (v.finding == Finding::nothing || v.finding == Finding::doubtful)
			return false;
		report.contact = v.contact;
		report.status = v.finding == Finding::not_finite ? Status::diverged
		    : v.finding == Finding::indefinite           ? Status::indefinite
								 : Status::no_solution;
		return true;
	}

	template <class System> using Method = SolverReport (*)(System&, const SolverSettings&);

	template <class System, Method<System> method> SolverReport judged(System& system, const SolverSettings& settings)
	{
		if (surelySolvable(system)) {
			SolverReport report = method(system, settings);
			if (!std::isfinite(weighted(system)))
				report.status = Status::diverged;
			return report;
		}
		const Free free(system);
		const double guess = weighted(system);
		SolverSettings part = settings;
		part.maxIterations -= settings.fixedIterations > 0 ? 0 : std::min(sweepsToTell, settings.maxIterations / 10);
		SolverReport report = method(system, part);
		Verdict verdict = free.of(system, guess);
		const auto goOn = [&](double tolerance) {
			part.tolerance = tolerance;
			part.maxIterations = settings.maxIterations - report.iterations;
			if (part.maxIterations <= 0)
				return false;
			free.giveBack(system);
			const SolverReport before = report;
			report = method(system, part);
			report.iterations += before.iterations;
			report.factorizations += before.factorizations;
			verdict = free.of(system, guess);
			return true;
		};
		const auto doubtful = [&] { return verdict.finding == Finding::doubtful && verdict.growth > largeGrowth; };
		while (report.status == Status::converged && doubtful() && part.tolerance > finest)
			if (!goOn(std::max(finest, refinement * part.tolerance)))
				report.status = Status::max_iterations;
		if (report.status == Status::converged && doubtful())
			report.status = Status::stagnated;
		if (named(verdict, report) || report.status == Status::converged || report.status == Status::fixed_iterations)
			return report;
		// What was kept are the best impulses, which may be none at all; those of plain sweeps show where they grow.
		SolverSettings plain = settings;
		plain.fixedIterations = std::min(sweepsToTell, settings.maxIterations - report.iterations);
		if (plain.fixedIterations <= 0)
			return report;
		System other = system;
		free.giveBack(other);
		clearImpulses(other);
		report.iterations += nsgs(other, plain).iterations;
		named(free.of(other, 0), report);
		return report;
	}
	struct Entry {
		const char* name;
		Solver solver;
		DelassusSolver delassusSolver;
	};
	const Entry entries[] = {
		{ "nsgs", judged<ContactSystem, nsgs>, judged<DelassusSystem, nsgs> },
		{ "accelerated", judged<ContactSystem, accelerated>, judged<DelassusSystem, accelerated> },
		{ "newton", judged<ContactSystem, newton>, judged<DelassusSystem, newton> },
		{ "auto", judged<ContactSystem, automatic>, judged<DelassusSystem, automatic> },
	};

	const Entry* find(const std::string& method)
	{
		for (const Entry& e : entries)
			if (method == e.name)
				return &e;
		return nullptr;
	}
} // namespace

Solver findSolver(const std::string& method)
{
	const Entry* const e = find(method);
	return e ? e->solver : nullptr;
}

DelassusSolver findDelassusSolver(const std::string& method)
{
	const Entry* const e = find(method);
	return e ? e->delassusSolver : nullptr;
}

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
	if (report.factorizations > 0)
		return "newton";
	return method == "newton" || method == "auto" ? "accelerated" : method; // both begin with these sweeps
}

const char* name(Status s)
{
	switch (s) {
	case Status::converged:
		return "converged";
	case Status::fixed_iterations:
		return "fixed_iterations";
	case Status::max_iterations:
		return "max_iterations";
	case Status::stagnated:
		return "stagnated";
	case Status::diverged:
		return "diverged";
	case Status::no_solution:
		return "no_solution";
	case Status::indefinite:
		return "indefinite";
	}
	return "unknown";
}

} // namespace cd
