"""Makes a dense packing of disks at rest under the load of its walls, and contact problems of its next step.

    yade -n -x yade_scripts/measuring/benchmark/packing.py '{"disks": 4000, "seed": 1, "friction": [0.1, 0.5], "stem": "results/packing"}'

Radii uniform in 0.30 .. 0.65 m, density 1 kg/m^2, two walls fixed and two loaded by P = 1 N/m, each of the mass of 2 sqrt(N) disks. Jammed
without friction by springs (jammed.py), handed over to Contact Dynamics with its overlaps of 6e-4 m, brought to rest with friction on disks and
walls alike in steps of h = 0.01 sqrt(m/P), solved to SETTLED. Then each step loads wall y+ by 0.2 % of P more; the problem is the tenth of these,
its first guess the impulses of the ninth.
"""
import json
import math
import pathlib
import sys

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[3]))

import numpy as np
from yade import O
from yade.wrapper import FrictMat

import cd_engine
from yade_scripts.preparing import bodies
from yade_scripts.running import hooks, walls
from yade_scripts.measuring.benchmark.jammed import jammed

PRESSURE = 1.0      # [N/m]
RADII = 0.30, 0.65  # [m]
DEPTH = 1.0         # [m]
MORE = 0.002        # of P by which the load of y+ rises in a step
STEPS = 9           # so made before the one that is the problem
SETTLED = 1e-6      # error to which the steps before the problem are solved
REST = 1e-5         # largest displacement in a step [m] at rest
MOST_STEPS = 60
MOST_SWEEPS = 2000  # a step: what 40000 disks leave unsolved is stated in the facts, and another step goes on


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
    """Hold P until nothing moves by more than REST in a step; every five steps the speed is halved. Return the facts of the state."""
    def slow():
        load()
        for body in movable():
            body.state.vel *= 0.5
            body.state.angVel *= 0.5

    def watch():
        if largest_displacement() < REST:
            hooks.stop()

    load()
    O.dt = 0.01 * unit
    O.engines = cd_engine.engines(tolerance=SETTLED, maxIterations=MOST_SWEEPS) \
        + [hooks.runner(slow, iterPeriod=5), hooks.runner(watch, iterPeriod=5)]
    hooks.simulate(MOST_STEPS)
    O.engines = O.engines[:3]
    engine = O.engines[2]
    return {"steps": engine.steps, "solid_fraction": bodies.solid_fraction(), "contacts_per_disk": bodies.contacts_per_disk(),
            "loaded_contacts": engine.loadedContacts, "sliding_contacts": engine.slidingContacts, "residual": engine.residual,
            "largest_displacement": largest_displacement(), "unconverged_steps": engine.unconvergedSteps}


def load_on():
    """Make the steps before the problem, under rising load. Return what is known of them."""
    for step in range(1, STEPS + 1):
        load(1 + step * MORE)
        hooks.simulate(1)
    engine = O.engines[2]
    return {"loaded_steps": STEPS, "loaded_residual": engine.residual, "loaded_sliding_contacts": engine.slidingContacts,
            "loaded_unconverged_steps": engine.unconvergedSteps}


def main(wish):
    """Make what `wish` asks for: disks, seed, friction coefficients; files named `stem`-friction."""
    packed = jammed(np.random.default_rng(wish["seed"]).uniform(*RADII, wish["disks"]), wish["seed"])
    for mu in wish["friction"]:
        facts = come_to_rest(build(*packed, mu)) | load_on()
        target = f"{wish['stem']}-{mu:g}"
        load(1 + (STEPS + 1) * MORE)
        O.engines[2].exportProblem(f"{target}.npz", True)
        O.engines = []  # which other versions of the engine could not read
        O.save(f"{target}.yade.gz")
        # Last: its presence says that all is there.
        pathlib.Path(f"{target}.json").write_text(json.dumps(facts, indent=1) + "\n")
    print(json.dumps(facts))


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
