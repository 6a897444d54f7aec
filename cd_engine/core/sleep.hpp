// Which islands of contacts sleep: those proven to be at rest, for which nothing has changed since.
//
// A first guess within the tolerance is no rest. It leaves velocities of the tolerance's size, and impulses held fast are dead loads, under which
// a packing is unstable: in one of 400 disks the error grows by a factor of 1.15 a step, from 1e-11 to 1e-6 in 80 steps, and some sweeps have to
// bring it down again and again. Therefore islands that are slow under constant loads have to prove their rest now and then: a step is solved by
// sweeps to a thousandth of the tolerance, if that takes no more than a few for each step since the last trial. Where every body comes to rest in it,
// slower than a hundredth of what an error of the tolerance in its own contacts' impulses would leave, the velocities become zero. What rolls or
// drifts goes on in such a step, and so is not stopped. The impulses are those of the same step without velocities before it. An island whose
// velocities are all zero before a step, and whose impulses are found to keep them so, sleeps: as long as its contacts, the tolerance, and the loads
// of all bodies are the same to the last bit, so is its solution, and is not even looked at. What may be lost are forces below a hundredth of the
// tolerance. What sleeps follows from velocities, impulses and what the engine saves, so that a saved scene goes on alike.
#pragma once

#include "contact_system.hpp"

#include <cstdint>
#include <vector>

namespace cd {

// The bits of a number; of 0 and -0 the same.
uint64_t bitsOf(double);

// What a step has to say of rest; without it nothing sleeps.
struct Stillness {
	const std::vector<double>& before; // the bodies' velocities before the step, three a body
	bool sameLoads; // whether every body has the load that it had in the step before
	int trial; // sweeps that slow islands may take to prove their rest in this step; 0: they are not asked
};

// Of every bit of a contact's row, the first guess to seven digits, and of its bodies' velocities without impulses. The sum over the contacts of
// an island does not depend on their order.
uint64_t fingerprint(const ContactRow&, const double* freeA, const double* freeB);

// Twice the kinetic energy [J]; infinite where a body that nothing can stop moves.
double motion(const BodyVelocity&);

} // namespace cd
