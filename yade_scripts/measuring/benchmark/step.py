"""Measures the cost of a step of packings at rest: hexagonal packings under gravity, by Contact Dynamics and by YADE's springs.

    yade -n -x yade_scripts/measuring/in_yade.py benchmark.step '{"rows": 20, "columns": 2000, "tolerance": 1e-4, "steps": 100, "order": "built"}'

Equal disks (R = 1 cm, mu = 0.5) lie in a tray as wide as a row. They form one island, which is solved whole (reduce=False). Contact
Dynamics comes first: SETTLING steps to a tenth of the tolerance, at most to SETTLED, and WARMING to the tolerance, not counted; then RUNS
runs of steps/RUNS each. Springs follow: SETTLING steps, not counted, and as many runs. Times are processor time, of the solver wall-clock
time, medians over the runs; nothing is recorded in them.
    A run of Contact Dynamics begins with a search by YADE's collider and ends with writing all contacts to the scene. Runs of one step tell what
    this costs, so that the cost of a step is that of a long run, and the cost of a run stands by itself.
    Two threads: wall-clock time with one thread over that with two, medians of alternating runs, for the step and for the solver.
    order "shuffled": the disks' ids are in random order, as after pouring; "built": row by row.
    At rest: as many disks, up to RESTING, lie side by side on a floor and do not touch. A step is timed when all of them sleep.
Memory: what the scene adds to the process per disk; what YADE's collider and interactions for springs add
per contact; what Contact Dynamics adds to these, which it uses, too.
"""
import math
import os
import pathlib
import random
import resource
import time

import numpy as np
import yade
from yade import O, timing, utils
from yade import wrapper as w

import cd_engine
from yade_scripts.running import bodies

RADIUS, MASS, FRICTION, GRAVITY = 0.01, 1000 * math.pi * 0.01**2, 0.5, 9.81  # [m], [kg] of a disk of depth 1 m, [1], [m/s^2]
STEP = 1e-3        # of Contact Dynamics [s]
YOUNG = 1e7        # of the springs [Pa]
RUNS = 5           # over which the median is taken
SETTLING = 20      # steps
WARMING = 200      # steps: of 40 000 disks, sweeps a step to 1e-4 fall from 14 to 3.4 within 160 steps after a smaller tolerance
MEASURED, LEAST = 2000000, 10  # steps of a run of springs, or at rest: MEASURED over the number of disks, and at least LEAST
SETTLED = 1e-6     # tolerance to which a packing settles first, at most
RESTING = 40000    # most disks of the scene at rest


def resident():
    """Return the memory that this process uses now [bytes]."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def scene():
    """Begin a scene with a material and no bodies."""
    O.reset()
    O.materials.append(w.FrictMat(young=YOUNG, poisson=0.3, density=1000, frictionAngle=math.atan(FRICTION)))


def wall(centre, half):
    O.bodies.append(utils.box((*centre, 0), (*half, 0.5), fixed=True, material=0))


def build(rows, columns, order):
    """Build the tray, and the disks row by row or shuffled."""
    scene()
    width, height = (2 * columns + 1) * RADIUS, rows * math.sqrt(3) * RADIUS + 2 * RADIUS
    for centre, half in (((width / 2, -0.05), (width, 0.05)), ((-0.05, height / 2), (0.05, height)), ((width + 0.05, height / 2), (0.05, height))):
        wall(centre, half)
    places = [((2 * c + 1 + r % 2) * RADIUS, RADIUS + r * math.sqrt(3) * RADIUS) for r in range(rows) for c in range(columns)]
    if order == "shuffled":
        random.Random(1).shuffle(places)
    for place in places:
        bodies.append_disk(place, RADIUS, MASS, 0)


def springs(reach=1):
    """Return YADE's engines for springs. reach: distance of two disks, over the sum of their radii, up to which they get an interaction."""
    return [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(aabbEnlargeFactor=reach), w.Bo1_Box_Aabb()], verletDist=0.1 * RADIUS),
            w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(interactionDetectionFactor=reach), w.Ig2_Box_Sphere_ScGeom()],
                              [w.Ip2_FrictMat_FrictMat_FrictPhys()],
                              [w.Law2_ScGeom_FrictPhys_CundallStrack(neverErase=reach > 1)]),
            w.NewtonIntegrator(damping=0.3, gravity=(0, -GRAVITY, 0))]


def seconds(steps):
    """Make `steps` steps in one run. Return its processor time [s]."""
    begin = time.process_time()
    O.run(steps, True)
    return time.process_time() - begin


def settle(tolerance):
    """Let the packing settle to a smaller tolerance and run on to `tolerance`. Return the engine."""
    O.engines = cd_engine.engines(gravity=(0, -GRAVITY, 0), tolerance=min(SETTLED, 0.1 * tolerance), reduce=False, threads=1)
    engine, O.dt = O.engines[-1], STEP
    O.run(SETTLING, True)
    engine.tolerance = tolerance
    O.run(WARMING, True)
    return engine


def costs(engine, steps, counts):
    """Return the median cost of a step of long runs, by the number of threads: {threads: [processor time, wall-clock time of all engines, wall-clock
    time in the solver, sweeps, processor time of a run beside its steps]}, times in [s]. counts: numbers of threads, which take turns.
    """
    made = {threads: [] for threads in counts}

    def clocks():  # YADE looks every 40 ms whether a run has ended, so the clock on the wall cannot be read here
        return np.array([time.process_time(), 1e-9 * sum(e.execTime for e in O.engines), engine.solveTime, engine.totalIterations])

    def run(count):
        before = clocks()
        O.run(count, True)
        return clocks() - before

    timing.reset()
    O.timingEnabled = True
    for _ in range(RUNS):
        for engine.threads, found in made.items():
            run(1)  # the first one after a change of the threads costs more
            short, whole = run(1), run(steps)
            step = (whole - short) / (steps - 1)
            found.append([*step, short[0] - step[0]])
    O.timingEnabled, engine.threads = False, 1
    return {threads: np.median(found, axis=0) for threads, found in made.items()}


def at_rest(disks):
    """Return the processor time of a step in which all disks sleep, per disk [ns]; NaN if they do not fall asleep."""
    scene()
    wall((1.5 * disks * RADIUS, -0.05), (1.5 * disks * RADIUS, 0.05))
    for k in range(disks):
        bodies.append_disk(((3 * k + 1.5) * RADIUS, RADIUS), RADIUS, MASS, 0)
    O.engines, O.dt = cd_engine.engines(gravity=(0, -GRAVITY, 0)), STEP
    O.run(10 * SETTLING, True)
    if O.engines[-1].sleeping < disks:
        return math.nan
    each = max(LEAST, MEASURED // disks)
    return 1e9 * np.median([(seconds(each) - seconds(1)) / (each - 1) for _ in range(RUNS)]) / disks


def main(rows, columns, tolerance, steps, order):
    disks, empty = rows * columns, resident()
    build(rows, columns, order)
    loaded = resident()
    O.engines, O.dt = springs(1 + 1e-6), 1e-12  # nothing moves, but YADE makes the interactions of all contacts
    O.run(1, True)
    with_interactions = resident()
    engine = settle(tolerance)
    memory = resident() - with_interactions
    missed, each = engine.unconvergedSteps, max(2, steps // RUNS)
    cost = costs(engine, each, (1, 2) if os.cpu_count() > 1 else (1,))
    whole, wall, solver, sweeps, around = cost[1]
    faster, solved_faster = (wall, solver) / cost[2][1:3] if 2 in cost else (math.nan, math.nan)
    contacts, missed = engine.contacts, engine.unconvergedSteps - missed
    cd_engine.release()
    O.engines, O.dt = springs(), 0.3 * math.sqrt(MASS / YOUNG)
    O.run(SETTLING, True)
    few = min(each, max(LEAST, MEASURED // disks))
    spring = np.median([seconds(few) for _ in range(RUNS)]) / few
    peak, resting = resident(), at_rest(min(disks, RESTING))
    return {
        "status": "measured", "disks": disks, "contacts": contacts, "order": order, "tolerance": tolerance, "steps": each * RUNS,
        "steps_missed": missed, "sweeps_a_step": sweeps, "seconds_a_step": whole, "seconds_of_the_solver": solver, "seconds_around_a_run": around,
        "ns_a_contact": 1e9 * whole / contacts, "seconds_of_springs": spring, "over_springs": whole / spring,
        "two_threads_step": faster, "two_threads_solver": solved_faster, "ns_a_disk_at_rest": resting,
        "bytes_a_disk_in_yade": (loaded - empty) / disks, "bytes_a_contact_of_interactions": (with_interactions - loaded) / contacts,
        "bytes_a_contact_of_engine": memory / contacts, "bytes_in_all": peak, "yade": yade.config.version}
