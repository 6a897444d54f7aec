// Computes how far a solution misses the contact law, from the impulses and the free velocities alone: it adds up the velocities anew. The sweeps'
// own test (sweep_error.cpp) shares the formula of one contact; tests/core/test_problem.py compares both with the definition, in NumPy.
//
// There are two measures, compared with the same tolerance:
//
// The error e of the contacts: how far the impulses are from the contact law, relative to all impulses.
//   e = ||p - P_K(p - (u + bias n + mu |u_t| n)/W_nn)||_2 / ||p||_2
// With stiffnesses, W + C takes the place of W_nn and u has what the springs yield (contact_system.hpp).
// K is Coulomb's cone, P_K the Euclidean projection on it; mu |u_t| n is De Saxce's term, which makes the zero of this error the exact,
// non-associated Coulomb law with Signorini's condition (Acary, Bremond & Huber 2018, hal-01630836, section 2).
//
// The error of the bodies: how wrong their velocity changes may be, relative to what acts on each. e does not see a single body: where a disk of 1 kg
// carries one of 1e8 kg, impulses that let the heavy disk fall freely differ from the law by 1e-8 of themselves. A contact misses the velocity
//   g = W_nn |p - P_K(...)| [m/s],
// and the velocity s = (sum of the magnitudes of its contacts' impulses, and of its external one)/m acts on a body. The error of an
// island's bodies is estimated as
//   min( sqrt(N) ||g||_2 / min s,  max(rms g / S', max g / (10 S'), max g' / (10 s')) ),
//   S = (sum m sqrt(s) / sum m)^2,   S' = S min(1, l/200),   l = contacts - bodies.
// s' is the s of a body ten times heavier than one that it touches, g' the g of the contacts of this lighter body.
// The first number holds for every body of a column: the misses of its N contacts add up to at most sqrt(N) ||g||_2 (Cauchy and Schwarz), and the
// body with the smallest s may feel all of it. If contacts at small angles to each other hold a body, its error is larger by one over the sine of the
// angle, which is not counted. A packing always has disks that carry next to nothing, and its impulses are not determined: to make the first number
// small would take a hundred times as many sweeps (400 disks, mu = 0.1, tolerance 1e-6: 9800 instead of 60). There, where the contacts make many
// loops (l), the second number serves: relative to the mean over the mass, so that a heavy body counts by its mass. A body with s far below S may be
// wrong by S/s times as much. The term with g' and s' prevents this for the heavier bodies; it is used if the smallest s' is below 0.1 S. s counts as
// at least a millionth of S. Where nothing acts on any body of an island, but a contact misses its law, the error is infinite: all of the velocity
// change is missing. Impulses are known to their round-off, which is an error of the bodies, too: at least 2e-16 r under a disk r times as heavy.
#pragma once

#include "problem/problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cd {

struct Residual {
	double norm = 0; // e
	double energy = 0; // the same with every contact weighted by its W_nn: a heavy body's impulses then do not hide a light body's error
	double maximum = 0; // the largest |p - P_K(...)| of one contact over the root mean square of p
	double difference = 0, impulse = 0; // the norms whose ratio is e: ||p - P_K(...)||_2 and ||p||_2 [N s]
	double work = 0; // sum of W_nn |p|^2 over the contacts [J]
	double bodies = 0; // the error of the bodies, the largest of all islands
	bool stale = false; // whether a contact has an impulse of which its own law would take half or more
	int32_t body = -1; // the body with the smallest s, in the island with the largest error; -1: none

	double law() const { return norm < energy ? energy : norm; } // of the contacts
	double error() const { return law() < bodies ? bodies : law(); } // compared with the tolerance
};

// What an island of contacts adds to the error of the whole.
struct ResidualSum {
	std::size_t contacts = 0;
	double difference = 0, square = 0; // |p - P_K(...)|^2 and |p|^2 [N^2 s^2]
	double differenceEnergy = 0, squareEnergy = 0; // the same, every contact weighted by its W_nn [J]
	double stale = 0; // |p|^2 of contacts whose own law would take half of p or more [N^2 s^2]
	double worst = 0; // largest |p - P_K(...)|^2 of a contact [N^2 s^2]
	double missed = 0, mostMissed = 0; // g^2: sum and largest [m^2/s^2]
	double missedUnderHeavy = 0; // largest g^2 of the contacts of bodies that touch one ten times heavier [m^2/s^2]
	double leastHeavy = std::numeric_limits<double>::infinity(); // smallest s of such a heavier body [m/s]
	std::size_t touched = 0; // movable bodies
	double mass = 0, weighted = 0; // sums of m and m sqrt(s) over them
	double least = std::numeric_limits<double>::infinity(); // smallest s of a body on which anything acts [m/s]
	int32_t leastBody = -1;

	// Adds a contact; compliance: W_nn.
	template <class Impulse> void addContact(const Miss<double>& miss, const Impulse& p, double compliance)
	{
		contacts++;
		addTo(*this, miss, dot(p, p), compliance);
	}
	// Adds a movable body, on which s [m/s] acts; m: its mass, 0 if it can only turn.
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
	// Adds a contact that misses `velocity`, of a body that touches one ten times heavier on which s acts. Does nothing if s is infinite.
	void addUnderHeavy(double velocity, double s);

	void add(const ResidualSum&); // adds other contacts and bodies of the same island

	double bodies() const; // the error of the bodies
	Residual of() const;
};

// Calls f(light, heavy) for all touching bodies of which one is ten times heavier, if something passes through their contact.
template <class Space, class F> void forEachHeavyOnLight(const ContactSystem<Space>& system, const F& f)
{
	constexpr double heavier = 10; // mass ratio from which a body is no longer one among many similar ones
	for (const ContactRow<Space>& c : system.contacts) {
		if (!(c.wnn > 0))
			continue;
		const double a = inverseMass(system.bodies[c.a]), b = inverseMass(system.bodies[c.b]);
		if (b > 0 && a >= heavier * b)
			f(c.a, c.b);
		else if (a > 0 && b >= heavier * a)
			f(c.b, c.a);
	}
}

// The error of several islands: from the sums over their contacts and the largest error of their bodies.
Residual residual(const ResidualSum* islands, std::size_t count);

// freeVelocity: the bodies' velocities without any contact impulse, the freedoms of each.
// Recomputes the velocities from the impulses, without reading those in `system.bodies`, and W_nn from the masses. A difference below the round-off
// of the velocities, which are sums, does not count. Without any impulse e is 0 if no contact is violated, else infinite. Costs as much as thirty
// sweeps; the methods call Sweep::error() instead.
template <class Space> Residual residual(const ContactSystem<Space>&, const std::vector<double>& freeVelocity);

// Adds the same for every island of a system to `sums`, one an island. Contact i belongs to the island islandOf[i], to none if that is negative.
// numbers: how to name the bodies; null: by their place in the system.
template <class Space>
void addResiduals(const ContactSystem<Space>&, const std::vector<double>& freeVelocity, const std::vector<int32_t>& islandOf,
    std::vector<ResidualSum>& sums, const int32_t* numbers = nullptr);

// The same for the impulses in `system`, with u = W p + q. The error of the bodies is not known here and set to 0. Costs about a sweep.
Residual residual(const DelassusSystem& system);
Residual residual(const ConeSystem& system);

} // namespace cd
