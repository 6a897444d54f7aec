"""Measures the whole engine in YADE on a prepared packing: the cost of a step and of its bare solution, the memory, and the share of solved steps.

packing.py left the packing after nine steps under rising load; every step here loads wall y+ by 0.2 % of P more. Memory per disk is what loading the
scene adds to the process; memory per solved contact is what engine, collider and interactions add afterwards.
"""
import pathlib
import resource

import numpy as np
from yade import O, timing

import cd_engine
from yade_scripts.preparing import bodies
from yade_scripts.measuring.benchmark import packing
from yade_scripts.running import hooks


def resident():
    """Return the memory that this process uses now [bytes]."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def main(stem, tolerance, steps, most_sweeps):
    """Return the row of a packing, whose files begin with `stem`."""
    cd_engine.methods()  # the plug-in must be known before a scene with its engine is loaded
    empty = resident()
    O.load(f"{stem}.yade.gz")
    # Forces are not part of a saved scene.
    packing.load(1 + packing.STEPS * packing.MORE)
    loaded = resident()
    O.engines = cd_engine.engines(tolerance=tolerance, maxIterations=most_sweeps)
    engine, made = O.engines[-1], []
    hooks.simulate(1)  # not timed: the hand-over from springs and the collider's first run
    for step in range(1, steps + 1):
        packing.load(1 + (packing.STEPS + step) * packing.MORE)
        timing.reset()
        O.timingEnabled = True
        before = engine.solveTime
        hooks.simulate(1)
        made.append((1e-9 * sum(e.execTime for e in O.engines), engine.solveTime - before, engine.iterations, engine.converged))
    total, solver, sweeps, solved = np.transpose(made)
    disks = len(bodies.disks())
    return {
        "status": "measured", "packing": pathlib.Path(stem).name, "disks": disks, "contacts": engine.contacts, "tolerance": tolerance, "steps": steps,
        "most_sweeps": most_sweeps, "steps_solved": int(solved.sum()), "median_sweeps": np.median(sweeps), "largest_sweeps": int(sweeps.max()),
        "seconds_a_step": np.median(total), "seconds_of_the_solver": np.median(solver), "step_over_solver": np.median(total / solver),
        "outside_ns_per_contact": np.median(total - solver) * 1e9 / engine.contacts,
        "bytes_a_disk_in_yade": (loaded - empty) / disks, "bytes_a_contact_of_engine": (resident() - loaded) / engine.contacts}
