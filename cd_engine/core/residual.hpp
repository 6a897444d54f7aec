// The error of a solution, computed by code that shares nothing with the solvers.
#pragma once

#include "contact_system.hpp"
#include "delassus_system.hpp"

namespace cd {

struct Residual {
	double norm; // ||p - P_K(p - (u + bias n + mu |u_t| n)/W_nn)||_2 / ||p||_2 over all contacts
	double energy; // the same as norm with every contact weighted by its W_nn: a light body's error is not drowned by a heavy one's impulses
	double maximum; // the largest such difference of one contact over the root mean square of p
	double difference, impulse; // the norms whose ratio `norm` is, ||p - P_K(...)||_2 and ||p||_2 [N s]

	double error() const { return norm < energy ? energy : norm; } // what a tolerance is held against
};

// What the contacts of a part of a system add to its error; sums of parts are the sum of the whole.
struct ResidualSum {
	double difference = 0, square = 0; // |p - P_K(...)|^2 and |p|^2 [N^2 s^2]
	double differenceEnergy = 0, squareEnergy = 0; // the same, every contact weighted by its W_nn [J]
	double worst = 0; // largest |p - P_K(...)|^2 of a contact [N^2 s^2]

	void operator+=(const ResidualSum&);
	Residual of(std::size_t contacts) const;
};

// freeVelocity: the bodies' velocities without any contact impulse, three numbers a body [v_x, v_y, omega].
// The velocities are recomputed from the impulses (those in `system.bodies` are not read), W_nn from the masses.
// K is Coulomb's cone, P_K the Euclidean projection on it; mu |u_t| n is De Saxce's term, which makes the zero of this
// error the exact, non-associated Coulomb law with Signorini's condition (Acary, Bremond & Huber 2018, hal-01630836, section 2).
// Differences below the round-off of the velocities count as none. Without any impulse the error is 0 if no contact is violated, else infinite. Costs
// about two sweeps.
Residual residual(const ContactSystem& system, const std::vector<double>& freeVelocity);

// The same of every part of a system: contact i belongs to the part partOf[i], to none where that is negative. Adds to `sums`, one a part.
void addResiduals(
    const ContactSystem& system, const std::vector<double>& freeVelocity, const std::vector<int32_t>& partOf, std::vector<ResidualSum>& sums);

// The same of the impulses in `system`, with u = W p + q. Costs about a sweep.
Residual residual(const DelassusSystem& system);

} // namespace cd
