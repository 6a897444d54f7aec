"""Finds other admissible contact forces for grains that do not move (Unger, Kertesz and Wolf, PRL 94, 178001, 2005).

The contact forces of rigid grains at rest are not unique: force balance on every body, no tension, and Coulomb's cone |T| <= mu R admit a convex
set of networks. To find a point of this set, a random normal and a random tangential part are added to every contact force, and the sum is the
solver's first guess. A walk repeats this from the network just found. It does not sample the set uniformly.
"""
import random

import numpy as np
from yade import O, Vector3

from yade_scripts.running import bodies, hooks


class NetworkError(RuntimeError):
    """The solver did not find another admissible network."""


class Frozen:
    """The touching contacts of the sample in O, in the order of their ids, and the motion of its bodies, which `thaw` restores."""

    def __init__(self):
        contacts = bodies.contacts_by_id()
        # geom and phys are kept, since the engine removes them from a contact without force.
        self.contacts = [(i, i.geom, i.phys) for i in contacts]
        self.ids = np.array([(i.id1, i.id2) for i in contacts], int).reshape(-1, 2)
        self.motion = [(b.state, b.state.pos, b.state.ori, Vector3(b.state.vel), Vector3(b.state.angVel)) for b in O.bodies]

    def forces(self):
        """Return (R, T) [N] of every contact in the scene, with the signs of results/schema.py; 0 for a contact without force."""
        found = np.zeros((2, len(self.contacts)))
        for k, (contact, _, _) in enumerate(self.contacts):
            if contact.isReal:
                found[:, k] = contact.phys.normalForce.dot(contact.geom.normal), bodies.tangential_force(contact)
        return found

    def impose(self, normal, tangential):
        """Set (R, T) [N] of the contacts, the first guess of the next step. Tensile forces are set to zero."""
        for (contact, geom, phys), pressure, along in zip(self.contacts, normal, tangential):
            contact.geom, contact.phys = geom, phys
            n, loaded = geom.normal, pressure > 0
            phys.normalForce = n * (pressure if loaded else 0.0)
            phys.shearForce = Vector3(-n[1], n[0], 0) * (along if loaded else 0.0)

    def perturb(self, rng, amplitude):
        """Add to every R and T a random number, uniform within +-amplitude <R>. <R> [N] is the mean normal force of the loaded contacts."""
        normal, tangential = self.forces()
        most = amplitude * normal[normal > 0].mean()
        self.impose(*([f + rng.uniform(-most, most) for f in forces] for forces in (normal, tangential)))

    def thaw(self):
        """Restore the position and the velocity of every body, bit by bit."""
        for state, position, orientation, velocity, spin in self.motion:
            state.pos, state.ori, state.vel, state.angVel = position, orientation, velocity, spin


class Walk:
    """A walk over the admissible networks of the sample in O. Each step of ContactDynamics perturbs the forces, solves, and restores the motion.

    After the run: normal, tangential [N], one array of the contacts' forces for each step; converged: whether that step met the tolerance.
    The walk starts from the forces in the scene. With cold_first, one step from zero forces precedes it and gives the network of the solver alone.
    """

    def __init__(self, seed, amplitude, cold_first=False):
        self.frozen, self.rng, self.amplitude = Frozen(), random.Random(seed), amplitude
        self.start, self.cold = self.frozen.forces(), cold_first
        self.normal, self.tangential, self.converged = [], [], []

    def surround(self):
        """Add to O.engines a runner that perturbs before forces are reset, and one at the end that reads the forces and restores the motion."""
        self.engine = hooks.engine("ContactDynamics")
        engines = O.engines
        reset = next(k for k, engine in enumerate(engines) if type(engine).__name__ == "ForceResetter")
        O.engines = (engines[:reset] + [hooks.runner(self._perturb, iterPeriod=1, initRun=True)] + engines[reset:]
                     + [hooks.runner(self._take, iterPeriod=1, initRun=True)])

    def _perturb(self):
        steps = len(self.converged)
        if steps == 0 and self.cold:
            self.frozen.impose(*np.zeros_like(self.start))
            return
        if steps == self.cold:
            self.frozen.impose(*self.start)
        self.frozen.perturb(self.rng, self.amplitude)

    def _take(self):
        normal, tangential = self.frozen.forces()
        self.normal.append(normal)
        self.tangential.append(tangential)
        self.converged.append(self.engine.converged)
        self.frozen.thaw()


def replace(seed, amplitude):
    """Replace the contact forces of the sample in O by another admissible network, in one step of CD, whose engines must be set; then remove the
    engines. Raise NetworkError if the solver finds none."""
    walk = Walk(seed, amplitude)
    walk.surround()
    hooks.simulate(1)
    if not walk.converged[-1]:
        raise NetworkError(f"network_seed = {seed}: no admissible network found, error {walk.engine.residual:.1e} after {walk.engine.iterations} "
                           f"sweeps ({walk.engine.status}), tolerance {walk.engine.tolerance:g}; raise max_iterations or take another seed")
    O.engines = []
    O.resetTime()
