"""Measures the cost of a step of packings at rest: hexagonal packings under gravity, by Contact Dynamics and by YADE's springs.

Equal disks (R = 1 cm, mu = 0.5) lie in a tray as wide as a row. They form one island, which is solved whole (reduce=False). Contact
Dynamics comes first: SETTLING steps to a tenth of the tolerance, at most to SETTLED, and SETTLING to the tolerance, not counted; then RUNS
runs of steps/RUNS each. Springs follow: SETTLING steps, not counted, and the same runs. Times are processor time, medians over the runs;
nothing is recorded in them. Each run begins with a search by YADE's collider and ends with writing all contacts to the scene; both count.
    order "shuffled": the disks' ids are in random order, as after pouring; "built": row by row.
Memory: what the scene adds to the process per disk, and what engine, collider and interactions add from there on per contact.
"""
import math
import random
import time

import numpy as np
import yade
from yade import O, utils
from yade import wrapper as w

import cd_engine
from yade_scripts.measuring.benchmark.engine import resident

RADIUS, MASS, FRICTION, GRAVITY = 0.01, 1000 * math.pi * 0.01**2, 0.5, 9.81  # [m], [kg] of a disk of depth 1 m, [1], [m/s^2]
STEP = 1e-3        # of Contact Dynamics [s]
YOUNG = 1e7        # of the springs [Pa]
RUNS = 5           # over which the median is taken
SETTLING = 20      # steps
SETTLED = 1e-6     # tolerance to which a packing settles first, at most


def build(rows, columns, order):
    """Build the scene: the tray, and the disks row by row or shuffled."""
    O.reset()
    O.materials.append(w.FrictMat(young=YOUNG, poisson=0.3, density=1000, frictionAngle=math.atan(FRICTION)))
    width, height = (2 * columns + 1) * RADIUS, rows * math.sqrt(3) * RADIUS + 2 * RADIUS
    for centre, half in (((width / 2, -0.05), (width, 0.05)), ((-0.05, height / 2), (0.05, height)), ((width + 0.05, height / 2), (0.05, height))):
        O.bodies.append(utils.box((*centre, 0), (*half, 0.5), fixed=True, material=0))
    places = [((2 * c + 1 + r % 2) * RADIUS, RADIUS + r * math.sqrt(3) * RADIUS) for r in range(rows) for c in range(columns)]
    if order == "shuffled":
        random.Random(1).shuffle(places)
    for place in places:
        disk = utils.sphere((*place, 0), RADIUS, material=0)
        disk.state.mass, disk.state.inertia, disk.state.blockedDOFs = MASS, (MASS * RADIUS**2 / 2,) * 3, "zXY"
        O.bodies.append(disk)


def springs():
    return [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb()], verletDist=0.1 * RADIUS),
            w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(), w.Ig2_Box_Sphere_ScGeom()], [w.Ip2_FrictMat_FrictMat_FrictPhys()],
                              [w.Law2_ScGeom_FrictPhys_CundallStrack()]),
            w.NewtonIntegrator(damping=0.3, gravity=(0, -GRAVITY, 0))]


def seconds(steps):
    """Make `steps` steps. Return the processor time of one [s]."""
    begin = time.process_time()
    O.run(steps, True)
    return (time.process_time() - begin) / steps


def main(rows, columns, tolerance, steps, order):
    empty = resident()
    build(rows, columns, order)
    loaded = resident()
    O.engines = cd_engine.engines(gravity=(0, -GRAVITY, 0), tolerance=min(SETTLED, 0.1 * tolerance), reduce=False)
    engine, O.dt = O.engines[-1], STEP
    O.run(SETTLING, True)
    engine.tolerance = tolerance
    O.run(SETTLING, True)
    missed = engine.unconvergedSteps
    each, made = max(1, steps // RUNS), []
    for _ in range(RUNS):
        before = engine.solveTime, engine.totalIterations
        made.append((seconds(each), (engine.solveTime - before[0]) / each, (engine.totalIterations - before[1]) / each))
    whole, solver, sweeps = np.median(made, axis=0)
    memory = resident() - loaded
    contacts, missed = engine.contacts, engine.unconvergedSteps - missed
    cd_engine.release()
    O.engines, O.dt = springs(), 0.3 * math.sqrt(MASS / YOUNG)
    O.run(SETTLING, True)
    spring = np.median([seconds(each) for _ in range(RUNS)])
    disks = rows * columns
    return {
        "status": "measured", "disks": disks, "contacts": contacts, "order": order, "tolerance": tolerance, "steps": each * RUNS,
        "steps_missed": missed, "sweeps_a_step": sweeps, "seconds_a_step": whole, "seconds_of_the_solver": solver,
        "ns_a_contact": 1e9 * whole / contacts, "seconds_of_springs": spring, "over_springs": whole / spring,
        "bytes_a_disk_in_yade": (loaded - empty) / disks, "bytes_a_contact_of_engine": memory / contacts, "yade": yade.config.version}
