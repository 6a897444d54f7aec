// What a solution misses, computed by code that shares nothing with the solvers.
//
// Two measures, held against one tolerance:
//
// e, of the contacts: how far the impulses are from the contact law, relative to all impulses.
//   e = ||p - P_K(p - (u + bias n + mu |u_t| n)/W_nn)||_2 / ||p||_2
// K is Coulomb's cone, P_K the Euclidean projection on it; mu |u_t| n is De Saxce's term, which makes the zero of this error the exact,
// non-associated Coulomb law with Signorini's condition (Acary, Bremond & Huber 2018, hal-01630836, section 2).
//
// The error of the bodies: how far off their changes of velocity may be, relative to what acts on each. e does not see one body's: where a disk of
// 1 kg carries one of 1e8 kg, impulses that let the heavy disk fall freely differ from the law by 1e-8 of themselves. A contact misses the velocity
//   g = W_nn |p - P_K(...)| [m/s],
// and on a body acts the velocity s = (sum of the sizes of its contacts' impulses, and its external one)/m. The bodies of an island are right to
//   min( sqrt(N) ||g||_2 / min s,  max(rms g / S', max g / (10 S'), max g' / (10 s')) ),
//   S = (sum m sqrt(s) / sum m)^2,   S' = S min(1, l/200),   l = contacts - bodies.
// The first number holds for every body of a column: what its N contacts miss adds up to at most sqrt(N) ||g||_2 (Cauchy and Schwarz), and the body
// on which least acts may feel all of it. Where contacts at small angles to each other hold a body, its velocity is that over the sine of the angle,
// which this does not count. A packing always has disks that carry next to nothing, and to ask the first of it takes a hundred times the
// sweeps (400 disks, mu = 0.1, tolerance 1e-6: 9800 instead of 60), since its impulses are not determined. There, where the contacts make many loops
// (l), the second serves: relative to the mean over the mass, so that one heavy body counts for what it is. It does not see a body with s far below
// S: that may be wrong by S/s times as much, unless it is ten times heavier than what carries it: g' are the contacts of such carriers; where the
// smallest s' of what they carry is below 0.1 S, they have to serve that. s counts as a millionth of S at least. Impulses are known to their
// round-off, which is an error of the bodies, too: under a disk r times as heavy at least 2e-16 r.
#pragma once

#include "contact_system.hpp"
#include "delassus_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd {

struct Residual {
	double norm = 0; // e
	double energy = 0; // the same with every contact weighted by its W_nn: a light body's error is not drowned by a heavy one's impulses
	double maximum = 0; // the largest |p - P_K(...)| of one contact over the root mean square of p
	double difference = 0, impulse = 0; // the norms whose ratio is e: ||p - P_K(...)||_2 and ||p||_2 [N s]
	double bodies = 0; // the error of the bodies, of several islands the largest
	int32_t body = -1; // the body on which least acts, in the island of the largest; -1: none

	double law() const { return norm < energy ? energy : norm; } // of the contacts
	double error() const { return law() < bodies ? bodies : law(); } // what a tolerance is held against
};

// What an island of contacts adds to the error of the whole.
struct ResidualSum {
	std::size_t contacts = 0;
	double difference = 0, square = 0; // |p - P_K(...)|^2 and |p|^2 [N^2 s^2]
	double differenceEnergy = 0, squareEnergy = 0; // the same, every contact weighted by its W_nn [J]
	double worst = 0; // largest |p - P_K(...)|^2 of a contact [N^2 s^2]
	double missed = 0, mostMissed = 0; // g^2: sum and largest [m^2/s^2]
	double missedUnderHeavy = 0; // largest g^2 of the contacts of bodies that touch one ten times heavier [m^2/s^2]
	double leastHeavy = std::numeric_limits<double>::infinity(); // smallest s of such a heavier body [m/s]
	std::size_t touched = 0; // bodies that can move
	double mass = 0, weighted = 0; // sums of m and m sqrt(s) over them
	double least = std::numeric_limits<double>::infinity(); // smallest s of a body on which anything acts [m/s]
	int32_t leastBody = -1;

	// A contact that differs from its law by `difference` [N^2 s^2] and misses `velocity` [m^2/s^2], both squared; square: |p|^2, compliance:
	// W_nn.
	void addContact(double difference, double velocity, double square, double compliance);
	// A body that can move, on which s [m/s] acts; mass: 0 if it can only turn.
	void addBody(double m, double s, int32_t body)
	{
		touched++;
		if (s == 0)
			return;
		mass += m;
		weighted += m * std::sqrt(s);
		if (s < least) {
			least = s;
			leastBody = body;
		}
	}
	// A contact, missing `velocity`, of a body that touches one ten times heavier, on which s acts; nothing where s is infinite.
	void addUnderHeavy(double velocity, double s);

	void add(const ResidualSum&); // of other contacts and bodies of the island

	double bodies() const; // the error of the bodies
	Residual of() const;
};

// What a contact misses of its law, squared: of the impulse [N^2 s^2], of the velocity [m^2/s^2].
struct Miss {
	double difference, velocity;
};
// Of a body: its velocity after the impulses, and what acts on it [m/s].
struct alignas(32) Moved {
	double v[3];
	double s;
};
Miss missOf(const ContactRow&, double compliance, const Moved& a, const Moved& b);
// What a contact's impulse amounts to on a body with the inverse masses w and the arms n, t [m/s].
double actionOn(const double* w, const ContactRow&, double n, double t);

// For touching bodies of which one is ten times heavier: calls f(light, heavy).
template <class F> void forEachCarried(const ContactSystem& system, const F& f)
{
	constexpr double heavier = 10; // ratio of masses from which a body is no longer one among many like it
	for (const ContactRow& c : system.contacts) {
		const double *wa = system.bodies[c.a].w, *wb = system.bodies[c.b].w;
		const double a = std::max(wa[0], wa[1]), b = std::max(wb[0], wb[1]);
		if (b > 0 && a >= heavier * b)
			f(c.a, c.b);
		else if (a > 0 && b >= heavier * a)
			f(c.b, c.a);
	}
}

// The error of several islands: sums over their contacts, and the largest error of their bodies.
Residual residual(const ResidualSum* islands, std::size_t count);

// freeVelocity: the bodies' velocities without any contact impulse, three numbers a body [v_x, v_y, omega].
// The velocities are recomputed from the impulses (those in `system.bodies` are not read), W_nn from the masses. What is below the round-off of the
// sums that velocities are is no difference from the law. Without any impulse e is 0 if no contact is violated, else infinite.
// Costs thirty sweeps: the methods ask Sweep::error() instead.
Residual residual(const ContactSystem& system, const std::vector<double>& freeVelocity);

// The same of every island of a system: contact i belongs to the island islandOf[i], to none where that is negative. Adds to `sums`, one an island.
void addResiduals(
    const ContactSystem& system, const std::vector<double>& freeVelocity, const std::vector<int32_t>& islandOf, std::vector<ResidualSum>& sums);

// The same of the impulses in `system`, with u = W p + q; the error of the bodies, which it does not know, is 0. Costs about a sweep.
Residual residual(const DelassusSystem& system);

} // namespace cd
