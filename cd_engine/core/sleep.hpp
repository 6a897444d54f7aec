// Which islands of contacts sleep: those that are proven to be at rest and in which nothing has changed since.
//
// A first guess within the tolerance is not rest. It leaves velocities of the size of the tolerance. Impulses that never change are dead loads, under
// which a packing is unstable: in one of 400 disks the error grows by a factor of 1.15 a step, from 1e-11 to 1e-6 in 80 steps, and then some sweeps
// must reduce it. Islands that are slow under constant loads must therefore prove their rest now and then: sweeps solve one step to a thousandth of
// the tolerance, or less if that does not suffice, since the error is a norm of the whole. An island is at rest if each body is then slower than a
// hundredth of what an error of the tolerance in the impulses of its own contacts would cause. Its velocities are set to zero. Bodies that roll or
// drift keep moving in such a step, so they are not stopped. An island that moved before this step is tried again in the next one, in which nothing
// must be stopped, so that its impulses are those of rest. An island sleeps if nothing in it moves before a step and its impulses keep it so, to a
// hundredth of the tolerance. It is not solved again, and smaller forces may be lost. Which islands sleep follows from velocities, impulses and what
// the engine saves, so that a saved scene continues identically. Islands in which nothing changes at all are not even looked at (sleepers.hpp).
#pragma once

#include "contact_system.hpp"
#include "world.hpp"

#include <cstdint>
#include <vector>

namespace cd {

class Sleepers;

// A hash of the velocity that forces add to a body in a step: equal loads have equal hashes.
int fingerprint(const double gained[3]);

// What a step needs to know about rest; without it nothing sleeps.
struct Stillness {
	Sleepers& sleepers; // islands left out of the system, and islands found asleep in it
	const std::vector<Body>& before; // the bodies before the step
	int trial; // sweeps that slow islands may take to prove their rest in this step; 0: no trial
	// Hashes of the bodies' loads in this step and the one before. Read in a trial only; if those before are not known, there is no trial.
	const std::vector<int>&loads, &loadsBefore;
};

// Twice the kinetic energy [J]; infinite if a blocked freedom moves.
double motion(const BodyVelocity&);

} // namespace cd
