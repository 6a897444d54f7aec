// Whether impulses that are within the tolerance can be a solution, and of what is not solved, whether anything could solve it.
//
// The error e is relative to the impulses. Two walls that close in on a body press it with impulses that grow without end while its contacts close
// as before: e falls below every tolerance and nothing is solved. What gives it away is a power. At a solution loaded contacts neither close nor,
// where they stick, slide, and p . u is what friction dissipates; sweeps leave misses of either sign, which mostly cancel. In a press all loaded
// contacts give way together, with the power that the prescribed motion puts in, however exactly the problem is solved. Prescribed are the velocities
// of bodies that cannot move and the biases; gravity is not: it makes no power on impulses that hold each other.
// A loosely solved pile may look the same. A problem whose impulses are doubtful is therefore solved ten times more exactly, and again, until the
// doubt or the bound on the work is at its end.
//   The proof that no impulses solve it is a self-stress: impulses d within friction whose velocities W d vanish, with d . q < 0. Whatever p is,
// d . (W p + q) = d . q then stays negative, which no contact law allows as long as nothing slides. (With friction a motion in which contacts of d
// slide could be a solution all the same; so what counts is the part of d . q that is no sliding, and these contacts have to give way to it.)
//   From impulses that have grown along a self-stress it is found by removing from them, by conjugate gradients, what does make velocities.
// Impulses may also be large because friction wedges bodies, and hide what a slow boundary presses. Where bodies and contacts are known, a second
// proof does not use the impulses: it asks whether any velocities keep all contacts open (closing_in.hpp).
#pragma once

#include "contact_system.hpp"
#include "delassus_system.hpp"
#include "threads.hpp"

namespace cd {

enum class Finding {
	nothing, // that speaks against the impulses
	doubtful, // loaded contacts give way with the power of the prescribed motion: not solved, or the tolerance is too large to tell
	beyond, // so large that double precision cannot hold the velocities to anything: a method that diverges, or no solution within every bound
	no_solution, // proven by a self-stress
	indefinite, // W gives the impulses, or some along them, a negative energy; else one of the three before
	not_finite,
};

struct Verdict {
	Finding finding = Finding::nothing;
	int32_t contact = -1; // row of the system; of those that speak against the impulses the one with most power, or with the largest number
	double growth = 0; // |p| over that of the impulses which would stop each closing contact alone, both weighted by W_nn
};

// Judges the impulses in system.contacts. freeVelocity: as in residual.hpp. guess: |p| of the first guess weighted by W_nn, sqrt(sum W_nn |p|^2): a
// self-stress that was there before and now has nothing to carry is no sign of growth. Costs about a look at the error; where the finding is not
// `nothing`, up to mostProducts products with W for the proof, which is given up there. tolerance: to which the impulses have been found.
Verdict judge(const ContactSystem& system, const std::vector<double>& freeVelocity, double guess, double tolerance, int mostProducts = 1000);
Verdict judge(const DelassusSystem& system, double guess, double tolerance, int mostProducts = 1000);

// Impulses of a larger `growth` leave no velocity known to a thousandth of those that they are to stop. Masses in contact of 1 : 1e8 make 1e8.
// Among bodies of equal masses nothing but what presses makes more than mostOfEqual.
constexpr double mostGrowth = 1e12, mostOfEqual = 1e8;
// Alone, without a judgement.
double growth(const ContactSystem& system, const std::vector<double>& freeVelocity);
double growth(const DelassusSystem& system);

// The norm that `guess` is.
double weighted(const ContactSystem& system, Threads* = nullptr);
double weighted(const DelassusSystem& system, Threads* = nullptr);

// Whether a motion is at hand that holds every contact open or closed, so that a solution exists: all that cannot move is at rest and no bias
// asks for distance; then no velocity at all is one. Costs a look at every body and contact.
bool surelySolvable(const ContactSystem& system, Threads* = nullptr);
inline bool surelySolvable(const DelassusSystem&, Threads* = nullptr) { return false; } // a matrix does not tell

} // namespace cd
