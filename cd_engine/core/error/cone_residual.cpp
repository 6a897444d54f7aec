// The error of a contact problem in space that is given by its matrix.
#include "error/residual.hpp"

namespace cd {

Residual residual(const ConeSystem& system)
{
	assert(system.consistent());
	ResidualSum sum;
	for (std::size_t i = 0; i < system.contacts(); i++) {
		const Triple &p = system.p[i], &q = system.q[i];
		double size = std::abs(q[0]) + std::abs(q[1]) + std::abs(q[2]);
		for (std::size_t k = system.start[i]; k < system.start[i + 1]; k++)
			for (std::size_t j = 0; j < 9; j++)
				size += std::abs(system.blocks[k][j] * system.p[system.column[k]][j % 3]);
		const double wnn = system.own(i)[0];
		sum.contacts++;
		addTo(sum, missOf(p, system.velocity(i, system.p), system.mu[i], wnn, size), square(p), wnn);
	}
	Residual r = sum.of();
	r.bodies = 0; // not known here
	return r;
}

} // namespace cd
