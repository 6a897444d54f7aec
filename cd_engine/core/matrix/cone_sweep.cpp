#include "matrix/cone_sweep.hpp"

#include <cassert>

namespace cd {

ConeSweep::ConeSweep(ConeSystem& s, unsigned seed, Threads*)
    : system(s)
    , order(seed, s.memory)
{
	assert(system.consistent());
}

Triple ConeSweep::solved(std::size_t i) const
{
	Triple q = system.q[i];
	for (std::size_t k = system.start[i]; k < system.diagonal[i]; k++)
		ConeSystem::addProduct(q, system.blocks[k], system.p[system.column[k]]);
	for (std::size_t k = system.diagonal[i] + 1; k < system.start[i + 1]; k++)
		ConeSystem::addProduct(q, system.blocks[k], system.p[system.column[k]]);
	return solveLocal(system.own(i), system.mu[i], q);
}

void ConeSweep::operator()()
{
	order.visit(system.contacts(), [this](std::size_t from, std::size_t to) {
		for (std::size_t i = from; i < to; i++)
			system.p[i] = solved(i);
	});
}

void ConeSweep::ahead()
{
	const std::size_t count = system.contacts();
	if (before.empty()) {
		before = system.p;
		momentum.begin(count);
		steps.resize(count);
	}
	for (std::size_t i = 0; i < count; i++) {
		const Triple now = system.p[i];
		for (std::size_t k = 0; k < 3; k++)
			system.p[i][k] = now[k] + momentum.betas[i] * (now[k] - before[i][k]);
		before[i] = now;
	}
	order.visit(count, [this](std::size_t from, std::size_t to) {
		for (std::size_t i = from; i < to; i++) {
			const Triple next = solved(i), change = difference(system.p[i], next), advance = difference(next, before[i]);
			steps[i] = { square(change), change[0] * advance[0] + change[1] * advance[1] + change[2] * advance[2] };
			system.p[i] = next;
		}
	});
	for (std::size_t i = 0; i < count; i++)
		momentum.afterStep(i, steps[i]);
	momentum.afterSweep(steps);
}

} // namespace cd
