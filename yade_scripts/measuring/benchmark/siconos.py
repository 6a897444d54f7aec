"""Runs Siconos's 2D solvers on the same W, q and mu: fc2d_nsgs for packings, fc2d_lexicolemke as an oracle for a few contacts.

fc2d_nsgs (Gauss-Seidel) gets W in sparse blocks, its fastest storage here. It keeps no state between calls, so it can be stopped every few sweeps and
continues with the same bits. Only its sweeps are timed, without its own stopping test (which uses another measure than e); our code
computes the error e in between. So this is the shortest time in which Siconos can reach an error e.
"""
import importlib
import tempfile
import time

import numpy as np

from cd_engine import core

GROWTH = 1.05  # growth of the sweeps between two checks of the error; the time to a target is interpolated
FEWEST = 4


def available():
    """Return why Siconos cannot be used, None if it can."""
    try:
        importlib.import_module("siconos.numerics")
    except ImportError as error:
        return f"python3-siconos is not installed ({error})"
    return None


def write_blocks(file, problem):
    """Write the text in which Siconos reads a problem with W in sparse blocks; numbers are written with all digits."""
    def lines(values):
        file.write("\n".join(map(repr, values)) + "\n")

    n, W = problem.contacts, problem.W.tobsr((2, 2))
    W.sort_indices()
    ends = " ".join(map(str, range(2, 2 * n + 1, 2)))
    file.write(f"2\n{n}\n1\n{2 * n}\n{2 * n}\n{len(W.indices)}\n{n}\n{n}\n{ends}\n{ends}\n{n + 1}\n{len(W.indices)}\n")
    for pointers in (W.indptr, W.indices):
        file.write(" ".join(map(str, pointers)) + "\n")
    for number, (nn, tn, nt, tt) in enumerate(W.data.transpose(0, 2, 1).reshape(-1, 4).tolist()):  # each block by columns
        file.write(f"{number}\n{nn!r}\n{tn!r}\n{nt!r}\n{tt!r}\n")
    lines(problem.q.tolist())
    lines(problem.mu.tolist())
    file.flush()


class Peer:
    """One problem in Siconos's own data structures."""

    def __init__(self, problem):
        import siconos.numerics as numerics
        self.numerics, self.problem = numerics, problem
        matrix = problem if isinstance(problem, core.Problem) else problem.delassus()
        self.contacts, self.matrix = matrix.contacts, matrix
        # Through a file: Siconos's conversion in memory needs space for the square of the number of contacts.
        with tempfile.NamedTemporaryFile("w", suffix=".dat") as file:
            write_blocks(file, matrix)
            self.theirs = numerics.frictionContact_new_from_filename(file.name)

    def sweeps(self, impulses, count):
        """Make `count` sweeps from `impulses`, in place. Return their processor time [s]."""
        n = self.numerics
        options = n.SolverOptions(n.SICONOS_FRICTION_2D_NSGS)
        options.iparam[n.SICONOS_IPARAM_MAX_ITER] = count
        options.iparam[n.SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] = n.SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_ADAPTIVE
        options.dparam[n.SICONOS_DPARAM_TOL] = 1e-300
        velocities = np.zeros_like(impulses)
        begin = time.process_time()
        n.fc2d_driver(self.theirs, impulses, velocities, options)
        return time.process_time() - begin

    def history(self, impulses, target, most_seconds):
        """Return [(sweeps, seconds, e, e_max)] from a first guess until e is at most `target` or the seconds are used up."""
        p, made, seconds, points = impulses.copy(), 0, 0.0, []
        while True:
            points.append((made, seconds, core.residual(self.problem, p), core.residual_max(self.problem, p)))
            if not points[-1][2] > target or seconds >= most_seconds:
                return points
            count = max(FEWEST, int(made * (GROWTH - 1)))
            seconds += self.sweeps(p, count)
            made += count

    def lemke(self):
        """Return (impulses, status) of the pivoting solver; status 0 means that it reports success."""
        n = self.numerics
        dense = n.FrictionContactProblem(2, self.contacts, self.matrix.W.toarray(), self.matrix.q, self.matrix.mu)
        options = n.SolverOptions(n.SICONOS_FRICTION_2D_LEMKE)
        p, u = np.zeros(2 * self.contacts), np.zeros(2 * self.contacts)
        return p, n.fc2d_driver(dense, p, u, options)


def reached(points, target):
    """Return (sweeps, seconds, e, e_max) at which a history first meets a target, interpolated in log e, at least one sweep. None if it does not."""
    if points[0][2] <= target:
        return points[0]
    for before, after in zip(points, points[1:]):
        if after[2] <= target:
            fall = np.log(before[2] / after[2])  # infinite if e was infinite, as for zero impulses: then the later point counts
            share = np.log(before[2] / target) / fall if np.isfinite(fall) else 1.0
            sweeps = max(1.0, before[0] + share * (after[0] - before[0]))
            share = (sweeps - before[0]) / (after[0] - before[0])
            return (sweeps, before[1] + share * (after[1] - before[1])) + after[2:]
    return None
