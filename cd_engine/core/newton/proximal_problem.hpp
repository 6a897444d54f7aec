// One subproblem of the proximal-point method: the contact law between p and u + sigma D (p - pk). D is the diagonal of W, pk the centre.
//
// Eliminating p leaves one equation for the velocities,
//   u = W P(z) + q,   z = pk - u/(sigma D),   P(z) = (max(z_n, 0), z_t cut at +-mu max(z_n, 0)) (cutKeeping),
// which is piecewise linear: the states of the contacts select the piece (Alart & Curnier 1991, Comput. Methods Appl. Mech. Eng. 92, 353).
// Two methods solve it. Each of their steps solves the linear system of one piece:
//   Newton's method changes all states at once. For small sigma it cycles among pieces. Without friction the equation is the stationarity of a convex
//   function: the kinetic energy of v - v_free plus the energy of springs of compliance sigma D. A line search to where the slope of this function
//   vanishes converges from any start. With friction no such function exists, but the slope still guides the line search. A step that does not
//   descend is replaced by the step with fixed friction bounds, which always descends.
//   Path following reduces the residual of the equation in proportion, from piece to piece, changing one state at a time (Katzenelson 1965, Bell
//   Syst. Tech. J. 44, 1605). Where friction reverses the orientation of a piece, the path first turns back (Chien & Kuh 1977, IEEE Trans. Circuits
//   Syst. 24, 305). This method succeeds where Newton's method cycles, but takes many steps from a distant start.
#pragma once

#include "newton/newton_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd {

using Impulse = Components<double>;

// System: NewtonSystem of either kind.
template <class System> class ProximalProblem {
    public:
	// most: limit on the number of factorizations; work: limit on their floating-point operations
	ProximalProblem(System& s, int most, double work)
	    : system(s)
	    , mostSteps(most)
	    , mostWork(work)
	    , d(s.diagonal())
	{
	}

	// Sets the centre pk: two numbers a contact.
	void centre(const std::vector<double>& p)
	{
		at.pk = p;
		system.velocities(p, at.u);
		at.bounds.resize(system.size());
	}

	// Solves, starting at the centre. Returns false if this takes too many steps.
	bool solve(double sigma)
	{
		at.sigma = sigma;
		x = at.pk;
		u = uNew = at.u;
		at.states.assign(system.size(), ContactState::open);
		return newtonSteps(20, false) && remember();
	}

	// Solves for a smaller sigma, starting at the last solution about this centre.
	bool resume(double sigma)
	{
		at.sigma = sigma;
		at.states = solvedStates;
		if (exhausted() || !propose(true))
			return false;
		x = xNew;
		u = uNew;
		const std::vector<double> xStart = x, uStart = u;
		if (newtonSteps(12, true))
			return remember();
		x = xStart;
		u = uStart;
		return followPath(30) && remember();
	}

	const std::vector<double>& impulses() const { return x; } // result of the last attempt; inside the cone only if this attempt succeeded
	int steps() const { return made; } // factorizations
	bool exhausted() const { return made >= mostSteps || work >= mostWork; }

    private:
	// A border of a contact state: the state holds while n z_n + t z_t is positive. `beyond` is the state on the other side.
	struct Edge {
		double n, t;
		ContactState beyond;
	};

	bool remember()
	{
		solvedStates = at.states;
		return true;
	}

	// z of a contact after the share a of the step.
	Impulse point(std::size_t i, double a) const
	{
		const double un = u[2 * i] + a * (uNew[2 * i] - u[2 * i]), ut = u[2 * i + 1] + a * (uNew[2 * i + 1] - u[2 * i + 1]);
		return { at.pk[2 * i] - un / (at.sigma * d[2 * i]), at.pk[2 * i + 1] - ut / (at.sigma * d[2 * i + 1]) };
	}

	ContactState stateOf(const Impulse& z, double bound) const
	{
		if (!(z.n > 0))
			return ContactState::open;
		if (std::abs(z.t) < bound)
			return ContactState::stick;
		return z.t > 0 ? ContactState::slidePlus : ContactState::slideMinus;
	}

	double bound(std::size_t i, const Impulse& z) const { return system.friction(i) * std::max(z.n, 0.); }

	// Updates the states and bounds from u. Returns whether any state changed.
	bool findStates()
	{
		bool changed = false;
		for (std::size_t i = 0; i < system.size(); i++) {
			const Impulse z = point(i, 0);
			at.bounds[i] = bound(i, z);
			const ContactState state = stateOf(z, at.bounds[i]);
			changed = changed || state != at.states[i];
			at.states[i] = state;
		}
		return changed;
	}

	// Whether the step changes only the last digits of x. The sign of its slope then means nothing.
	bool stepIsRoundOff() const
	{
		double change = 0, size = 0;
		for (std::size_t k = 0; k < x.size(); k++) {
			change = std::max(change, std::abs(xNew[k] - x[k]));
			size = std::max(size, std::abs(x[k]));
		}
		return change <= 1e-12 * size;
	}

	// Whether the end of the step has the states that the step assumed. The end is then the solution.
	bool leadsToSolution() const
	{
		for (std::size_t i = 0; i < system.size(); i++) {
			const Impulse z = point(i, 1);
			if (stateOf(z, bound(i, z)) != at.states[i])
				return false;
		}
		return true;
	}

	// The slope (uNew - u) . (x - P) at the share a of the step; without friction it is the slope of the convex function.
	double slope(double a) const
	{
		double sum = 0;
		for (std::size_t i = 0; i < system.size(); i++) {
			const Impulse p = cutKeeping(point(i, a), system.friction(i));
			sum += (uNew[2 * i] - u[2 * i]) * (x[2 * i] + a * (xNew[2 * i] - x[2 * i]) - p.n);
			sum += (uNew[2 * i + 1] - u[2 * i + 1]) * (x[2 * i + 1] + a * (xNew[2 * i + 1] - x[2 * i + 1]) - p.t);
		}
		return sum;
	}

	// Solves the linear system of the present piece; the result goes to xNew and uNew. coupled: see Proximal.
	bool propose(bool coupled)
	{
		made++;
		at.coupled = coupled;
		const bool regular = system.solve(at, xNew);
		work += system.work();
		if (!regular)
			return false;
		system.velocities(xNew, uNew);
		return true;
	}

	void advance(double a)
	{
		for (std::size_t i = 0; i < x.size(); i++) {
			x[i] += a * (xNew[i] - x[i]);
			u[i] += a * (uNew[i] - u[i]);
		}
	}

	// The share of the step at which the slope, negative at 0, is below 1 % of its initial size; 1 if the slope at the end is not above that.
	double share(double atStart) const
	{
		const double enough = -0.01 * atStart;
		double low = 0, high = 1, slopeLow = atStart, slopeHigh = slope(1), a = 1;
		if (slopeHigh <= enough)
			return 1;
		for (int k = 1; k <= 12; k++) {
			// Regula falsi alone can crawl along a kink, so every third iterate is the midpoint.
			a = k % 3 == 0 ? 0.5 * (low + high) : low - slopeLow * (high - low) / (slopeHigh - slopeLow);
			const double s = slope(a);
			if (std::abs(s) < enough)
				break;
			(s < 0 ? low : high) = a;
			(s < 0 ? slopeLow : slopeHigh) = s;
		}
		return a;
	}

	// whole: x and u solve the system of the present states. They are the solution if these states do not change.
	bool newtonSteps(int most, bool whole)
	{
		for (int k = 0; k < most && !exhausted(); k++) {
			if (!findStates() && whole)
				return true;
			if (!propose(true))
				return false;
			if (stepIsRoundOff() && leadsToSolution()) {
				advance(1);
				return true;
			}
			if (slope(0) >= 0 && (exhausted() || !propose(false)))
				return false;
			const double start = slope(0), a = start < 0 ? share(start) : 1;
			whole = a == 1 && at.coupled;
			advance(a);
		}
		return !findStates() && whole;
	}

	// Writes the borders of the present state of a contact to e, two at most. Returns how many there are.
	int edges(std::size_t i, Edge* e) const
	{
		const double mu = system.friction(i), s = side(at.states[i]);
		switch (at.states[i]) {
		case ContactState::open:
			e[0] = { -1, 0, point(i, 0).t > 0 ? ContactState::slidePlus : ContactState::slideMinus };
			return 1;
		case ContactState::stick:
			e[0] = { mu, -1, ContactState::slidePlus };
			e[1] = { mu, 1, ContactState::slideMinus };
			return 2;
		default:
			e[0] = { 1, 0, ContactState::open };
			e[1] = { -mu, s, ContactState::stick };
			return mu > 0 ? 2 : 1;
		}
	}

	bool followPath(int most)
	{
		findStates();
		std::size_t crossing = 0;
		Edge crossed { 0, 0, ContactState::open };
		for (int k = 0; k < most && !exhausted(); k++) {
			if (!propose(true))
				return false;
			// Moves away from the border just crossed, on its new side. A backward move ends only at the next border.
			const double outward = k > 0 ? rate(crossing, crossed) : 0, direction = outward > 0 ? -1 : 1;
			double a = direction > 0 ? 1 : std::numeric_limits<double>::infinity();
			bool found = false;
			for (std::size_t i = 0; i < system.size(); i++) {
				const Impulse z = point(i, 0);
				Edge e[2];
				for (int n = edges(i, e) - 1; n >= 0; n--) {
					const double toward = -direction * rate(i, e[n]);
					const double reach = toward > 0 ? std::max(0., e[n].n * z.n + e[n].t * z.t) / toward : a;
					if (!(reach < a))
						continue;
					a = reach;
					crossing = i;
					crossed = e[n];
					found = true;
				}
			}
			if (!found && direction < 0)
				return false; // the path goes to infinity
			advance(direction * a);
			if (!found)
				return true;
			at.states[crossing] = crossed.beyond;
		}
		return false;
	}

	// The change of n z_n + t z_t of a contact over the whole step.
	double rate(std::size_t i, const Edge& e) const
	{
		const Impulse from = point(i, 0), to = point(i, 1);
		return e.n * (to.n - from.n) + e.t * (to.t - from.t);
	}

	System& system;
	const int mostSteps;
	const double mostWork;
	const std::vector<double>& d;
	int made = 0;
	double work = 0;
	Proximal at;
	std::vector<double> x, u, xNew, uNew; // the iterate x, u = W x + q, and the end of the proposed step
	std::vector<ContactState> solvedStates;
};

} // namespace cd
