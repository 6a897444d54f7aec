"""What a Contact Dynamics step costs: a plain sweep on every instruction set of this processor, its set-up, and everything outside the solver.

    yade -n -x yade_scripts/benchmark.py [results/benchmark.csv]

Scenes: the prepared packing of 400 disks at rest under P0, and triangular lattices under gravity. Medians of paired repeats in one run;
times of the engines from O.timingEnabled, of the solver from ContactDynamics.solveTime. Set-up: what a solver of one sweep takes beside it, to
pack the contacts, find the velocities and ask for the error once, with the groups of contacts that of the step before (setup) and anew
(setup_regrouped). The bound a step is held against is the time of ten sweeps. Prints a table and writes it as CSV.
"""
import csv
import math
import pathlib
import random
import statistics
import sys

ROOT = pathlib.Path(sys.argv[0]).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from yade import O, timing, utils

import cd_engine
from yade_scripts import bodies, parameters, prepare, walls

REPEATS = 5
SWEEPS = 500  # a step: enough to see the sweeps alone, and to keep lattices at rest as in quasi-static work
SETTLE = 40   # steps before the first that counts


def packing():
    """The prepared packing with its walls loaded by P0; no gravity."""
    full = parameters.complete({})
    path, _ = prepare.ensure(full, ROOT / "results")
    O.load(str(path))
    walls.set_free(full["wall_mass_ratio"] * bodies.mean_mass())
    for wall, area, axis in zip((walls.X_HIGH, walls.Y_HIGH), walls.areas(), (0, 1)):
        O.forces.setPermF(wall, tuple(-parameters.pressure(full) * area if i == axis else 0 for i in range(3)))
    return (0, 0, 0)


def lattice(rows):
    """rows x rows disks of nearly equal radii in a trough; their gravity."""
    def build():
        O.reset()
        draw, r = random.Random(1), 0.01
        material = O.materials.append(utils.FrictMat(young=1e6, poisson=0.3, density=1000, frictionAngle=math.atan(0.5)))
        O.bodies.append([utils.wall(0, axis=1, material=material), utils.wall(-r, axis=0, material=material), utils.wall(2 * rows * r, axis=0, material=material)])
        for j in range(rows):
            for i in range(rows):
                disk = utils.sphere(((2 * i + j % 2) * r, r + j * r * math.sqrt(3), 0), r * (1 - 1e-4 * draw.random()), material=material)
                disk.state.mass, disk.state.inertia, disk.state.blockedDOFs = 1, (r * r / 2,) * 3, "zXY"
                O.bodies.append(disk)
        return (0, -9.81, 0)
    return build


def solving(engine, steps):
    """Seconds a step that the solver takes, mean over so many steps."""
    before = engine.solveTime
    O.run(steps, True)
    return (engine.solveTime - before) / steps


def regrouping(engine, steps):
    """The same when every other step one disk may not turn, which changes what can be grouped."""
    state = next(b for b in O.bodies if b.state.blockedDOFs == "zXY").state
    total = 0
    for i in range(steps):
        state.blockedDOFs = "zXY" if i % 2 else "zXYZ"
        total += solving(engine, 1)
    state.blockedDOFs = "zXY"
    return total / steps


def measure(build, steps):
    """Medians of a scene: disks, contacts, ns per contact of a sweep and of the set-up, microseconds a step outside the solver."""
    gravity = build()
    O.dt = 1e-3
    O.engines = cd_engine.engines(gravity=gravity, fixedIterations=SWEEPS)
    engine, plugin = O.engines[-1], cd_engine._plugin()
    sets = list(plugin.instruction_sets())
    O.run(SETTLE, True)
    sweeps, outside, setup, regrouped = {name: [] for name in sets}, [], [], []
    for _ in range(REPEATS):
        engine.fixedIterations = SWEEPS
        for name in reversed(sets):  # the fastest last: it stays in use
            plugin.use_instruction_set(name)
            timing.reset()
            O.timingEnabled = name == sets[0]
            seconds = solving(engine, steps)
            sweeps[name].append(seconds / SWEEPS / engine.contacts * 1e9)
        outside.append(sum(e.execTime for e in O.engines) * 1e-3 / steps - seconds * 1e6)
        O.timingEnabled = False
        engine.fixedIterations = 1
        one = sweeps[sets[0]][-1]
        setup.append(solving(engine, steps) / engine.contacts * 1e9 - one)
        regrouped.append(regrouping(engine, steps) / engine.contacts * 1e9 - one)
    disks = sum(b.state.blockedDOFs == "zXY" for b in O.bodies)
    sweep, rest = statistics.median(sweeps[sets[0]]), statistics.median(outside)
    return {"disks": disks, "contacts": engine.contacts,
            **{f"sweep_{name}_ns_per_contact": round(statistics.median(sweeps[name]), 2) for name in sets},
            "setup_ns_per_contact": round(statistics.median(setup), 1), "setup_regrouped_ns_per_contact": round(statistics.median(regrouped), 1),
            "outside_us_per_step": round(rest, 1), "outside_ns_per_contact": round(rest * 1e3 / engine.contacts, 1),
            "outside_over_ten_sweeps": round(rest * 1e3 / engine.contacts / (10 * sweep), 2)}


def main():
    rows = []
    for name, build, steps in (("packing", packing, 100), ("lattice", lattice(20), 100), ("lattice", lattice(60), 50), ("lattice", lattice(200), 20)):
        rows.append({"scene": name, **measure(build, steps)})
        if len(rows) == 1:
            print(*(f"{key:>30}" for key in rows[0]))
        print(*(f"{value!s:>30}" for value in rows[-1].values()), flush=True)
    target = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "results" / "benchmark.csv"
    target.parent.mkdir(parents=True, exist_ok=True)
    with open(target, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    print("written:", target)


main()
