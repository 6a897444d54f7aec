// What a step is given, and what it reports.
#pragma once

#include "islands/islands.hpp"
#include "scene/scene.hpp"

#include <array>
#include <limits>

namespace cd {

template <class Space> struct StepSettings {
	double dt = 0; // [s]
	double restitution = 0; // Newton's e, normal direction
	double dampingRatio = 0; // of the normal dashpot of contacts with stiffness, as a share of critical damping
	double overlapCorrection = 0; // share of an overlap, beyond the reference and the allowed one, that the step removes (overlap_correction.hpp)
	double gapCorrection = 0; // the same, by a velocity that stays
	double allowedOverlap = 0; // that both leave, as a share of the smaller disk's radius
	int threads = 1; // threads that share the work of a large scene; the bits do not depend on their number
	bool warmStart = true; // the first guess are the forces that contacts have carried; else nothing
	long iteration = 0; // number of the step, recorded where a contact becomes loaded
	bool reduce = true; // solve islands of contacts separately (island_solver.hpp)
	Solver<Space> solve = nullptr;
	Solver<RollingPlane> solveRolling = nullptr; // the same method, where contacts resist rolling
	SolverSettings solver;
	// Tolerance of rest, if it is smaller than that of the step. The same in all steps, so that it does not matter in which of them an island is
	// examined. With stiffnesses, larger than the step's: errors of earlier steps leave the springs that much out of balance.
	double restTolerance = std::numeric_limits<double>::infinity();
};

struct StepReport {
	SolverReport solver;
	Effort effort;
	std::array<int32_t, 2> unsolvable { -1, -1 }; // bodies of SolverReport::contact
	int contacts = 0; // contacts that the solver was given
	int slidingContacts = 0; // loaded contacts with mu > 0 and |p_t| at mu p_n
	int loadedContacts = 0;
	double maxPenetration = 0; // [m], beyond the reference overlap, at the mid-configuration
	double dissipated = 0; // [J] in this step; with stiffnesses by friction only
	// Of contacts with stiffness [J]:
	double stored = 0, storedBefore = 0; // energy of the springs at the end and, without sleeping islands, at the beginning of the step
	double absorbed = 0; // by springs and dashpots in this step
	double dashpots = 0; // of this: by dashpots
	double damped = 0; // kinetic energy that backward Euler takes, sum m |v' - v|^2/2
	double work = 0; // sum of |p . u| of all contacts
	double solveSeconds = 0; // spent in the solver
	std::vector<double> outran; // of each body: how far from its place before the step pairs must be listed [m]; empty: the list was long enough
	bool idle = false; // nothing moves and all contacts sleep: under the same forces the next step changes nothing either
};

} // namespace cd
