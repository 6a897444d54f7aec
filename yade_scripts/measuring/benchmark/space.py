"""Measures the time to reach an error on contact problems in space: all methods of the core, and Siconos's solvers that come nearest.

A row is one (problem, method, target), as in solutions.py, of the fastest of several runs. Each run of Siconos has a process of its own, since some
of its solvers abort or never return; its time is that of the solver alone. core.residual computes every error anew from the impulses. Siconos
stops by an error of its own: it gets the largest of several tolerances with which it meets the target.
"""
import os
import resource
import tempfile
import time

import numpy as np

from cd_engine import core
from yade_scripts.measuring.benchmark import siconos
from yade_scripts.measuring.benchmark.solutions import SOLVED

TARGETS = 1e-4, 1e-6, 1e-8
STRICTER = 1, 1e-1, 1e-2, 1e-3, 1e-5  # its tolerance over the target
SHORT = 0.5           # s; longer runs are not repeated
MOST_SWEEPS = 200000
# Of each of Siconos's solvers: its name, the solver within it, the most iterations.
PEERS = {"siconos NSGS": ("NSGS", None, 1000000), "siconos NSGS, QUARTIC": ("NSGS", "ONECONTACT_QUARTIC", 1000000),
         "siconos PROX": ("PROX", None, 1000), "siconos PROX, NSN_FB": ("PROX", "NSN_FB", 1000), "siconos ADMM": ("ADMM", None, 100000),
         "siconos NSN_AC": ("NSN_AC", None, 1000)}


def measure(case, rounds=3, targets=TARGETS, most_seconds=5.0, peer=True):
    """Return the rows of a case."""
    problem = case.problem if isinstance(case.problem, core.Problem) else case.problem.delassus()
    rows = []
    for method in core.methods():
        for target in targets:
            rows.append(_fastest(case, problem, method, target, rounds, lambda: _ours(case.problem, method, target)))
            if rows[-1]["status"] != SOLVED:
                break  # it would miss the smaller targets, too
    for name in PEERS if peer else ():
        for target in targets:
            rows.append(_peer(case, problem, name, target, rounds, most_seconds))
            if rows[-1]["status"] != SOLVED:
                break
    return rows


def _peer(case, problem, name, target, rounds, most_seconds):
    """Return the row of one of Siconos's solvers, with the largest of its tolerances that meets the target."""
    for factor in STRICTER:
        row = _fastest(case, problem, name, target, rounds, lambda: _alone(problem, name, factor * target, most_seconds))
        if row["status"] == SOLVED or not np.isfinite(row["residual"]):
            break
    return row


def _fastest(case, problem, method, target, rounds, run):
    """Return the row of the fastest of several runs; of one if that takes more than SHORT or fails."""
    best = run()
    for _ in range(rounds - 1 if best and best[1] < SHORT else 0):
        best = min(best, run() or best, key=lambda found: found[1])
    return _row(case, problem, method, target, *(best or (None, None, None, "aborted or too slow")))


def _ours(problem, method, target):
    report = core.solve(problem, method, target, MOST_SWEEPS)
    return report.impulses, report.seconds, report.iterations, report.status


def _row(case, problem, method, target, impulses, seconds, sweeps, status="not solved"):
    """A row without a time unless the target is met."""
    errors = (np.nan, np.nan) if impulses is None else (core.residual(problem, impulses), core.residual_max(problem, impulses))
    met = errors[0] <= target
    return {"status": SOLVED if met else status, "problem": case.name, "kind": case.kind, "disks": case.disks, "contacts": problem.contacts,
            "mu": case.mu, "seed": case.seed, "start": case.start, "method": method, "target": target, "sweeps": sweeps,
            "seconds": seconds if met else None, "residual": errors[0], "residual_max": errors[1]}


def _alone(problem, name, tolerance, seconds):
    """Return impulses, processor time [s] and iterations of one of Siconos's solvers in a process of its own; None if it takes too long."""
    here, there = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 2, int(seconds) + 3))
            for stream in (1, 2):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
            os.write(there, np.hstack(_solve(problem, name, tolerance)).tobytes())
        finally:
            os._exit(0)
    os.close(there)
    with os.fdopen(here, "rb") as pipe:
        answer = np.frombuffer(pipe.read())
    os.waitpid(child, 0)
    return (answer[:-2], answer[-2], answer[-1]) if len(answer) == len(problem.q) + 2 else None


def _solve(problem, name, tolerance):
    import siconos.numerics as numerics
    with tempfile.NamedTemporaryFile("w", suffix=".dat") as file:
        siconos.write_blocks(file, problem)
        theirs = numerics.frictionContact_new_from_filename(file.name)
    solver, inner, most = PEERS[name]
    options = numerics.SolverOptions(getattr(numerics, f"SICONOS_FRICTION_3D_{solver}"))
    if inner:
        numerics.solver_options_update_internal(options, 0, getattr(numerics, f"SICONOS_FRICTION_3D_{inner}"))
    options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = most
    options.dparam[numerics.SICONOS_DPARAM_TOL] = tolerance
    impulses, velocities = np.zeros((2, len(problem.q)))
    begin = time.thread_time()
    numerics.fc3d_driver(theirs, impulses, velocities, options)
    seconds = time.thread_time() - begin
    return impulses, seconds, max(1, options.iparam[numerics.SICONOS_IPARAM_ITER_DONE])
