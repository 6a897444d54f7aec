// Proximal-point semismooth Newton: a direct method for small problems at which sweeps stagnate.
//
// The proximal-point method (Rockafellar 1976, SIAM J. Control Optim. 14, 877) replaces the problem by better conditioned ones about a centre pk.
// Their solution p misses the contact law by sigma D (p - pk). proximal_problem.hpp solves one of them. There are two ways to the next one:
//   The centre moves to the solution. sigma falls if that was easy and rises if it failed. With much friction this can cycle.
//   The centre stays, and sigma falls by as much as can be solved. This ends where the solutions turn back to larger sigma.
// One way works where the other gets stuck. They take turns as long as the error falls.
// In a jammed packing a motion of 1e-7 of a free fall decides which contacts stay closed, and the indeterminate forces must then change by up to a
// third of their size. This is why sweeps need 1e5 iterations and more, and this method needs hundreds of factorizations.
// A step costs the factorization of a matrix with three rows a body: as much as some 300 sweeps at 400 disks, and 1700 at 3600.
#include "newton/newton.hpp"
#include "solvers/solver.hpp"
#include "solvers/start.hpp"

namespace cd {
namespace {

	// Found by trial on packings, hyperstatic lattices, and piles whose masses differ by 1e6, with 100 to 400 disks each.
	constexpr double sigmaAtStart = 1e-2;
	constexpr double fall = 0.3, rise = 6; // factors on sigma, from one proximal problem to the next
	constexpr double steepest = 0.05, flattest = 0.9; // factors on sigma while the centre stays
	constexpr int fewSteps = 6; // Newton steps up to which a proximal problem counts as easy
	constexpr int patience = 8; // number of proximal problems in which the error must fall by a tenth
	constexpr double coarse = 1e-3; // error below which sweeps are no longer the fastest method
	constexpr int sweepsAtStart = 500;

	template <class System> class Newton {
	    public:
		Newton(System& s, const SolverSettings& t)
		    : linear(s)
		    , problem(linear, t.maxIterations, t.mostWork)
		    , tolerance(t.tolerance)
		    , trace(t.trace)
		{
		}

		SolverReport run()
		{
			std::vector<double> first;
			linear.load(first);
			evaluate(first);
			best = projected;
			bestError = error;
			double before;
			do {
				before = bestError;
				moveCentre();
				holdCentre();
			} while (unsolved() && bestError < 0.9 * before);
			return report();
		}

	    private:
		bool unsolved() const { return bestError > tolerance && !problem.exhausted(); }

		void moveCentre()
		{
			std::vector<double> centre = best;
			double sigma = sigmaAtStart, mark = bestError;
			for (int idle = 0; unsolved() && idle < patience;) {
				const int before = problem.steps();
				problem.centre(centre);
				const bool solved = problem.solve(sigma);
				evaluate(problem.impulses());
				// The error may rise for a while on the way down. The result of a failed solve may be anywhere, so it is no centre.
				centre = solved && std::isfinite(error) ? projected : best;
				if (!solved)
					sigma *= rise;
				else if (problem.steps() - before <= fewSteps)
					sigma *= fall;
				idle++;
				if (bestError < 0.9 * mark) {
					mark = bestError;
					idle = 0;
				}
			}
		}

		void holdCentre()
		{
			problem.centre(best);
			double sigma = sigmaAtStart, solvedSigma = 0, factor = fall;
			while (unsolved() && sigma < 1 && factor < 1) {
				const int before = problem.steps();
				const bool solved = solvedSigma > 0 ? problem.resume(sigma) : problem.solve(sigma);
				evaluate(problem.impulses());
				const int made = problem.steps() - before;
				if (!solved && solvedSigma == 0) {
					sigma *= rise;
					continue;
				}
				if (solved)
					solvedSigma = sigma;
				if (!solved && factor > flattest)
					return;
				if (solved && made <= fewSteps)
					factor = std::max(steepest, factor * factor);
				else if (!solved || made > 2 * fewSteps)
					factor = std::sqrt(factor);
				sigma = solvedSigma * factor;
			}
		}

		SolverReport report()
		{
			linear.store(best);
			const Residual e = linear.error();
			SolverReport r;
			r.iterations = r.factorizations = problem.steps();
			r.measure(e);
			r.status = problem.exhausted() ? Status::max_iterations : Status::stagnated;
			if (std::isnan(r.error))
				r.status = Status::diverged;
			else if (r.error <= tolerance)
				r.status = Status::converged;
			return r;
		}

		// Computes the error of an iterate projected on the cone, and keeps the best iterate.
		void evaluate(const std::vector<double>& p)
		{
			projected.resize(p.size());
			for (std::size_t i = 0; i < linear.size(); i++) {
				const Impulse cut = cutKeeping({ p[2 * i], p[2 * i + 1] }, linear.friction(i));
				projected[2 * i] = cut.n;
				projected[2 * i + 1] = cut.t;
			}
			linear.store(projected);
			const Residual e = linear.error();
			error = e.error();
			if (error < bestError) {
				bestError = error;
				best = projected;
			}
			if (!trace)
				return;
			trace->add(problem.steps() - traced);
			trace->evaluated(error);
			traced = problem.steps();
		}

		NewtonSystem<System> linear;
		ProximalProblem<NewtonSystem<System>> problem;
		const double tolerance;
		Trace* const trace;
		int traced = 0; // steps that the trace knows of
		std::vector<double> projected, best;
		double error = 0, bestError = std::numeric_limits<double>::infinity();
	};

	// Sweeps come first: in the time of a few factorizations they find which contacts are loaded.
	template <class System> SolverReport solve(System& system, const SolverSettings& settings)
	{
		if (settings.fixedIterations > 0)
			return accelerated(system, settings);
		std::optional<Start> own;
		const Start& start = settings.start ? *settings.start : own.emplace(system, settings.threads);
		SolverSettings sweeps = settings;
		sweeps.tolerance = std::max(settings.tolerance, coarse);
		sweeps.maxIterations = std::min(settings.maxIterations / 4, sweepsAtStart);
		const SolverReport first = accelerated(system, sweeps);
		if (first.error <= settings.tolerance || first.status == Status::diverged)
			return first;
		start.free(system);
		SolverSettings rest = settings;
		rest.maxIterations -= first.iterations;
		SolverReport report = Newton<System>(system, rest).run();
		report.iterations += first.iterations;
		return report;
	}

} // namespace

SolverReport newton(ContactSystem<Plane>& s, const SolverSettings& t) { return solve<ContactSystem<Plane>>(s, t); }
SolverReport newton(DelassusSystem& s, const SolverSettings& t) { return solve<DelassusSystem>(s, t); }

} // namespace cd
