#include "solver.hpp"
#include "start.hpp"
#include "verdict.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	// Of the tolerance, where doubts have to be cleared: the power that a solution still keeps falls with it, of what has none it does not.
	constexpr double refinement = 0.1;
	constexpr double finest = 1e-15; // tolerance, below the round-off of a sum
	constexpr int fewSweeps = 64, fewProducts = 16;
	constexpr int sweepsToTell = 1000; // kept for the question whether there is a solution, as far as a tenth of all

	// A proof may cost about as much as the sweeps did, or as Newton's method does: a product with W costs about four sweeps.
	int productsAfter(int sweeps) { return 300 + sweeps / 4; }

	Verdict judge(const ContactSystem& s, const Start& start, double guess, int products) { return judge(s, start.freeVelocity(), guess, products); }
	Verdict judge(const DelassusSystem& s, const Start&, double guess, int products) { return judge(s, guess, products); }

	void clearImpulses(ContactSystem& s)
	{
		for (ContactRow& c : s.contacts)
			c.pn = c.pt = 0;
	}
	void clearImpulses(DelassusSystem& s) { std::fill(s.p.begin(), s.p.end(), 0.); }

	template <class System> using Method = SolverReport (*)(System&, const SolverSettings&);

	// Goes on from the impulses in the system with `method`, in what is left of `settings.maxIterations`.
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

	// No method ends without a solution where plain sweeps find one, as they do wherever W is positive definite and friction not too large.
	template <class System>
	void tryPlain(System& system, const Start& start, const SolverSettings& settings, SolverReport& report, Method<System> method)
	{
		if (method == static_cast<Method<System>>(nsgs) || report.status != Status::stagnated || report.iterations >= settings.maxIterations)
			return;
		static thread_local System other; // its memory serves every step
		other = system;
		start.guess(other);
		SolverReport plain = goOn<System>(other, start, settings, report, nsgs);
		report.iterations = plain.iterations;
		if (plain.status != Status::converged)
			return;
		plain.plain = true;
		report = plain;
		std::swap(system, other);
	}

	// Whether it is proven that there is no solution, or whether what counts as solved is beyond every bound; the report then says so.
	bool named(const Verdict& v, SolverReport& report)
	{
		const bool solved = report.status == Status::converged;
		if (v.finding == Finding::nothing || v.finding == Finding::doubtful || (v.finding == Finding::beyond && !solved))
			return false;
		report.contact = v.contact;
		report.status = v.finding == Finding::not_finite ? Status::diverged
		    : v.finding == Finding::indefinite		 ? Status::indefinite
								 : Status::no_solution;
		return true;
	}

	// What was kept are the best impulses, which may be none at all; those of plain sweeps show whether they grow.
	template <class System> void findOut(System& system, const Start& start, const SolverSettings& settings, SolverReport& report)
	{
		SolverSettings plain = settings;
		plain.start = &start;
		plain.fixedIterations = std::min(sweepsToTell, settings.maxIterations - report.iterations);
		if (plain.fixedIterations <= 0)
			return;
		static thread_local System other;
		other = system;
		start.free(other);
		clearImpulses(other);
		report.iterations += nsgs(other, plain).iterations;
		const Verdict verdict = judge(other, start, 0, productsAfter(plain.fixedIterations));
		if (verdict.finding != Finding::not_finite) // as sweeps may end where others do not
			named(verdict, report);
	}

	template <class System, Method<System> method> SolverReport judged(System& system, const SolverSettings& settings)
	{
		const Start start(system);
		const bool fixed = settings.fixedIterations > 0, solvable = surelySolvable(system);
		const double guess = solvable || !settings.guessSolved ? 0 : weighted(system);
		SolverSettings part = settings;
		part.start = &start;
		if (!solvable && !fixed)
			part.maxIterations -= std::min(sweepsToTell, settings.maxIterations / 10);
		SolverReport report = method(system, part);
		tryPlain(system, start, part, report, method);
		if (solvable)
			return report;
		bool proofTried = report.status != Status::converged;
		const auto look = [&] { return judge(system, start, guess, proofTried ? productsAfter(report.iterations) : fewProducts); };
		Verdict verdict = look();
		// A guess that solves nothing may be so large that any error is small beside it: what it leads to has to be reached without it, too.
		if (!settings.guessSolved && report.status == Status::converged && verdict.finding == Finding::nothing) {
			start.free(system);
			clearImpulses(system);
			const Start cold(system);
			part.start = &cold;
			report = goOn<System>(system, cold, part, report, method);
			part.start = &start;
			verdict = look();
		}
		const auto doubtful = [&] { return report.status == Status::converged && verdict.finding == Finding::doubtful; };
		while (doubtful() && part.tolerance > finest && report.iterations < settings.maxIterations) {
			part.tolerance = std::max(finest, refinement * part.tolerance);
			// Most doubts are gone after a few sweeps more, which cost less than a proof among many contacts.
			part.maxIterations = proofTried ? settings.maxIterations : std::min(settings.maxIterations, report.iterations + std::max(fewSweeps, report.iterations));
			report = goOn<System>(system, start, part, report, method);
			const bool first = !proofTried;
			proofTried = true;
			verdict = look();
			// That it was not more exact does not matter.
			if (report.error <= settings.tolerance && (verdict.finding == Finding::nothing || (first && verdict.finding == Finding::doubtful)))
				report.status = Status::converged;
		}
		if (doubtful()) {
			report.status = report.iterations < settings.maxIterations ? Status::stagnated : Status::max_iterations;
			report.contact = verdict.contact;
		}
		report.doubtful = fixed && (verdict.finding == Finding::beyond || (verdict.finding == Finding::doubtful));
		if (!named(verdict, report) && !fixed && report.status != Status::converged)
			findOut(system, start, settings, report);
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
	if (report.plain)
		return "nsgs";
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
