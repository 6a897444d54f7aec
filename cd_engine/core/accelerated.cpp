// Gauss-Seidel sweeps with momentum: a sweep from the point y = p + beta (p - q) ahead of the last two iterates q, p.
//
// beta follows Nesterov's sequence (Nesterov 1983; O'Donoghue & Candes 2015, "Adaptive restart for accelerated gradient schemes",
// eqs. 6-8), with their restart when the sweep turns back against the momentum. Friction makes the problem non-monotone, where
// momentum can blow up: beta is capped, and the cap lowered whenever the changes made by the sweeps do not decrease over a window.
// An iteration costs a sweep, 32 bytes a contact more, and a pass over the velocities.
#include "delassus_sweep.hpp"
#include "iterate.hpp"
#include "sweep.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace cd {
namespace {

	// A sweep from y = p + beta (p - q); then q is p.
	template <class S> class SweepAhead {
	    public:
		explicit SweepAhead(S& s)
		    : sweep(s)
		    , before(2 * s.size())
		    , ahead(2 * s.size())
		{
			sweep.forEachImpulse([&](double pn, double pt, std::size_t i) {
				before[2 * i] = pn;
				before[2 * i + 1] = pt;
			});
		}

		AheadReport operator()(double beta)
		{
			sweep.forEachImpulse([&](double& pn, double& pt, std::size_t i) {
				const double n = pn, t = pt;
				pn += beta * (n - before[2 * i]);
				pt += beta * (t - before[2 * i + 1]);
				before[2 * i] = n;
				before[2 * i + 1] = t;
				ahead[2 * i] = pn;
				ahead[2 * i + 1] = pt;
			});
			sweep();
			AheadReport report;
			sweep.forEachImpulse([&](double pn, double pt, std::size_t i) {
				const double dn = ahead[2 * i] - pn, dt = ahead[2 * i + 1] - pt;
				report.change += dn * dn + dt * dt;
				report.against += dn * (pn - before[2 * i]) + dt * (pt - before[2 * i + 1]);
			});
			return report;
		}

	    private:
		S& sweep;
		std::vector<double> before, ahead; // q and y, two numbers a contact
	};

	// In one pass where the form has a kernel for it.
	template <> class SweepAhead<Sweep> {
	    public:
		explicit SweepAhead(Sweep& s)
		    : sweep(s)
		{
		}
		AheadReport operator()(double beta) { return sweep.ahead(beta); }

	    private:
		Sweep& sweep;
	};

	template <class S> class Momentum {
	    public:
		explicit Momentum(S& s)
		    : sweepAhead(s)
		{
		}

		void operator()()
		{
			const AheadReport made = sweepAhead(std::min(cap, (t - 1) / next(t)));
			t = made.against > 0 ? 1 : next(t);
			watch(std::sqrt(made.change));
		}

	    private:
		static constexpr int window = 20; // sweeps over which the changes must decrease

		static double next(double t) { return 0.5 * (1 + std::sqrt(1 + 4 * t * t)); }

		void watch(double change)
		{
			sum += change;
			largest = std::max(largest, change);
			if (++made % window != 0)
				return;
			// A window no better than the last, or with a spike in it: momentum is doing harm.
			const bool worse = sum > 0.98 * lastSum || largest > 4 * lastSum / window;
			cap = worse && lastSum > 0 ? std::max(0., 1 - 1.5 * (1 - cap)) : std::min(0.995, 1 - 0.8 * (1 - cap));
			lastSum = sum;
			sum = largest = 0;
		}

		SweepAhead<S> sweepAhead;
		double t = 1, cap = 0.9;
		double sum = 0, lastSum = 0, largest = 0;
		int made = 0;
	};

	template <class S> SolverReport solve(typename S::System& system, const SolverSettings& settings)
	{
		return iterate<S>(system, settings, [](S& sweep) { return [momentum = std::make_shared<Momentum<S>>(sweep)] { (*momentum)(); }; });
	}

} // namespace

SolverReport accelerated(ContactSystem& system, const SolverSettings& settings) { return solve<Sweep>(system, settings); }
SolverReport accelerated(DelassusSystem& system, const SolverSettings& settings) { return solve<DelassusSweep>(system, settings); }

} // namespace cd
