// Gauss-Seidel sweeps with momentum: a sweep from the point y = p + beta (p - q) ahead of the last two iterates q, p.
//
// beta follows Nesterov's sequence (Nesterov 1983; O'Donoghue & Candes 2015, "Adaptive restart for accelerated gradient schemes",
// eqs. 6-8), with their restart when the sweep turns back against the momentum. Friction makes the problem non-monotone, where
// momentum can blow up: beta is capped, and the cap lowered whenever the changes made by the sweeps do not decrease over a window.
// An iteration costs a sweep, 32 bytes a contact more, and a pass over the velocities. In the matrix form momentum is local (row_momentum.hpp).
#include "delassus_sweep.hpp"
#include "iterate.hpp"
#include "sweep.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace cd {
namespace {

	class Momentum {
	    public:
		explicit Momentum(Sweep& s)
		    : sweep(s)
		{
		}

		void operator()()
		{
			const AheadReport made = sweep.ahead(std::min(cap, (t - 1) / next(t)));
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

		Sweep& sweep;
		double t = 1, cap = 0.9;
		double sum = 0, lastSum = 0, largest = 0;
		int made = 0;
	};

} // namespace

SolverReport accelerated(ContactSystem& system, const SolverSettings& settings)
{
	return iterate<Sweep>(system, settings, [](Sweep& sweep) { return [momentum = std::make_shared<Momentum>(sweep)] { (*momentum)(); }; });
}

SolverReport accelerated(DelassusSystem& system, const SolverSettings& settings)
{
	return iterate<DelassusSweep>(system, settings, [](DelassusSweep& sweep) { return [&sweep] { sweep.ahead(); }; });
}

} // namespace cd
