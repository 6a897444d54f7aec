// Nonlinear (block) Gauss-Seidel: solves contact by contact, each exactly while the others are held (Moreau 1988; Jean 1999, section 6). This is the
// reference method. It converges linearly and needs about sqrt(N) sweeps or more to carry a force through N disks.
#include "matrix/matrix.hpp"
#include "solvers/iterate.hpp"
#include "sweeps/sweeps.hpp"

namespace cd {

template <class Space> SolverReport nsgs(ContactSystem<Space>& system, const SolverSettings& settings)
{
	return iterate<Sweep<Space>>(system, settings);
}
template SolverReport nsgs(ContactSystem<Plane>&, const SolverSettings&);
template SolverReport nsgs(ContactSystem<RollingPlane>&, const SolverSettings&);
template SolverReport nsgs(ContactSystem<Space3>&, const SolverSettings&); // nobody tests whether these resolve the velocities

SolverReport nsgs(DelassusSystem& system, const SolverSettings& settings) { return iterate<DelassusSweep>(system, settings); }
SolverReport nsgs(ConeSystem& system, const SolverSettings& settings) { return iterate<ConeSweep>(system, settings); }

} // namespace cd
