#include "delassus_sweep.hpp"
#include "local_problem.hpp"

namespace cd {

inline void DelassusSweep::solve(std::size_t i)
{
	double qn = system.q[2 * i], qt = system.q[2 * i + 1];
	const auto add = [&](std::size_t from, std::size_t to) {
		for (std::size_t k = from; k < to; k++) {
			const Block& w = system.blocks[k];
			const double* p = &system.p[2 * system.column[k]];
			qn += w.nn * p[0] + w.nt * p[1];
			qt += w.tn * p[0] + w.tt * p[1];
		}
	};
	// What the others make of the velocity; subtracting the own share from the whole would cost digits.
	const std::size_t own = system.diagonal[i];
	add(system.start[i], own);
	add(own + 1, system.start[i + 1]);
	const Block& w = system.blocks[own];
	solveLocal(w.nn, w.nt, w.tn, w.tt, system.mu[i], qn, qt, system.p[2 * i], system.p[2 * i + 1]);
}

void DelassusSweep::operator()()
{
	if (order) {
		for (const int32_t i : order.next(system.contacts()))
			solve(static_cast<std::size_t>(i));
		return;
	}
	for (std::size_t i = 0; i < system.contacts(); i++)
		solve(i);
}

} // namespace cd
