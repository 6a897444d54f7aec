// Which islands of contacts sleep: those proven to be at rest, for which nothing has changed since.
//
// A first guess within the tolerance is no rest. It leaves velocities of the tolerance's size, and impulses held fast are dead loads, under which
// a packing is unstable: in one of 400 disks the error grows by a factor of 1.15 a step, from 1e-11 to 1e-6 in 80 steps, and some sweeps have to
// bring it down again and again. Therefore slow islands have to prove their rest now and then: their problem, with all velocities before the step
// zero, is solved by sweeps to a thousandth of the tolerance, if that takes no more than a few for each step since the last trial. An island that
// this leaves without motion gets these impulses, and velocities of zero. One whose velocities are all zero before a step, and whose impulses are
// found to keep them so, sleeps: as long as its contacts and loads are the same to the last bit, so is its solution, and is not even looked at.
// Forces below a hundredth of the tolerance, and velocities of a few times the tolerance at one time, are what may be lost. What sleeps follows from
// velocities and impulses alone, so that a saved scene goes on alike.
#pragma once

#include "contact_system.hpp"

#include <cstdint>
#include <vector>

namespace cd {

// What a step has to say of rest; without it nothing sleeps.
struct Stillness {
	const std::vector<double>& before; // the bodies' velocities before the step, three a body
	int trial; // sweeps that slow islands may take to prove their rest in this step; 0: they are not asked
};

// Of every bit of a contact's row, the first guess to seven digits, and of its bodies' velocities without impulses. The sum over the contacts of
// an island does not depend on their order.
uint64_t fingerprint(const ContactRow&, const double* freeA, const double* freeB);

// Twice the kinetic energy [J]; infinite where a body that nothing can stop moves.
double motion(const BodyVelocity&);

} // namespace cd
