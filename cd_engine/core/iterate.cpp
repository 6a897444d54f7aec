#include "iterate.hpp"
#include "residual.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	class Loop {
	    public:
		Loop(ContactSystem& s, const SolverSettings& t)
		    : system(s)
		    , settings(t)
		    , freeVelocity(3 * s.bodies.size())
		{
			for (size_t i = 0; i < s.bodies.size(); i++)
				std::copy_n(s.bodies[i].v, 3, &freeVelocity[3 * i]);
		}

		SolverReport run(const std::function<std::function<void()>(Sweep&)>& method)
		{
			Sweep sweep(system, freeVelocity, settings.seed);
			if (settings.fixedIterations > 0) {
				for (; report.iterations < settings.fixedIterations; report.iterations++)
					sweep();
				report.status = Status::fixed_iterations;
			} else
				report.status = untilSolved(sweep, method(sweep));
			sweep.restoreVelocities(freeVelocity);
			evaluate();
			if (std::isnan(report.residual))
				report.status = Status::diverged;
			return report;
		}

	    private:
		Status untilSolved(Sweep& sweep, const std::function<void()>& improve)
		{
			evaluate();
			double best = error, smallest = error;
			int bestAt = 0;
			keep(sweep);
			while (error > settings.tolerance) {
				if (report.iterations >= settings.maxIterations)
					return giveBest(sweep, Status::max_iterations);
				// No gain of a hundredth while the number of sweeps doubled, and at least a thousand: waiting on is in vain.
				if (report.iterations > 1000 + 2 * bestAt)
					return giveBest(sweep, Status::stagnated);
				// The error costs two sweeps, so it is asked for at a spacing that grows with the sweeps already made.
				const int more = std::min(settings.maxIterations - report.iterations, 4 + report.iterations / 10);
				for (int i = 0; i < more; i++)
					improve();
				report.iterations += more;
				sweep.storeImpulses();
				evaluate();
				if (error < smallest) {
					smallest = error;
					keep(sweep);
				}
				if (error < 0.99 * best) {
					best = error;
					bestAt = report.iterations;
				}
			}
			return std::isnan(error) ? Status::diverged : Status::converged;
		}

		void keep(Sweep& sweep)
		{
			bestImpulses.resize(2 * sweep.size());
			sweep.forEachImpulse([&](double pn, double pt, std::size_t i) {
				bestImpulses[2 * i] = pn;
				bestImpulses[2 * i + 1] = pt;
			});
		}

		// With momentum the last iterate may be far from the best.
		Status giveBest(Sweep& sweep, Status status)
		{
			sweep.forEachImpulse([&](double& pn, double& pt, std::size_t i) {
				pn = bestImpulses[2 * i];
				pt = bestImpulses[2 * i + 1];
			});
			return status;
		}

		void evaluate()
		{
			const Residual e = residual(system, freeVelocity);
			report.residual = e.norm;
			report.residualMax = e.maximum;
			report.error = error = std::max(e.norm, e.energy);
		}

		ContactSystem& system;
		const SolverSettings& settings;
		std::vector<double> freeVelocity;
		SolverReport report;
		double error = 0; // what is held against the tolerance
		std::vector<double> bestImpulses; // of the iterate with the smallest error
	};

} // namespace

SolverReport iterate(ContactSystem& system, const SolverSettings& settings, const std::function<std::function<void()>(Sweep&)>& method)
{
	return Loop(system, settings).run(method);
}

} // namespace cd
