#include "solvability/verdict.hpp"

#include "solvability/problem_form.hpp"
#include "error/error.hpp"
#include "base/base.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cd {
namespace {

	constexpr double epsilon = std::numeric_limits<double>::epsilon();
	// In a press the power of closing contacts is at least this share of the power of all misses: 1, less the effect of friction and other
	// contacts. In flows, where as many loaded contacts part as close, it is 0.1 on average.
	constexpr double ofKept = 0.4;
	constexpr double drowned = 1; // growth times tolerance from which the tolerance allows errors as large as the velocities to be stopped
	constexpr double least = 1; // growth from which impulses are looked at
	constexpr double dragged = 30; // growth above which sliding friction that gives power may be the press; in flows it often gives some
	constexpr double onCone = 1e-6; // relative to the friction cone: an impulse this close to it slides
	constexpr double kernel = 1e-3; // share of the impulses that a self-stress along them must have
	// The velocities of a self-stress are only the round-off of their sums.
	constexpr double selfStress = 256 * epsilon;
	constexpr double mayHide = 10; // growth above which impulses within the tolerance may hide a press of ten tolerances
	constexpr int few = 256; // contacts up to which the proof by velocities may take more products than the sweeps did
	constexpr int rounds = 20; // at most; in each, contacts leave the self-stress or begin to slide in it

	double dot(const std::vector<double>& a, const std::vector<double>& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.); }

	template <class Form> double growthOf(const Form& form)
	{
		double square = 0, alone = 0;
		for (std::size_t i = 0; i < form.contacts(); i++) {
			const double closing = std::min(form.q[2 * i], 0.);
			square += form.own(i) * (form.pn(i) * form.pn(i) + form.pt(i) * form.pt(i));
			alone += closing * closing / form.own(i);
		}
		return alone > 0 ? std::sqrt(square / alone) : 0;
	}

	template <class Form> class Judgement {
	    public:
		Verdict operator()(const Form& judged, double guess, double tolerance, int mostProducts)
		{
			productsLeft = mostProducts;
			form = &judged;
			n = judged.contacts();
			negative = false;
			p.resize(2 * n);
			for (std::size_t i = 0; i < n; i++) {
				p[2 * i] = form->pn(i);
				p[2 * i + 1] = form->pt(i);
				if (!std::isfinite(p[2 * i]) || !std::isfinite(p[2 * i + 1]))
					return { Finding::not_finite, form->row(i), std::numeric_limits<double>::infinity() };
			}
			const int32_t infinite = addUp();
			if (infinite >= 0)
				return { Finding::not_finite, infinite, std::numeric_limits<double>::infinity() };
			Verdict v;
			v.growth = growthOf(*form);
			v.closing = acting > 0 ? fastest / acting : 0;
			const bool more = std::sqrt(square) > 10 * guess,
				   grown = more && v.growth > mostOfEqual && v.growth > std::min(mostGrowth, mostOfEqual * form->massRatio());
			const bool doubted = grown || (more && v.growth * tolerance > drowned) || (v.growth > least && looksPressed(v.growth));
			if (!doubted && !(more && v.growth > Form::ofProof))
				return v;
			// In files with six digits, rounding gives a positive semidefinite W negative energies smaller than this.
			if (doubted && energy < -1e-5 * terms)
				v.finding = Finding::indefinite;
			else if (proven(doubted ? Form::ofTerms : std::max(Form::ofTerms, tolerance)))
				v.finding = Finding::no_solution;
			else if (doubted)
				v.finding = negative ? Finding::indefinite : grown ? Finding::beyond : Finding::doubtful;
			if (v.finding != Finding::nothing)
				v.contact = form->row(worst);
			return v;
		}

	    private:
		// Sums the powers of the impulses. Returns the row at which a number is not finite, or -1.
		int32_t addUp()
		{
			form->product(p, u, sizes);
			velocity.resize(2 * n);
			square = kept = closing = given = dragging = pushing = coming = energy = terms = fastest = acting = 0;
			double largest = -1, mostKept = 0;
			for (std::size_t i = 0; i < n; i++) {
				const double own = form->own(i), pn = p[2 * i], pt = p[2 * i + 1];
				const double strength = own * (pn * pn + pt * pt), un = velocity[2 * i] = u[2 * i] + form->q[2 * i];
				const double ut = velocity[2 * i + 1] = u[2 * i + 1] + form->q[2 * i + 1];
				if (!std::isfinite(un) || !std::isfinite(ut) || !std::isfinite(strength))
					return form->row(i);
				square += strength;
				fastest = std::max(fastest, -un);
				acting = std::max({ acting, -form->q[2 * i], std::abs(form->prescribed[2 * i]) });
				energy += pn * u[2 * i] + pt * u[2 * i + 1];
				terms += std::abs(pn) * sizes[2 * i] + std::abs(pt) * sizes[2 * i + 1];
				// At a sliding contact, the tangential power is friction's and does not count.
				const bool sticks = std::abs(pt) < (1 - onCone) * form->mu(i) * pn;
				const double moved = pn * form->prescribed[2 * i] + (sticks ? pt * form->prescribed[2 * i + 1] : 0);
				given -= moved;
				pushing += std::max(-moved, 0.);
				coming -= std::min(pn * form->prescribed[2 * i], 0.);
				closing -= pn * un + (sticks ? pt * ut : 0);
				dragging += sticks ? 0 : pt * (ut - form->prescribed[2 * i + 1]);
				const double floor = 16 * epsilon * (sizes[2 * i] + sizes[2 * i + 1] + form->data[i]);
				const double amiss = own * std::sqrt(squaredDifference(pn, pt, un, ut, form->mu(i), own)); // as in the error
				const double power = amiss > floor ? amiss * std::sqrt(pn * pn + pt * pt) : 0;
				kept += power;
				if (power > mostKept || (mostKept == 0 && strength > largest)) {
					mostKept = power;
					largest = strength;
					worst = i;
				}
			}
			return -1;
		}

		// Whether loaded contacts give way with the power of the prescribed motion. A press keeps all of this power, however exactly it is
		// solved. In a flow as many loaded contacts part as close, and the power that they keep falls with the error. A sliding boundary may
		// also give power by friction.
		bool looksPressed(double growth) const
		{
			const bool together = closing > ofKept * kept && closing > Form::ofPrescribed * pushing && closing < 2 * pushing;
			const double most = given + (growth > dragged && coming > 0 ? std::max(dragging, 0.) : 0);
			const bool all = closing > 0.5 * most && closing < 2 * most;
			return kept > 0 && (together || all);
		}

		enum class State : int8_t { open, stick, slidePlus, slideMinus };

		// Whether there is a self-stress along the impulses against which the prescribed motion works, by at least `share` of the terms of
		// this work.
		bool proven(double share)
		{
			root.resize(2 * n);
			state.resize(n);
			x.assign(2 * n, 0);
			double scale = 0;
			for (std::size_t i = 0; i < n; i++)
				scale = std::max(scale, std::sqrt(form->own(i)) * p[2 * i]);
			for (std::size_t i = 0; i < n; i++) {
				const double pn = p[2 * i], pt = p[2 * i + 1], bound = form->mu(i) * pn;
				root[2 * i] = std::sqrt(form->own(i));
				root[2 * i + 1] = std::sqrt(form->ownTangential(i));
				state[i] = State::stick;
				if (!(pn > 0))
					state[i] = State::open;
				else if (std::abs(pt) >= (1 - onCone) * bound)
					state[i] = pt > 0 ? State::slidePlus : State::slideMinus;
				x[2 * i] = pn * root[2 * i] / scale;
				x[2 * i + 1] = state[i] == State::stick ? pt * root[2 * i + 1] / scale : 0;
			}
			const double whole = dot(x, x);
			for (int k = 0; k < rounds; k++) {
				for (std::size_t i = 0; i < n; i++)
					if (state[i] == State::open)
						x[2 * i] = x[2 * i + 1] = 0;
				if (!removeWhatMoves() || !(dot(x, x) > kernel * kernel * whole))
					return false;
				if (!leaveTheCone())
					return worksAgainst(share);
			}
			return false;
		}

		// The impulses d of the unknowns x: x is d_n times the root of W_nn and, where a contact sticks, d_t times that of W_tt.
		void impulses(const std::vector<double>& from, std::vector<double>& d) const
		{
			d.assign(2 * n, 0);
			for (std::size_t i = 0; i < n; i++) {
				if (state[i] == State::open)
					continue;
				d[2 * i] = from[2 * i] / root[2 * i];
				d[2 * i + 1] = state[i] == State::stick ? from[2 * i + 1] / root[2 * i + 1] : slope(i) * d[2 * i];
			}
		}
		double slope(std::size_t i) const { return state[i] == State::slidePlus ? form->mu(i) : -form->mu(i); }

		// The velocities that the impulses of `from` cause, at the unknowns.
		void answer(const std::vector<double>& from, std::vector<double>& to)
		{
			impulses(from, d);
			form->product(d, u, sizes);
			to.assign(2 * n, 0);
			for (std::size_t i = 0; i < n; i++) {
				if (state[i] == State::open)
					continue;
				const bool stick = state[i] == State::stick;
				to[2 * i] = (u[2 * i] + (stick ? 0 : slope(i) * u[2 * i + 1])) / root[2 * i];
				to[2 * i + 1] = stick ? u[2 * i + 1] / root[2 * i + 1] : 0;
			}
		}

		// Conjugate gradients for W d = 0 from x keep what W maps to 0. They restart from exact residuals until these are round-off.
		bool removeWhatMoves()
		{
			for (int again = 0; again < 6; again++) {
				answer(x, r);
				for (double& e : r)
					e = -e;
				double rr = dot(r, r);
				const double goal = rr * 1e-20;
				if (rr <= selfStress * selfStress * 1e-4 * dot(x, x))
					return true;
				along = r;
				while (rr > goal && rr > 1e-34 * dot(x, x)) {
					if (productsLeft-- <= 0)
						return false;
					answer(along, w);
					const double curvature = dot(along, w);
					if (curvature < -1e-5 * dot(along, along))
						return !(negative = true);
					if (!(curvature > 1e-13 * dot(along, along)))
						break; // nothing but round-off is left
					const double step = rr / curvature;
					for (std::size_t i = 0; i < x.size(); i++) {
						x[i] += step * along[i];
						r[i] -= step * w[i];
					}
					const double next = dot(r, r);
					for (std::size_t i = 0; i < x.size(); i++)
						along[i] = r[i] + next / rr * along[i];
					rr = next;
				}
			}
			return true;
		}

		// Opens contacts that now pull, and lets contacts beyond the friction cone slide. Returns whether there were any.
		bool leaveTheCone()
		{
			double largest = 0;
			for (std::size_t i = 0; i < n; i++)
				largest = std::max(largest, x[2 * i]);
			bool changed = false;
			for (std::size_t i = 0; i < n; i++) {
				if (state[i] == State::open)
					continue;
				// A value that is round-off beside the others is no part of the self-stress.
				if (x[2 * i] < 1e-11 * largest) {
					changed = changed || x[2 * i] != 0 || x[2 * i + 1] != 0;
					state[i] = State::open;
				} else if (state[i] == State::stick
				    && std::abs(x[2 * i + 1]) * root[2 * i] > form->mu(i) * x[2 * i] * root[2 * i + 1] * (1 + 1e-12)) {
					state[i] = x[2 * i + 1] > 0 ? State::slidePlus : State::slideMinus;
					x[2 * i + 1] = 0;
					changed = true;
				}
			}
			return changed;
		}

		// Whether the prescribed motion works against the self-stress x, and the contacts of x give way to it. Sliding does not count,
		// because a solution may slide, too.
		bool worksAgainst(double share)
		{
			impulses(x, d);
			form->product(d, u, sizes);
			double work = 0, givingWay = 0, terms = 0, stress = 0, moved = 0;
			for (std::size_t i = 0; i < n; i++) {
				const bool sticks = state[i] == State::stick;
				givingWay += d[2 * i] * velocity[2 * i] + (sticks ? d[2 * i + 1] * velocity[2 * i + 1] : 0);
				work += d[2 * i] * form->prescribed[2 * i] + (sticks ? d[2 * i + 1] * form->prescribed[2 * i + 1] : 0);
				terms += (std::abs(d[2 * i]) + std::abs(d[2 * i + 1])) * form->data[i];
				const double nn = form->own(i), tt = form->ownTangential(i);
				stress += sizes[2 * i] * sizes[2 * i] / nn + sizes[2 * i + 1] * sizes[2 * i + 1] / tt;
				moved += u[2 * i] * u[2 * i] / nn + u[2 * i + 1] * u[2 * i + 1] / tt;
			}
			return stress > 0 && moved <= selfStress * selfStress * stress && work < -share * terms && givingWay < 0.5 * work;
		}

		const Form* form = nullptr;
		std::size_t n = 0;
		double square = 0; // weighted |p|^2 [J]
		double kept = 0; // power of what the contacts miss of their law; like all powers here, impulse times velocity [J]
		double closing = 0; // net power of loaded contacts that close, and of sticking ones that slide [J]
		double given = 0,
		       pushing = 0; // power of the prescribed motion: net, and only of the contacts at which it opposes the impulses [J]
		double coming = 0; // power of approaching boundaries and biases against the normal impulses [J]
		double dragging = 0; // friction power of sliding contacts, by the motion of the bodies there [J]
		double fastest = 0,
		       acting = 0; // normal velocities: the fastest closing; the largest prescribed one or closing without impulses [m/s]
		double energy = 0, terms = 0; // p . W p, and the sum of the sizes of its terms
		std::size_t worst = 0; // contact with the largest missed power, or with the largest impulse
		std::vector<double> p, u, sizes;
		std::vector<double> velocity; // of the contacts, from the judged impulses, with the biases [m/s]
		std::vector<State> state;
		std::vector<double> root; // of W_nn and W_tt
		std::vector<double> x, r, along, w, d;
		int productsLeft = 0;
		bool negative = false; // a direction of negative energy was met
	};

} // namespace

Verdict judge(const ContactSystem& system, const std::vector<double>& freeVelocity, double guess, double tolerance, int mostProducts)
{
	const Borrowed<BodyForm> form(system.memory);
	Verdict v = (*Borrowed<Judgement<BodyForm>>(system.memory))(form->of(system, freeVelocity), guess, tolerance, mostProducts);
	const bool open = v.finding == Finding::nothing || v.finding == Finding::doubtful || v.finding == Finding::beyond;
	if (open && v.growth > mayHide) {
		const int contacts = static_cast<int>(system.contacts.size());
		const int most = contacts > few ? mostProducts : std::max(mostProducts, 32 * contacts);
		const int contact = closingIn(system, freeVelocity, tolerance, mostOfEqual, most);
		if (contact >= 0)
			v = { Finding::no_solution, contact, v.growth };
	}
	return v;
}
Verdict judge(const DelassusSystem& system, double guess, double tolerance, int mostProducts)
{
	const Borrowed<MatrixForm> form(system.memory);
	return (*Borrowed<Judgement<MatrixForm>>(system.memory))(form->of(system), guess, tolerance, mostProducts);
}

double growth(const ContactSystem& system, const std::vector<double>& freeVelocity)
{
	return growthOf(Borrowed<BodyForm>(system.memory)->of(system, freeVelocity));
}
double growth(const DelassusSystem& system) { return growthOf(Borrowed<MatrixForm>(system.memory)->of(system)); }

bool surelySolvable(const ContactSystem& system, Threads* threads)
{
	return !anyOf(threads, system.bodies.size(), [&](std::size_t i) { return isDriven(system.bodies[i]); })
	    && (system.contacts.postponed() // they push nothing
		|| !anyOf(threads, system.contacts.size(), [&](std::size_t i) { return !(system.contacts[i].bias >= 0); }));
}

} // namespace cd
