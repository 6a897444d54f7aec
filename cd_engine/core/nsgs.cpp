// Nonlinear (block) Gauss-Seidel: contact by contact, each solved exactly with the others held (Moreau 1988; Jean 1999, section 6).
// The reference method: linear convergence, about sqrt(N) sweeps and more to carry a force through N disks.
#include "iterate.hpp"

namespace cd {

SolverReport nsgs(ContactSystem& system, const SolverSettings& settings)
{
	return iterate(system, settings, [](Sweep& sweep) { return [&sweep] { sweep(); }; });
}

} // namespace cd
