// Which islands of contacts sleep: those proven to be at rest, for which nothing has changed since.
//
// A first guess within the tolerance is no rest. It leaves velocities of the tolerance's size, and impulses held fast are dead loads, under which
// a packing is unstable: in one of 400 disks the error grows by a factor of 1.15 a step, from 1e-11 to 1e-6 in 80 steps, and some sweeps have to
// bring it down again and again. Therefore islands that are slow under constant loads have to prove their rest now and then: a step is solved by
// sweeps to a thousandth of the tolerance, and to less where that does not do, since the error is a norm of the whole. Where every body comes to rest
// in it, slower than a hundredth of what an error of the tolerance in its own contacts' impulses would leave, the velocities become zero. What rolls
// or drifts goes on in such a step, and so is not stopped. What moved before that step is tried again in the next, in which nothing has to be
// stopped, so that the impulses are those of rest. An island in which
// nothing moves before a step, and whose impulses are found to keep it so, to a hundredth of the tolerance, sleeps: it is not solved again. Forces
// smaller than that may be lost. Which islands sleep follows from velocities, impulses and what the engine saves, so that a saved scene goes on
// alike. Those in which nothing changes at all are then not even looked at (sleepers.hpp).
#pragma once

#include "contact_system.hpp"

#include <cstdint>
#include <vector>

namespace cd {

class Sleepers;

// Of what forces add to a body's velocity in a step.
int fingerprint(const double gained[3]);

// What a step has to say of rest; without it nothing sleeps.
struct Stillness {
	Sleepers& sleepers; // those that the system is without, and those found asleep in it
	const std::vector<double>& before; // the bodies' velocities before the step, three a body
	int trial; // sweeps that slow islands may take to prove their rest in this step; 0: they are not asked
	// Fingerprints of the bodies' loads in this step and the one before, looked at in a trial only; where none are known, nothing is tried.
	const std::vector<int>&loads, &loadsBefore;
};

// Twice the kinetic energy [J]; infinite where a body that nothing can stop moves.
double motion(const BodyVelocity&);

} // namespace cd
