// Decides whether impulses within the tolerance can be a solution, and of an unsolved problem, whether a solution can exist.
//
// The error e is relative to the impulses. Two walls that close in on a body press it with impulses that grow without end while its contacts close as
// before: e falls below every tolerance, although nothing is solved. We call this a press. Its sign is the power p . u of the contact impulses. At a
// solution, loaded contacts do not close, and sticking ones do not slide, so p . u is only what friction dissipates; the errors of sweeps have either
// sign and mostly cancel. In a press all loaded contacts give way together, with the power that the prescribed motion puts in, however exactly the
// problem is solved. The prescribed motion is that of blocked degrees of freedom and the biases, without gravity, which has no power on impulses that
// balance each other. Boundaries that move together, as those of a drum, are judged as an observer sees them who moves along (rigid_motion.hpp).
// A loosely solved pile may look the same. A problem with doubtful impulses is therefore solved ten times more exactly, and again, until the doubt is
// gone or the bound on the work is reached. Impulses far larger than those that must stop something, as in a nearly straight column, hide velocities
// of many tolerances, so after a doubt the velocities of closing contacts count, too.
// The proof that no impulses solve a problem is a self-stress: impulses d inside the friction cones with W d = 0. If d . q < 0, then every p has
// d . u = d . (W p + q) = d . q < 0, which no contact law allows as long as nothing slides. (With friction, a motion in which contacts of d slide
// could be a solution. So the tangential power of contacts that slide in d does not count, and the contacts of d must together give way.)
// Conjugate gradients find d: from impulses that have grown along it they remove the part that causes velocities.
// Impulses may also be large because friction wedges bodies, and may hide the press of a slow boundary. If bodies and contacts are known, a second
// proof does without the impulses: it tests whether any velocities keep all contacts open (closing_in.cpp).
#pragma once

#include "problem/problem.hpp"
#include "base/base.hpp"

namespace cd {

enum class Finding {
	nothing, // nothing speaks against the impulses
	doubtful, // loaded contacts give way with the power of the prescribed motion: unsolved, or the tolerance is too large to tell
	beyond, // so large that double precision cannot resolve the velocities: the method diverges, or no solution is within every bound
	no_solution, // proven by a self-stress, or by velocities (closing_in.cpp)
	indefinite, // as one of the three before, but W gives the impulses, or some along them, a negative energy
	not_finite,
};

struct Verdict {
	Finding finding = Finding::nothing;
	int32_t contact = -1; // row of the system; of those that speak against the impulses the one with the most power, or with the largest impulse
	double growth = 0; // |p| relative to the impulses which would stop each closing contact alone, both weighted by W_nn
	double closing = 0; // fastest closing of a contact over the largest normal velocity that is prescribed or that closes one without impulses
};

// Judges the impulses in system.contacts. freeVelocity: as in residual.hpp. guess: |p| of the first guess weighted by W_nn, sqrt(sum W_nn |p|^2); a
// self-stress that was there before and now has nothing to carry is no sign of growth. tolerance: to which the impulses have been found. Costs about
// one look at the error. If the finding is not `nothing`, the proof may take up to mostProducts products with W more.
Verdict judge(const ContactSystem& system, const std::vector<double>& freeVelocity, double guess, double tolerance, int mostProducts = 1000);
Verdict judge(const DelassusSystem& system, double guess, double tolerance, int mostProducts = 1000);

// With a larger `growth`, round-off makes velocities wrong by a thousandth of those that the impulses must stop. A mass ratio of 1 : 1e8 makes 1e8.
// Among bodies of equal masses only a press makes more than mostOfEqual.
constexpr double mostGrowth = 1e12, mostOfEqual = 1e8;
// The growth alone, without a judgement.
double growth(const ContactSystem& system, const std::vector<double>& freeVelocity);
double growth(const DelassusSystem& system);

// Whether a blocked freedom of a body moves.
inline bool isDriven(const BodyVelocity& b)
{
	return (!(b.w[0] > 0) && b.v[0] != 0) || (!(b.w[1] > 0) && b.v[1] != 0) || (!(b.w[2] > 0) && b.v[2] != 0);
}
// Whether a motion is known that keeps every contact from overlapping further, so that a solution exists: if no blocked freedom moves and no bias is
// negative, zero velocities are such a motion. Costs a look at every body and contact.
bool surelySolvable(const ContactSystem& system, Threads* = nullptr);

// Also a proof (closing_in.cpp). Returns the row of the contact that must close most, if mostProducts products with J and J^T suffice to prove that
// there is no solution; else -1. freeVelocity: as in residual.hpp. The search begins at the velocities in system.bodies or at the rigid motion
// nearest to that of the boundaries. If contacts close there by less than three tolerances of the free and prescribed closing, it ends at once.
// Velocities beyond `bound` times the prescribed ones, both weighted by the masses, do not count as a solution.
int closingIn(const ContactSystem& system, const std::vector<double>& freeVelocity, double tolerance, double bound, int mostProducts);

} // namespace cd
