#include "solver.hpp"
#include "judged.hpp"

#include <algorithm>
#include <iterator>

namespace cd {
namespace {

	struct Entry {
		const char* name = nullptr;
		Solver solver = nullptr;
		DelassusSolver delassusSolver = nullptr;
	};
	const Entry entries[] = {
		{ "nsgs", judged<ContactSystem, nsgs>, judged<DelassusSystem, nsgs> },
		{ "accelerated", judged<ContactSystem, accelerated>, judged<DelassusSystem, accelerated> },
		{ "newton", judged<ContactSystem, newton>, judged<DelassusSystem, newton> },
		{ "auto", judged<ContactSystem, automatic>, judged<DelassusSystem, automatic> },
	};

	const Entry& find(const std::string& method)
	{
		static const Entry none {};
		const auto found = std::find_if(std::begin(entries), std::end(entries), [&](const Entry& e) { return method == e.name; });
		return found != std::end(entries) ? *found : none;
	}

} // namespace

Solver findSolver(const std::string& method) { return find(method).solver; }
DelassusSolver findDelassusSolver(const std::string& method) { return find(method).delassusSolver; }

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
