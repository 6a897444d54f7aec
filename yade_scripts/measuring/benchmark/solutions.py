"""Measures the time and the sweeps to reach an error, for each problem: all methods of the core and Siconos's Gauss-Seidel, in several rounds.

A row is one (problem, method, target): medians over the rounds. core.residual computes the error of the returned impulses, as 2-norm and as
maximum. A row whose 2-norm misses the target has a reason in `status` and no time.
"""
import statistics

import numpy as np

from cd_engine import core
from yade_scripts.measuring.benchmark import siconos

TARGETS = 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8
SOLVED = "solved"
STOPPED = "not within"  # followed by the seconds
PEER = "siconos nsgs"
MOST_SWEEPS = 200000
NEWTON_DISKS = 1000  # number of disks above which Newton's method alone is not tried: its factorizations take too long


def measure(case, rounds=3, targets=TARGETS, most_seconds=5.0, peer=True, peer_seconds=None, say=lambda what: None):
    """Return the rows of a case. most_seconds: time of the sweeps after which a run is left unsolved; a target that takes more than a tenth of it is
    run in one round only. peer_seconds: the same for Siconos, whose sweeps cost forty times as much."""
    methods = [method for method in core.methods() if method != "newton" or case.disks <= NEWTON_DISKS]
    peer_seconds = peer_seconds or most_seconds
    found = {(method, target): [] for method in methods for target in targets}
    theirs = siconos.Peer(case.problem) if peer else None
    histories, given_up, slow = [], {}, set()
    rate = _seconds_a_sweep(case)
    for turn in range(rounds):
        for method in methods:
            for target in sorted(targets, reverse=True):
                if failed := given_up.get(method):
                    # A method that missed a larger target would miss this one, too.
                    found[method, target] = found[method, target] or [failed]
                    continue
                if (method, target) in slow:
                    continue
                say(f"{case.name}: {method} to {target:g}, round {turn + 1}")
                most = int(min(MOST_SWEEPS, max(100, most_seconds / rate)))
                report = core.solve(case.problem, method, target, most, impulses=case.impulses)
                run = (report.iterations, report.seconds, core.residual(case.problem, report.impulses),
                       core.residual_max(case.problem, report.impulses), report.status)
                found[method, target].append(run)
                if run[2] > target:
                    given_up[method] = run
                if report.seconds > most_seconds / 10:
                    slow.add((method, target))
        if theirs:
            # Later rounds stop at the smallest target that the first one met quickly.
            quick = [target for target in targets if not histories
                     or (point := siconos.reached(histories[0], target)) and point[1] <= peer_seconds / 10]
            if wanted := min(quick, default=None):
                say(f"{case.name}: {PEER} to {wanted:g}, round {turn + 1}")
                histories.append(theirs.history(case.impulses, wanted, peer_seconds))
    rows = [_row(case, method, target, _median(runs, target)) for (method, target), runs in found.items() if runs]
    rows += [_row(case, PEER, target, _of_peer(histories, target)) for target in targets if histories]
    first = core.residual(case.problem, case.impulses)
    return [row | {"residual_at_start": first if np.isfinite(first) else None} for row in rows]


def _seconds_a_sweep(case):
    """Estimate the time of a plain sweep from the difference of two solutions, in which the preparation drops out."""
    few, many = (core.solve(case.problem, fixed_iterations=count).seconds for count in (10, 50))
    return max(1e-9, (many - few) / 40)


def _median(runs, target):
    """Return (rounds, sweeps, seconds, e, e_max, status) of the run of median time. The status is SOLVED only if every run met the target."""
    if failed := [run for run in runs if not run[2] <= target]:
        return len(runs), failed[0][0], None, *failed[0][2:4], failed[0][4]
    middle = sorted(runs, key=lambda run: run[1])[len(runs) // 2]
    return len(runs), middle[0], statistics.median(run[1] for run in runs), *middle[2:4], SOLVED


def _of_peer(histories, target):
    if met := [point for history in histories if (point := siconos.reached(history, target))]:
        return len(met), round(met[0][0]), statistics.median(point[1] for point in met), *met[0][2:], SOLVED
    sweeps, seconds, *errors = histories[0][-1]
    return 1, sweeps, None, *errors, f"{STOPPED} {seconds:.3g} s" if np.isfinite(errors[0]) else "not finite"


def _row(case, method, target, found):
    rounds, sweeps, seconds, e, worst, status = found
    return {"status": status, "problem": case.name, "kind": case.kind, "disks": case.disks, "contacts": case.problem.contacts,
            "mu": case.mu, "seed": case.seed, "start": case.start, "method": method, "target": target, "rounds": rounds, "sweeps": sweeps,
            "seconds": seconds, "residual": e, "residual_max": worst}


def oracle(case):
    """Return the row of a case of at most 50 contacts: the error e of Siconos's pivoting solver, and its relative velocities against ours."""
    ours = core.solve(case.problem, tolerance=1e-12, max_iterations=MOST_SWEEPS)
    p, claim = siconos.Peer(case.problem).lemke()
    e = core.residual(case.problem, p)
    difference = np.abs(case.problem.velocities(p) - case.problem.velocities(ours.impulses)).max()
    scale = np.abs(case.problem.free_velocities).max()
    return [{"status": SOLVED if e < 1e-10 else f"error {e:.1e}, though it claims {'success' if claim == 0 else f'status {claim}'}",
             "problem": case.name, "contacts": case.problem.contacts, "mu": case.mu, "lemke_residual": e, "our_residual": ours.residual,
             "largest_velocity_difference": difference / scale}]
