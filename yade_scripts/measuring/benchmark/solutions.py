"""Measures the time and the sweeps to reach an error, for each problem: all methods of the core and Siconos's Gauss-Seidel, in several rounds.

A row is one (problem, method, target). Where every run met the target it is the run of median time. core.residual computes the error of the
returned impulses, as 2-norm and as maximum. A row whose 2-norm misses the target has a reason in `status` and no time.
"""
from collections import namedtuple

import numpy as np

from cd_engine import core
from yade_scripts.measuring.benchmark import siconos, sweeps

TARGETS = 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8
SOLVED = "solved"
PEER = "siconos nsgs"
MOST_SWEEPS = 200000
NEWTON_DISKS = 1000  # number of disks above which Newton's method alone is not tried: its factorizations take too long

Run = namedtuple("Run", [*siconos.Point._fields, "status"])


def measure(case, rounds=3, targets=TARGETS, most_seconds=5.0, peer=True, peer_seconds=None):
    """Return the rows of a case.

    most_seconds: time of the sweeps after which a run is left unsolved; a target that takes more than a tenth of it is run in one round only.
    peer_seconds: the same for Siconos, whose sweeps cost fifty to sixty times as much. Where it does not meet a target in this time, the row says
    how far it came.
    """
    methods = [method for method in core.methods() if method != "newton" or case.disks <= NEWTON_DISKS]
    runs, missed = {(method, target): [] for method in methods for target in targets}, {}
    most = int(min(MOST_SWEEPS, max(100, most_seconds / max(1e-9, sweeps.of_a_sweep(sweeps.plain, case.problem, 50, 10)))))
    theirs, histories, peer_seconds = siconos.Peer(case.problem) if peer else None, [], peer_seconds or most_seconds
    for _ in range(rounds):
        for method in [method for method in methods if method not in missed]:
            for target in sorted(targets, reverse=True):
                if any(run.seconds > most_seconds / 10 for run in runs[method, target]):
                    continue
                report = core.solve(case.problem, method, target, most, impulses=case.impulses)
                errors = core.residual(case.problem, report.impulses), core.residual_max(case.problem, report.impulses)
                run = Run(report.iterations, report.seconds, *errors, report.status)
                runs[method, target].append(run)
                if run.residual > target:
                    missed[method] = run  # it would miss the smaller targets, too
                    break
        if theirs:
            # Later rounds stop at the smallest target that the first one met quickly.
            quick = [target for target in targets if not histories
                     or (point := siconos.reached(histories[0], target)) and point.seconds <= peer_seconds / 10]
            if quick:
                histories.append(theirs.history(case.impulses, min(quick), peer_seconds))
    for method, run in missed.items():
        runs |= {(method, target): runs[method, target] or [run] for target in targets}
    if theirs:
        runs |= {(PEER, target): _of_peer(histories, target) for target in targets}
    first = core.residual(case.problem, case.impulses)
    return [{"status": None, "problem": case.name, "kind": case.kind, "disks": case.disks, "contacts": case.problem.contacts, "mu": case.mu,
             "seed": case.seed, "start": case.start, "method": method, "target": target} | _told(several, target)
            | {"residual_at_start": first if np.isfinite(first) else None} for (method, target), several in runs.items()]


def _told(runs, target):
    """Return what a row says of the runs to a target: the run of median time, or the first that missed the target, without its time."""
    if missed := [run for run in runs if not run.residual <= target]:
        run = missed[0]._replace(seconds=None)
    else:
        run = sorted(runs, key=lambda run: run.seconds)[len(runs) // 2]._replace(status=SOLVED)
    return {"rounds": len(runs)} | run._asdict()


def _of_peer(histories, target):
    """Return the runs of Siconos that met a target, or the state in which the first was stopped."""
    if met := [point for history in histories if (point := siconos.reached(history, target))]:
        return [Run(*point._replace(sweeps=round(point.sweeps)), SOLVED) for point in met]
    last = histories[0][-1]
    return [Run(*last, f"not within {last.seconds:.3g} s" if np.isfinite(last.residual) else "not finite")]
