"""Makes a dense packing of disks at rest under the load of its walls, and contact problems of its next step.

Radii are uniform in 0.30 .. 0.65 m, the density is 1 kg/m^2. Two walls are fixed; P = 1 N/m loads the other two, each of the mass of 2 sqrt(N)
disks. Springs without friction jam the disks (jammed.py). Contact Dynamics takes them over with their overlaps of 6e-4 m and brings them to rest in
steps of h = 0.01 sqrt(m/P), solved to SETTLED, with friction on disks and walls. Then each step loads wall y+ by 0.2 % of P more. The problem is
the tenth of these steps; its first guess is the solution of the ninth.
"""
import json
import math
import pathlib

import numpy as np
from yade import O
from yade.wrapper import FrictMat

import cd_engine
from cd_engine import failing
from yade_scripts.running import bodies, hooks, walls
from yade_scripts.measuring.benchmark.jammed import jammed

PRESSURE = 1.0      # [N/m]
RADII = 0.30, 0.65  # [m]
DEPTH = 1.0         # [m]
MORE = 0.002        # rise of the load of y+ in a step, over P
STEPS = 9           # loaded steps before the one that is the problem
SETTLED = 1e-6      # error to which the steps before the problem are solved
REST = 1e-5         # largest displacement in a step [m] at rest
MOST_STEPS = 60
MOST_SWEEPS = 2000  # sweeps a step. Steps of 40000 disks may stay unsolved: the facts state it, and the next step follows


def build(places, sides, radii, mu):
    """Append walls 0 .. 5, x+ and y+ free, then the disks. Return the unit of time sqrt(m/P) [s]."""
    O.reset()
    O.materials.append(FrictMat(frictionAngle=math.atan(mu), density=1, label="disk"))
    walls.append(sides, DEPTH, "disk")
    for place, radius in zip(places, radii):
        bodies.append_disk(place, radius, math.pi * radius**2, "disk")
    walls.set_free(2 * math.sqrt(len(radii)) * bodies.mean_mass())
    return math.sqrt(bodies.mean_mass() / (PRESSURE * DEPTH))


def movable():
    """Return the disks and the two free walls."""
    return bodies.disks() + [O.bodies[walls.X_HIGH], O.bodies[walls.Y_HIGH]]


def load(more=1.0):
    """Set permanent forces: P on both free walls, `more` times P on y+."""
    area_x, area_y = walls.areas()
    O.forces.setPermF(walls.X_HIGH, (-PRESSURE * area_x, 0, 0))
    O.forces.setPermF(walls.Y_HIGH, (0, -PRESSURE * area_y * more, 0))


def largest_displacement():
    """Return the largest displacement of a body in the last step [m]."""
    return max(b.state.vel.norm() for b in movable()) * O.dt


def come_to_rest(unit):
    """Hold P until no body moves by more than REST in a step; halve the speeds every five steps. Return facts about the final state."""
    def slow():
        load()
        for body in movable():
            body.state.vel *= 0.5
            body.state.angVel *= 0.5

    def watch():
        if largest_displacement() < REST:
            failing.stop()

    load()
    O.dt = 0.01 * unit
    engines = cd_engine.engines(tolerance=SETTLED, maxIterations=MOST_SWEEPS)
    O.engines = engines + [hooks.runner(slow, iterPeriod=5), hooks.runner(watch, iterPeriod=5)]
    hooks.simulate(MOST_STEPS)
    O.engines = engines
    engine = engines[-1]
    return {"steps": engine.steps, "solid_fraction": bodies.solid_fraction(), "contacts_per_disk": bodies.contacts_per_disk(),
            "loaded_contacts": engine.loadedContacts, "sliding_contacts": engine.slidingContacts, "residual": engine.residual,
            "largest_displacement": largest_displacement(), "unconverged_steps": engine.unconvergedSteps}


def load_on():
    """Make the STEPS steps before the problem, under rising load. Return facts about them."""
    for step in range(1, STEPS + 1):
        load(1 + step * MORE)
        hooks.simulate(1)
    engine = O.engines[-1]
    return {"loaded_steps": STEPS, "loaded_residual": engine.residual, "loaded_sliding_contacts": engine.slidingContacts,
            "loaded_unconverged_steps": engine.unconvergedSteps}


def main(disks, seed, friction, stem):
    """Make the packing and the problem for each friction coefficient; the files are named `stem`-friction. Return facts about the last."""
    packed = jammed(np.random.default_rng(seed).uniform(*RADII, disks), seed)
    for mu in friction:
        facts = come_to_rest(build(*packed, mu)) | load_on()
        target = f"{stem}-{mu:g}"
        load(1 + (STEPS + 1) * MORE)
        O.engines[-1].exportProblem(f"{target}.npz", True)
        # Written last: its presence means that the problem is complete.
        pathlib.Path(f"{target}.json").write_text(json.dumps(facts, indent=1) + "\n")
    return facts
