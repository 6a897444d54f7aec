"""Measures what a step of a flow costs: a turning drum or the discharge of a silo, by rigid contacts or by springs in Contact Dynamics.

    yade -n -x yade_scripts/measuring/in_yade.py benchmark.flow '{"scene": "drum", "disks": 2000, "springs": false, "tolerance": 1e-3, "steps": 300}'

Steps of 1 ms, one thread. The first BEGIN steps let the flow start, with the tolerance of the row, and are not measured. Then the engines that
observe the scene are taken out. `steps` steps follow whose sweeps are counted, then as many that are timed, so that nothing is recorded while time is
measured. A time is the processor time of a long run less that of a run of one step.
    With tolerance 0 every step has FIXED sweeps. The same with MORE sweeps tells what a sweep costs, and so what a step costs beside its sweeps.
    Springs have the stiffness k_n for which k_n h^2 W_nn = STIFF between two disks of mean mass. The tolerance of their steps is relative to their
motion in a step (ENGINES). step_tolerance: the tolerance relative to the impulses, as that of rigid contacts, to which this led (geometric mean).
    Some problems (EXPORTED) are written while steps are counted, and solved from their first guess to the tolerance of the row. The errors are those
of their solutions, computed anew from the impulses (core.residual). The sweeps of springs are those of these problems, too.
"""
import tempfile
import time
from pathlib import Path

import numpy as np
from yade import O

import cd_engine
from cd_engine import core
from yade_scripts import parameters, results, scenes
from yade_scripts.running import hooks
from yade_scripts.theory import effective_medium

STEP, BEGIN, FIXED, MORE, STIFF, EXPORTED = 1e-3, 300, 2, 22, 100.0, 20
# Of springs, by the tolerance of the row: that of the engine, for means of flows or for single bodies.
ENGINES = {1e-3: cd_engine.SPRING_TOLERANCES["means"], 1e-4: cd_engine.SPRING_TOLERANCES["bodies"]}
# By (springs, tolerance), at most: sweeps a step in the mean, sweeps of one step, ns a contact for a whole step or for what is beside its sweeps.
GOALS = {(False, 1e-3): {"goal_sweeps": 50}, (False, 1e-4): {"goal_most_sweeps": 3000},
         (True, 1e-3): {"goal_sweeps": 30, "goal_ns_a_contact": 800}, (True, 1e-4): {"goal_sweeps": 60}, (False, 0.0): {"goal_ns_beside_sweeps": 120}}


def main(scene, disks, springs, tolerance, steps):
    engine = begin(scene, disks, springs, tolerance)
    missed = engine.unconvergedSteps
    if tolerance:
        sweeps, reached, solved = counted(engine, steps, tolerance)
        errors = [error for _, error in solved]
        if springs:
            sweeps = [number for number, _ in solved]
        cost, beside = nanoseconds(engine, steps), None
    else:
        per_sweep, errors, sweeps, reached = {}, [], [FIXED], None
        for number in (MORE, FIXED):
            engine.fixedIterations = number
            hooks.simulate(10)
            per_sweep[number] = nanoseconds(engine, steps)
        cost = per_sweep[FIXED]
        beside = cost - FIXED * (per_sweep[MORE] - cost) / (MORE - FIXED)
    return {"status": "measured", "scene": scene, "disks": disks, "contacts": engine.contacts, "springs": springs, "tolerance": tolerance,
            "steps": steps, "step_tolerance": reached, "steps_missed": engine.unconvergedSteps - missed,
            "sweeps": float(np.mean(sweeps)), "most_sweeps": int(max(sweeps)),
            "ns_a_contact": cost, "ns_beside_sweeps": beside, "mean_error": float(np.mean(errors)) if errors else None,
            "largest_error": max(errors, default=None)} | GOALS.get((springs, tolerance), {})


def begin(scene, disks, springs, tolerance):
    """Build the scene and let it flow. Return the engine."""
    row = {"scene": scene, "disks": disks, "method": "CD", "cd_dt": STEP, "tolerance": tolerance or 1e-3, "max_iterations": 20000, "period": 10.0}
    if springs:
        mass = effective_medium.mean_mass(parameters.complete(row))
        row |= {"cd_contacts": "springs", "tolerance": ENGINES[tolerance], "beta_n": 0.2, "kn": STIFF * mass / (2 * STEP**2)}
    scenes.build(parameters.complete(row), results.FOLDER)
    engine = hooks.engine("ContactDynamics")
    engine.threads = 1
    hooks.simulate(BEGIN)
    O.engines = [each for each in O.engines if each.label not in hooks.OBSERVERS]
    return engine


def counted(engine, steps, tolerance):
    """Return the sweeps of each of `steps` steps, the geometric mean of their tolerances, and (sweeps, error) of the exported problems."""
    sweeps, reached, problems, solved = [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        def count():
            sweeps.append(engine.iterations)
            reached.append(engine.stepTolerance)
            if len(sweeps) % max(1, steps // EXPORTED) == 0:
                problems.append(Path(folder) / f"{len(sweeps)}.npz")
                engine.exportProblem(str(problems[-1]), True)

        O.engines = O.engines + [hooks.runner(count, iterPeriod=1)]
        hooks.simulate(steps)
        O.engines = O.engines[:-1]
        for path in problems:
            problem = core.read_problem(path)
            report = core.solve(problem, tolerance=tolerance, max_iterations=20000, impulses=problem.impulses)
            solved.append((report.iterations, core.residual(problem, report.impulses)))
    return sweeps, float(np.exp(np.mean(np.log(reached)))), solved


def nanoseconds(engine, steps):
    """Return the processor time of a step over the number of contacts [ns]."""
    def seconds(count):
        before = time.process_time()
        hooks.simulate(count)
        return time.process_time() - before

    hooks.simulate(1)
    short = seconds(1)
    return 1e9 * (seconds(steps) - short) / (steps - 1) / engine.contacts
