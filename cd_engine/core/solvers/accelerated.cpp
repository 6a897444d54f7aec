// Gauss-Seidel sweeps with momentum: a sweep starts from the extrapolated point y = p + beta (p - q), where q, p are the last two iterates.
//
// beta follows Nesterov's sequence (Nesterov 1983; O'Donoghue & Candes 2015, "Adaptive restart for accelerated gradient schemes",
// eqs. 6-8). It restarts, as in their scheme, when a sweep turns back against the momentum. Friction makes the problem non-monotone, and momentum can
// diverge. beta is therefore capped. The cap is lowered whenever the changes by the sweeps do not decrease over a window, unless the iterate drifts,
// that is, moves straight on by the same change in each sweep. Frictional packings are hyperstatic: if residual gaps do not let all loaded contacts
// stay closed or sticking, the impulses move along a self-stress. This changes no velocity, and so no error, until a contact opens or slides, far
// away (1e4 to 1e6 plain sweeps, at errors from 1e-6 down). Momentum shortens such drifts. Elsewhere it may keep the error from falling; plain sweeps
// then take part (iterate.hpp). An iteration costs a sweep, 32 bytes a contact more, and a pass over the velocities. In
// the matrix form momentum is local (row_momentum.hpp).
//
// Alternatives tried on cold dense packings of 400 and 4000 disks, mu 0.1 and 0.5, none of them better (median sweeps to 1e-6 relative to this): a
// separate momentum for each block of 1024 or 256 contacts, 1.3 to 2.1 times (to 1e-4 0.8 to 1.0, but a second pass over the contacts); restart on a
// cosine above 0.1 or 0.2, 1.1 to 1.4 (to 1e-4 0.9); a random order, 2.5; one backward sweep after twenty forward sweeps, 0.9 to 1.1; jumps along the
// drift to the first, 5th or 20th contact that leaves its state, no gain (the drift ends sooner, but the next takes as long to show). If the cap is
// lowered in drifts, too, the sweeps stop at 1e-6 in two cases of three.
#include "matrix/matrix.hpp"
#include "solvers/iterate.hpp"
#include "solvers/start.hpp"
#include "sweeps/sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd {
namespace {

	template <class Sweep> class Momentum {
	    public:
		explicit Momentum(Sweep& s)
		    : sweep(s)
		    , highest(std::min(0.999, bestFor(s.yield())))
		    , cap(std::min(0.9, highest))
		{
		}

		void operator()()
		{
			const double beta = std::min(cap, (t - 1) / next(t));
			const AheadReport report = sweep.ahead(beta);
			t = report.against > 0 ? 1 : next(t);
			// p+ - p = (p+ - y) + beta (p - q), squared.
			advance = std::max(0., beta * beta * advance - 2 * report.against - report.change);
			now.add(report, advance);
			if (++made % window == 0)
				watch();
		}

		void restart() { t = 1; }
		bool mayPause() const { return !drifting; } // only momentum brings a drift to its end soon

	    private:
		static constexpr int window = 20; // sweeps over which the changes must decrease
		// The best constant beta where stiffnesses make W + C positive definite: the smallest eigenvalue is at least s, over the diagonal
		// (Nesterov 2004, Introductory Lectures on Convex Optimization, section 2.2.1).
		static double bestFor(double s) { return (1 - std::sqrt(s)) / (1 + std::sqrt(s)); }

		// Sums over the sweeps of one window.
		struct Window {
			double change = 0, largest = 0; // of |y - p+|: sum and maximum [N s]
			double changes = 0, advances = 0, along = 0; // sums of |y - p+|^2, |p+ - p|^2, (p+ - y) . (p+ - p) [N^2 s^2]

			void add(const AheadReport& report, double advance)
			{
				const double c = std::sqrt(report.change);
				change += c;
				largest = std::max(largest, c);
				changes += report.change;
				advances += advance;
				along -= report.against;
			}
			// Whether the sweeps move along the momentum.
			bool straight() const { return along > 0.8 * std::sqrt(changes * advances); }
		};

		static double next(double t) { return 0.5 * (1 + std::sqrt(1 + 4 * t * t)); }

		void watch()
		{
			// The limit may grow by 5 % a window, because each drift has its own pace.
			smallest = std::min(now.change, 1.05 * smallest);
			drifting = now.straight() && now.change <= 1.1 * smallest;
			const bool spike = now.largest > 4 * last.change / window;
			// Momentum does harm if a window is no better than the last one or contains a spike.
			const bool worse = spike || (now.change > 0.98 * last.change && !drifting);
			cap = worse && last.change > 0 ? std::max(0., 1 - 1.5 * (1 - cap)) : std::min(highest, 1 - 0.8 * (1 - cap));
			last = now;
			now = {};
		}

		Sweep& sweep;
		const double highest; // upper limit of the cap
		double t = 1, cap;
		double advance = 0; // |p+ - p|^2 of the last sweep [N^2 s^2]
		Window now, last;
		double smallest = std::numeric_limits<double>::infinity(); // smallest change in a window
		int made = 0;
		bool drifting = false; // in the last window
	};

	template <class S> struct RowMomentumSweeps : PlainSweeps<S> { // its groups restart one by one
		void operator()() { this->sweep.ahead(); }
	};

	// Momentum of groups can oscillate for ever: over W = 1 + 0.02, all entries, 1000 contacts, it stays at an error of 0.6, while plain sweeps
	// need 250. Plain sweeps are therefore tried, too. Both are compared at the same number of sweeps. The one with the smaller error goes on to
	// four times as many, then the other catches up to a new comparison. Where momentum leads, its path is the same to the last bit.
	template <class S> SolverReport compared(typename S::System& system, const SolverSettings& settings)
	{
		constexpr int share = 4, firstTrial = 100;
		const int all = settings.maxIterations;
		if (settings.fixedIterations > 0 || all <= firstTrial)
			return iterate<S, RowMomentumSweeps<S>>(system, settings);
		std::optional<Start> own;
		const Start& start = settings.start ? *settings.start : own.emplace(system, settings.threads);
		S withMomentum(system, settings.seed, settings.threads);
		RowMomentumSweeps<S> improve { { withMomentum } };
		Iteration<S> first(withMomentum, settings);
		first.begin();
		if (first.advance(improve, firstTrial, all))
			return first.conclude();
		start.free(system);
		start.guess(system);
		S sweep(system, settings.seed, settings.threads);
		PlainSweeps<S> plain { sweep };
		Iteration<S> second(sweep, settings);
		second.begin();
		const auto toFirst = [&](int until) { return first.advance(improve, until, all - second.iterations()); };
		const auto toSecond = [&](int until) { return second.advance(plain, until, all - first.iterations()); };
		const auto later = [&](const Iteration<S>& other) { return other.iterations() > all / share ? all : share * other.iterations(); };
		const auto end = [&](bool usesPlain) {
			SolverReport report = usesPlain ? second.conclude() : first.conclude();
			report.iterations = first.iterations() + second.iterations();
			report.plain = usesPlain;
			return report;
		};
		for (;;) {
			const bool plainEnded = toSecond(first.iterations()), plainLeads = second.solved() || second.least() < first.least();
			if (!plainLeads && plainEnded) {
				toFirst(all);
				return end(false);
			}
			if (plainEnded || (plainLeads ? toSecond(later(first)) : toFirst(later(second))))
				return end(plainLeads);
			if (plainLeads && toFirst(second.iterations())) {
				if (first.solved())
					return end(false);
				toSecond(all);
				return end(true);
			}
		}
	}

} // namespace

template <class Space> SolverReport accelerated(ContactSystem<Space>& system, const SolverSettings& settings)
{
	return iterate<Sweep<Space>, Momentum<Sweep<Space>>>(system, settings);
}
template SolverReport accelerated(ContactSystem<Plane>&, const SolverSettings&);
template SolverReport accelerated(ContactSystem<RollingPlane>&, const SolverSettings&);
template SolverReport accelerated(ContactSystem<Space3>&, const SolverSettings&);
SolverReport accelerated(DelassusSystem& system, const SolverSettings& settings) { return compared<DelassusSweep>(system, settings); }
SolverReport accelerated(ConeSystem& system, const SolverSettings& settings) { return compared<ConeSweep>(system, settings); }

} // namespace cd
