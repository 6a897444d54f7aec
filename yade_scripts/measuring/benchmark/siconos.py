"""Runs Siconos's Gauss-Seidel, fc2d_nsgs or in space fc3d_nsgs, on the same W, q and mu.

It gets W in sparse blocks, its fastest storage here. It keeps no state between calls, so it can be stopped every few sweeps and
continues with the same bits. Only its sweeps are timed, without its own stopping test (which uses another measure than e); our code
computes the error e in between. So this is the shortest time in which Siconos can reach an error e.
"""
import importlib
import tempfile
import time
from collections import namedtuple

import numpy as np

from cd_engine import core

GROWTH = {2: 1.05, 3: 1.2}  # of the sweeps between two checks of the error, by dimension; the time to a target is interpolated
FEWEST = 4
LOCAL = "ONECONTACT_NSN_GP_HYBRID"  # its solver of one contact in space, the usual choice of NSGS

Point = namedtuple("Point", "sweeps seconds residual residual_max")  # how far a solution has come: e as 2-norm and as maximum


def available():
    """Return why Siconos cannot be used, None if it can."""
    try:
        importlib.import_module("siconos.numerics")
    except ImportError as error:
        return f"python3-siconos is not installed ({error})"
    return None


def write_blocks(file, problem):
    """Write the text in which Siconos reads a problem with W in sparse blocks; 17 digits give every number exactly."""
    n, d = problem.contacts, problem.dimension
    W = problem.W.tobsr((d, d))
    W.sort_indices()
    count, ends = len(W.indices), range(d, d * n + 1, d)
    for line in ([d], [n], [1], [d * n], [d * n], [count], [n], [n], ends, ends, [n + 1], [count], W.indptr, W.indices):
        file.write(" ".join(map(str, line)) + "\n")
    blocks = W.data.transpose(0, 2, 1).reshape(-1, d * d)  # each block by columns
    np.savetxt(file, np.column_stack([np.arange(count), blocks]), "%d" + d * d * "\n%.17g")
    np.savetxt(file, np.concatenate([problem.q, problem.mu]), "%.17g")
    file.flush()


class Peer:
    """One problem in Siconos's own data structures."""

    def __init__(self, problem):
        import siconos.numerics as numerics
        self.numerics, self.problem = numerics, problem
        self.matrix = problem if isinstance(problem, core.Problem) else problem.delassus()
        if self.matrix.dimension == 3:
            self.problem = self.matrix  # its error costs less
        self.contacts = self.matrix.contacts
        # Through a file: Siconos's conversion in memory needs space for the square of the number of contacts.
        with tempfile.NamedTemporaryFile("w", suffix=".dat") as file:
            write_blocks(file, self.matrix)
            self.theirs = numerics.frictionContact_new_from_filename(file.name)

    def sweeps(self, impulses, count):
        """Make `count` sweeps from `impulses`, in place. Return their processor time [s]."""
        n, plane = self.numerics, self.matrix.dimension == 2
        options = n.SolverOptions(n.SICONOS_FRICTION_2D_NSGS if plane else n.SICONOS_FRICTION_3D_NSGS)
        if not plane:
            n.solver_options_update_internal(options, 0, getattr(n, f"SICONOS_FRICTION_3D_{LOCAL}"))
        options.iparam[n.SICONOS_IPARAM_MAX_ITER] = count
        options.iparam[n.SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] = n.SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_ADAPTIVE
        options.dparam[n.SICONOS_DPARAM_TOL] = 1e-300
        velocities = np.zeros_like(impulses)
        begin = time.process_time()
        (n.fc2d_driver if plane else n.fc3d_driver)(self.theirs, impulses, velocities, options)
        return time.process_time() - begin

    def history(self, impulses, target, most_seconds):
        """Return the Points from a first guess until e is at most `target` or the seconds are used up."""
        p, points = impulses.copy(), []
        made, seconds = 0, 0.0
        while True:
            points.append(Point(made, seconds, core.residual(self.problem, p), core.residual_max(self.problem, p)))
            if not points[-1].residual > target or seconds >= most_seconds:
                return points
            count = max(FEWEST, int(made * (GROWTH[self.matrix.dimension] - 1)))
            seconds += self.sweeps(p, count)
            made += count


def reached(points, target):
    """Return the Point at which a history first meets a target, interpolated in log e, after at least one sweep. None if it does not."""
    if points[0].residual <= target:
        return points[0]
    for before, after in zip(points, points[1:]):
        if after.residual <= target:
            fall = np.log(before.residual / after.residual)  # infinite if e was infinite, as for zero impulses: then the later point counts
            share = np.log(before.residual / target) / fall if np.isfinite(fall) else 1.0
            sweeps = max(1.0, before.sweeps + share * (after.sweeps - before.sweeps))
            seconds = np.interp(sweeps, [before.sweeps, after.sweeps], [before.seconds, after.seconds])
            return after._replace(sweeps=sweeps, seconds=float(seconds))
    return None
