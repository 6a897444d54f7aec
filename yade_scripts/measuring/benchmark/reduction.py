"""What islands, closed forms and sleeping save: the same steps with `reduce` and without, scene by scene.

    yade -n -x yade_scripts/measuring/benchmark/reduction.py '{"rounds": 5, "steps": 400, "tolerance": 1e-6}'

A round builds each scene twice, lets it come to rest or into motion, and times the steps after that. The last line printed is the result, a list of
rows in JSON.
"""
import json
import math
import pathlib
import random
import statistics
import sys

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[3]))

from yade import O
from yade.wrapper import FrictMat

import cd_engine
from yade_scripts import parameters
from yade_scripts.preparing import bodies
from yade_scripts.running import hooks

GRAVITY = 9.81
RADIUS = 0.01
FLOOR = 10.0  # to either side [m]


def _columns():
    """A hundred columns of three disks at rest on a floor, and one disk that rolls."""
    bodies.append_floor(_ground(), FLOOR)
    for place in range(100):
        for k in range(3):
            bodies.append_disk((0.05 * place, (2 * k + 1) * RADIUS), RADIUS, 1.0, "disk")
    bodies.append_disk((-0.1, RADIUS), RADIUS, 1.0, "disk", velocity=(-0.1, 0))


def _apart():
    """The disks of the columns, each by itself in free space: what bodies cost that nothing has to be done for."""
    bodies.append_floor(_ground(), FLOOR)
    for k in range(301):
        bodies.append_disk((0.05 * (k % 100), 0.1 * (1 + k // 100)), RADIUS, 1.0, "disk")


def _gas():
    """Four hundred disks that fly about, of which a few touch at a time."""
    draw = random.Random(1)
    for k in range(400):
        place = 2.2 * RADIUS * (k % 20), 2.2 * RADIUS * (k // 20)
        bodies.append_disk(place, RADIUS, 1.0, "disk", velocity=(draw.uniform(-1, 1), draw.uniform(-1, 1)))


def _pyramid():
    """A pyramid of 55 disks at rest, ten in its lowest row, between two walls."""
    ground = _ground()
    bodies.append_floor(ground, FLOOR)
    for k in range(10):
        for i in range(10 - k):
            bodies.append_disk(((2 * i + k + 1) * RADIUS, (1 + math.sqrt(3) * k) * RADIUS), RADIUS, 1.0, "disk")
    for side in (-RADIUS, 21 * RADIUS):
        bodies.append_box((side, 5 * RADIUS), (RADIUS, 5 * RADIUS), ground)


def _fallen():
    """Two hundred disks falling onto each other and the floor."""
    bodies.append_floor(_ground(), FLOOR)
    draw = random.Random(1)
    for k in range(200):
        bodies.append_disk((2.3 * RADIUS * (k % 15) + draw.uniform(0, 0.3 * RADIUS), 2.3 * RADIUS * (k // 15) + RADIUS), RADIUS, 1.0, "disk")


def _boxed():
    """The same between two walls."""
    _fallen()
    for side in (-2 * RADIUS, 2.3 * RADIUS * 15):
        bodies.append_box((side, 0.5), (RADIUS / 2, 0.5), _ground())


# Name: (bodies, gravity, step [s], steps before those that are timed).
SCENES = {"columns at rest": (_columns, GRAVITY, 1e-3, 200), "the same disks touching nothing": (_apart, 0.0, 1e-3, 200),
          "box of disks at rest": (_boxed, GRAVITY, 1e-3, 9000), "pyramid at rest": (_pyramid, GRAVITY, 1e-3, 300),
          "disks falling on each other": (_fallen, GRAVITY, 1e-3, 20), "gas": (_gas, 0.0, 1e-4, 10)}


def _ground():
    return parameters.complete({"scene": "stack", "friction": 0.5, "radius_mean": RADIUS})


def _run(scene, reduce, steps, tolerance):
    """(seconds of the solver a step, seconds of the engine a step, sweeps a step, the engine) of a scene built anew."""
    build, gravity, dt, before = SCENES[scene]
    O.reset()
    O.materials.append(FrictMat(frictionAngle=math.atan(0.5), density=1, label="disk"))
    build()
    O.dt = dt
    O.engines = cd_engine.engines(gravity=(0, -gravity, 0), tolerance=tolerance, reduce=reduce)
    engine = O.engines[-1]
    hooks.simulate(before)
    O.timingEnabled = True
    seconds, sweeps, whole = engine.solveTime, engine.totalIterations, engine.execTime
    hooks.simulate(steps)
    return (engine.solveTime - seconds) / steps, (engine.execTime - whole) * 1e-9 / steps, (engine.totalIterations - sweeps) / steps, engine


def row(scene, rounds, steps, tolerance):
    """Medians over the rounds; without and with in turn."""
    found = {False: [], True: []}
    for _ in range(rounds):
        for reduce in found:
            *numbers, engine = _run(scene, reduce, steps, tolerance)
            found[reduce].append(numbers)
            counts = {name: getattr(engine, name) for name in ("contacts", "unknowns", "islands", "resting", "sleeping", "unconvergedSteps")}
    (off, whole_off, sweeps_off), (on, whole_on, sweeps_on) = ([statistics.median(column) for column in zip(*found[reduce])] for reduce in found)
    return {"status": "measured", "scene": scene, "tolerance": tolerance} | counts | {
        "sweeps_without": sweeps_off, "sweeps_with": sweeps_on, "solver_seconds_without": off, "solver_seconds_with": on,
        "engine_seconds_without": whole_off, "engine_seconds_with": whole_on, "solver_without_over_with": off / on,
        "engine_without_over_with": whole_off / whole_on}


if __name__ == "__main__":
    wish = json.loads(sys.argv[1])
    print(json.dumps([row(scene, **wish) for scene in SCENES]))
