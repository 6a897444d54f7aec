// The list of solvers. Each solves a problem by a method and judges the result (verdict.hpp).
#include "solvers/solver.hpp"
#include "solvers/start.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace cd {
namespace {

	// Factor on the tolerance to clear doubts. If there is a solution, the power that contacts keep falls with the tolerance; else it stays.
	constexpr double refinement = 0.1;
	constexpr double finest = 1e-15; // smallest tolerance; below is the round-off of a sum
	constexpr double stillGrowing = 3; // growth of impulses by a refinement that counts as still growing; in a press it is tenfold
	constexpr double mostClosing = 10; // tolerances by which Verdict::closing may exceed 0 once there has been a doubt
	constexpr double nearlySolved = 1e-2; // error up to which impulses found from zero are kept instead of those found from an unsolved step
	constexpr int fewSweeps = 64, fewProducts = 16;
	constexpr int sweepsToTell = 1000; // reserved for the question whether there is a solution; at most a tenth of all

	// A proof may cost about as much as the sweeps did, or as Newton's method does. One product with W costs about four sweeps.
	int productsAfter(int sweeps) { return 300 + sweeps / 4; }

	Verdict judge(const ContactSystem& s, const Start& start, double guess, double tolerance, int products)
	{
		return judge(s, start.freeVelocity(), guess, tolerance, products);
	}
	Verdict judge(const DelassusSystem& s, const Start&, double guess, double tolerance, int products)
	{
		return judge(s, guess, tolerance, products);
	}

	// Products with W for the first judgement, before there are doubts. A proof may cost about as much as the sweeps did.
	int productsBeforeDoubts(int sweeps) { return std::clamp(sweeps / 4, fewProducts, 64); }

	// The weighted norm of the first guess, if its step was solved, else 0.
	template <class System> double weightOfGuess(const System& s, const Start& start, const SolverSettings& settings)
	{
		return settings.guessSolved ? start.weight(s) : 0;
	}

	// Whether the impulses have more than doubled the kinetic energy although no boundary and no bias adds any. Impulses that balance each other
	// may be so large that all velocities they cause are within the tolerance.
	bool makesEnergy(ContactSystem& s, const Start& start, const SolverSettings& settings)
	{
		double more = 0; // twice the energy after them, less four times that before [J]
		for (std::size_t i = 0; i < s.bodies.size(); i++) {
			const double *v = s.bodies[i].v, *w = s.bodies[i].w, *free = &start.freeVelocity()[3 * i];
			const auto gained = [&](int k) { return w[k] > 0 ? v[k] * v[k] - 2 * free[k] * free[k] : 0; };
			more += w[0] == w[1] && w[0] > 0 ? (gained(0) + gained(1)) / w[0] : 0;
			for (int k = w[0] == w[1] ? 2 : 0; k < 3; k++)
				more += w[k] > 0 ? gained(k) / w[k] : 0;
		}
		if (!(more > 0))
			return false;
		s.contacts.make();
		return Start(s, settings.threads).weight(s) > 10 * weightOfGuess(s, start, settings); // the guess was in balance, to the tolerance
	}
	void makeRows(ContactSystem& s) { s.contacts.make(); }
	void makeRows(DelassusSystem&) { }

	bool makesEnergy(const DelassusSystem&, const Start&, const SolverSettings&) { return false; } // not called for a matrix

	int32_t strongest(const ContactSystem& s)
	{
		const auto most = [](const ContactRow& a, const ContactRow& b) { return a.pn < b.pn; };
		return static_cast<int32_t>(std::max_element(s.contacts.begin(), s.contacts.end(), most) - s.contacts.begin());
	}
	int32_t strongest(const DelassusSystem&) { return -1; }

	void clearImpulses(ContactSystem& s)
	{
		s.contacts.make();
		for (ContactRow& c : s.contacts)
			c.pn = c.pt = 0;
	}
	void clearImpulses(DelassusSystem& s) { std::fill(s.p.begin(), s.p.end(), 0.); }

	template <class System> using Method = SolverReport (*)(System&, const SolverSettings&);

	// Continues from the impulses in the system with `method`, with the iterations left of `settings.maxIterations`.
	template <class System>
	SolverReport goOn(System& system, const Start& start, SolverSettings settings, const SolverReport& before, Method<System> method)
	{
		settings.maxIterations -= before.iterations;
		start.free(system);
		SolverReport report = method(system, settings);
		report.iterations += before.iterations;
		report.factorizations += before.factorizations;
		return report;
	}

	// No method may fail where plain sweeps succeed. They do wherever W is positive definite and friction is not too large.
	template <class System>
	void tryPlain(System& system, const Start& start, const SolverSettings& settings, SolverReport& report, Method<System> method)
	{
		if (method == static_cast<Method<System>>(nsgs) || report.status != Status::stagnated || report.iterations >= settings.maxIterations)
			return;
		const Borrowed<System> copy(system.memory);
		System& other = *copy;
		other = system;
		start.guess(other);
		SolverReport plain = goOn<System>(other, start, settings, report, nsgs);
		report.iterations = plain.iterations;
		if (plain.status != Status::converged) {
			report.status = plain.status == Status::max_iterations ? plain.status : report.status; // more of them may help
			return;
		}
		plain.plain = true;
		report = plain;
		std::swap(system, other);
	}

	// Plain sweeps from zero impulses. They create no impulses that balance each other unless something presses.
	template <class System> void beginFromNothing(System& system, const Start& start, const SolverSettings& settings, SolverReport& report)
	{
		clearImpulses(system);
		report = goOn<System>(system, start, settings, report, nsgs);
		report.plain = true;
		if (report.status == Status::converged && makesEnergy(system, start, settings)) {
			report.status = Status::stagnated;
			report.contact = strongest(system);
		}
	}

	// A few sweeps from zero impulses may find a solution that the impulses of an unsolvable step hide. If not, restores the guess.
	template <class System> SolverReport tryFromNothing(System& system, const Start& start, const SolverSettings& settings, Method<System> method)
	{
		clearImpulses(system);
		const Start nothing(system, settings.threads);
		SolverSettings brief = settings;
		brief.start = &nothing;
		brief.maxIterations = std::min(fewSweeps, settings.maxIterations / 8);
		SolverReport report = method == static_cast<Method<System>>(nsgs) ? nsgs(system, brief) : accelerated(system, brief);
		if (report.status == Status::converged && judge(system, start, 0, settings.tolerance, fewProducts).finding == Finding::nothing)
			return report;
		report.status = Status::stagnated;
		start.free(system);
		start.guess(system);
		return report;
	}

	// Reports that there is no solution, if this is proven or if the impulses that count as solved exceed every bound. Returns whether it did.
	bool named(const Verdict& v, SolverReport& report)
	{
		const bool solved = report.status == Status::converged;
		if (v.finding == Finding::nothing || v.finding == Finding::doubtful || (v.finding == Finding::beyond && !solved))
			return false;
		report.contact = v.contact;
		report.status = v.finding == Finding::not_finite ? Status::diverged
		    : v.finding == Finding::indefinite		 ? Status::indefinite
								 : Status::no_solution;
		return true;
	}

	// The best impulses, which the report keeps, may be zero. Those of plain sweeps show whether the impulses grow.
	template <class System> void findOut(System& system, const Start& start, const SolverSettings& settings, SolverReport& report)
	{
		SolverSettings plain = settings;
		plain.start = &start;
		plain.fixedIterations = std::min(sweepsToTell, settings.maxIterations - report.iterations);
		if (plain.fixedIterations <= 0)
			return;
		const Borrowed<System> copy(system.memory);
		System& other = *copy;
		other = system;
		start.free(other);
		clearImpulses(other);
		report.iterations += nsgs(other, plain).iterations;
		const Verdict verdict = judge(other, start, 0, settings.tolerance, productsAfter(plain.fixedIterations));
		if (verdict.finding != Finding::not_finite) // plain sweeps may diverge where other methods do not
			named(verdict, report);
	}

	// Solves one problem by a method and judges its impulses.
	template <class System> class Judged {
	    public:
		Judged(System& problem, const SolverSettings& asked, Method<System> by)
		    : system(problem)
		    , settings(asked)
		    , method(by)
		    , start(problem, asked.threads)
		    , fixed(asked.fixedIterations > 0)
		    , solvable(start.solvable)
		    , part(asked)
		{
			part.start = &start;
			if (!solvable)
				makeRows(system);
			if (!solvable && !fixed)
				part.maxIterations -= std::min(sweepsToTell, settings.maxIterations / 10);
		}

		SolverReport operator()()
		{
			const int most = part.maxIterations;
			if (!solvable && !fixed && settings.guessPressed) {
				report = tryFromNothing(system, start, part, method);
				if (report.status == Status::converged)
					return report;
			}
			report = goOn<System>(system, start, part, report, method);
			tryPlain(system, start, part, report, method);
			if (solvable) {
				if (report.status == Status::converged && makesEnergy(system, start, settings)
				    && (report.iterations > 0
					|| weightOfGuess(system, start, settings) == 0)) // else the impulses are those that count as in balance
					beginFromNothing(system, start, settings, report);
				return report;
			}
			proofTried = triedAll = report.status != Status::converged;
			look();
			clearDoubts();
			if (settings.guessPressed && report.status == Status::converged && verdict.finding == Finding::nothing)
				confirm(most);
			return conclude();
		}

	    private:
		void look()
		{
			verdict = judge(system, start, weightOfGuess(system, start, settings), part.tolerance,
			    proofTried ? productsAfter(report.iterations) : productsBeforeDoubts(report.iterations));
		}
		bool doubtful() const { return report.status == Status::converged && verdict.finding == Finding::doubtful; }

		// An unsolved guess may be so large that any error is small beside it. The method must reach its result without it, too.
		void confirm(int most)
		{
			const Borrowed<System> copy(system.memory);
			System& found = *copy;
			found = system;
			const SolverReport before = report;
			start.free(system);
			clearImpulses(system);
			const Start nothing(system, settings.threads);
			part.start = &nothing;
			part.tolerance = settings.tolerance;
			part.maxIterations = most;
			report = goOn<System>(system, nothing, part, report, method);
			part.start = &start;
			look();
			clearDoubts();
			if (report.status == Status::converged && verdict.finding == Finding::nothing)
				return;
			if (report.error <= nearlySolved)
				return;
			const int iterations = report.iterations;
			std::swap(system, found);
			report = before;
			report.iterations = iterations;
			report.status = iterations < settings.maxIterations ? Status::stagnated : Status::max_iterations;
			verdict = { Finding::doubtful, strongest(system), verdict.growth };
		}

		// Solves to smaller tolerances as long as there are doubts. Most vanish after a few more sweeps, which cost less than a proof among
		// many contacts. So there is a look after twice as many sweeps, and again, and proofs are tried in earnest only once a tolerance is
		// reached or no sweeps are left. Newton's method waits until then, too.
		void clearDoubts()
		{
			constexpr auto newtonToo = static_cast<Method<System>>(automatic), sweeps = static_cast<Method<System>>(accelerated);
			double growth = 0; // of the impulses to the last tolerance reached; a few more sweeps let those of a press grow little
			for (bool reached = true; doubtful() && part.tolerance > finest && report.iterations < settings.maxIterations;) {
				if (reached)
					growth = verdict.growth;
				part.maxIterations = settings.maxIterations;
				if (!triedAll)
					part.maxIterations = std::min(part.maxIterations, report.iterations + std::max(fewSweeps, report.iterations));
				const bool last = part.maxIterations == settings.maxIterations;
				if (reached || last) // in the end, no sweeps are left to aim at one tolerance after the other
					part.tolerance = std::max(finest, refinement * part.tolerance);
				const bool withoutNewton = method == newtonToo && !last;
				report = goOn<System>(system, start, part, report, withoutNewton ? sweeps : method);
				reached = report.status == Status::converged;
				triedAll = last || report.status != Status::max_iterations;
				// Whether the method has more to try: only the sweeps granted so far have ended, or Newton's method has waited.
				const bool cut = !triedAll || (withoutNewton && report.status == Status::stagnated);
				proofTried = proofTried || triedAll || settings.guessPressed || report.iterations >= sweepsToTell;
				look();
				const bool grows = verdict.growth > stillGrowing * growth,
					   closes = verdict.closing > mostClosing * settings.tolerance;
				const bool interrupted = cut && report.error > settings.tolerance;
				if (verdict.finding == Finding::nothing && (grows || closes || interrupted))
					verdict.finding = Finding::doubtful;
				const bool goesOn = verdict.finding == Finding::nothing || (cut && verdict.finding == Finding::doubtful);
				if (goesOn && (cut || report.error <= settings.tolerance)) // the asked tolerance is met, or the loop goes on
					report.status = Status::converged;
			}
		}

		SolverReport conclude()
		{
			const bool doubted = verdict.finding == Finding::beyond || verdict.finding == Finding::doubtful;
			const bool cutShort = doubted && report.status == Status::max_iterations; // maybe by a smaller limit than asked
			if (cutShort || doubtful())
				report.status = report.iterations < settings.maxIterations ? Status::stagnated : Status::max_iterations;
			if (doubted)
				report.contact = verdict.contact;
			report.doubtful = fixed && doubted;
			if (!named(verdict, report) && !fixed && report.status != Status::converged)
				findOut(system, start, settings, report);
			return report;
		}

		System& system;
		const SolverSettings& settings;
		const Method<System> method;
		const Start start;
		const bool fixed, solvable;
		SolverSettings part; // settings of the next call of the method
		SolverReport report;
		Verdict verdict;
		bool proofTried = false, triedAll = false;
	};

	// A press leaves large impulses that balance each other. Where nothing presses any more, they would count as balanced although the velocities
	// that they cause, within the tolerance of such impulses, may be far larger than those in the scene.
	void forgetPress(ContactSystem& system, const SolverSettings& settings)
	{
		if (settings.guessPressed && settings.fixedIterations == 0 && surelySolvable(system, settings.threads))
			clearImpulses(system);
	}
	void forgetPress(DelassusSystem&, const SolverSettings&) { } // it comes without a step before

	template <class System, Method<System> method> SolverReport judged(System& system, const SolverSettings& settings)
	{
		forgetPress(system, settings);
		return Judged<System>(system, settings, method)();
	}

	struct Entry {
		const char* name = nullptr;
		Solver solver = nullptr;
		DelassusSolver delassusSolver = nullptr;
	};
	const Entry entries[] = {
		{ "nsgs", judged<ContactSystem, nsgs>, judged<DelassusSystem, nsgs> },
		{ "accelerated", judged<ContactSystem, accelerated>, judged<DelassusSystem, accelerated> },
		{ "newton", judged<ContactSystem, newton>, judged<DelassusSystem, newton> },
		{ "auto", judged<ContactSystem, automatic>, judged<DelassusSystem, automatic> },
	};

	const Entry& find(const std::string& method)
	{
		static const Entry none {};
		const auto found = std::find_if(std::begin(entries), std::end(entries), [&](const Entry& e) { return method == e.name; });
		return found != std::end(entries) ? *found : none;
	}

} // namespace

Solver findSolver(const std::string& method) { return find(method).solver; }
DelassusSolver findDelassusSolver(const std::string& method) { return find(method).delassusSolver; }

std::vector<std::string> solverNames()
{
	std::vector<std::string> names;
	for (const Entry& e : entries)
		names.emplace_back(e.name);
	return names;
}

std::string solvedBy(const std::string& method, const SolverReport& report)
{
	if (report.status != Status::converged)
		return "none";
	if (report.plain)
		return "nsgs";
	if (report.factorizations > 0)
		return "newton";
	return method == "newton" || method == "auto" ? "accelerated" : method; // both begin with these sweeps
}

const char* name(Status s)
{
	constexpr const char* names[] // in the order of the declaration
	    = { "converged", "fixed_iterations", "max_iterations", "stagnated", "diverged", "no_solution", "indefinite" };
	return names[static_cast<int>(s)];
}

} // namespace cd
