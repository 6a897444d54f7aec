#include "solver.hpp"
#include "judged.hpp"

namespace cd {
namespace {

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
