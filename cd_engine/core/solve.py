"""Solves a problem, and tells how well one is solved."""
import math
import numbers
import operator
from dataclasses import dataclass

import numpy as np

from .problem import Problem, vector


@dataclass(frozen=True)
class Report:
    """What came of a solution."""
    impulses: np.ndarray      # [N s], 2n, normal then tangential: the best that were met if it did not converge
    iterations: int           # sweeps
    residual: float           # the error e of `residual`
    residual_max: float       # that of the worst contact over the root mean square of the impulses
    converged: bool
    status: str               # converged, fixed_iterations, max_iterations, stagnated, diverged
    seconds: float            # spent in the solver


def _core():
    try:
        from . import _core
    except ImportError as error:
        raise ImportError(f"the solvers of cd_engine.core are not built ({error}): run `make build` at the top of the repository.") from None
    return _core


def methods():
    """Names of the methods that `solve` knows."""
    return list(_core().methods())


def _arrays(problem):
    """The problem as the compiled core takes it: rows of 2 x 2 blocks, checked anew since its arrays may have been changed."""
    problem = Problem(problem.W, problem.q, problem.mu)
    if problem.contacts == 0:
        empty = np.zeros(0)
        return np.zeros(1, np.int64), np.zeros(0, np.int32), empty, empty, empty
    blocks = problem.W.tobsr((2, 2))
    blocks.sort_indices()
    return blocks.indptr.astype(np.int64), blocks.indices.astype(np.int32), blocks.data.ravel(), problem.q, problem.mu


def _count(name, value, least):
    try:
        count = operator.index(value)
    except TypeError:
        raise ValueError(f"{name}={value!r} is not a whole number") from None
    if not least <= count < 2**31:
        raise ValueError(f"{name}={count} is out of range: it must be at least {least} and below 2^31")
    return count


def solve(problem, method="accelerated", tolerance=1e-8, max_iterations=100000, impulses=None, *, fixed_iterations=0, seed=0):
    """Impulses that solve `problem` to an error e (see `residual`), and the same weighted by W_nn, of at most `tolerance`.

    method            one of `methods()`
    max_iterations    sweeps; plain Gauss-Seidel can ask for 1e5 to reach 1e-8
    impulses          first guess [N s]; none: zero
    fixed_iterations  positive: exactly so many plain Gauss-Seidel sweeps, whatever the method, and no test
    seed              positive: every sweep in a new random order drawn from it

    A problem that is not solved is no exception: the report's `status` says so and it holds the best impulses met. Input that makes no sense is a
    ValueError. Costs about 7 n blocks of W a sweep for disks in a dense packing; matrix and impulses are copied once.
    """
    core = _core()
    if method not in core.methods():
        raise ValueError(f"method={method!r} is not known; there is {', '.join(map(repr, core.methods()))}")
    if not (isinstance(tolerance, numbers.Real) and math.isfinite(tolerance) and tolerance > 0):
        raise ValueError(f"tolerance={tolerance!r} is out of range: it must be a positive number")
    max_iterations = _count("max_iterations", max_iterations, 1)
    fixed_iterations = _count("fixed_iterations", fixed_iterations, 0)
    seed = _count("seed", seed, 0)
    start, column, blocks, q, mu = _arrays(problem)
    p = np.zeros(len(q)) if impulses is None else vector("impulses", impulses, len(q)).copy()
    iterations, e, worst, status, seconds = core.solve(
        start, column, blocks, q, mu, p, method, float(tolerance), max_iterations, fixed_iterations, seed)
    return Report(p, iterations, e, worst, status == "converged" or (status == "fixed_iterations" and e <= tolerance), status, seconds)


def residual(problem, impulses):
    """The error e of impulses p, computed by code that shares nothing with the solvers.

    e = ||p - P_K(p - (u + mu |u_t| n)/W_nn)|| / ||p||, 2-norms over all contacts: u = W p + q, W_nn each contact's own normal compliance,
    K Coulomb's cone, P_K the Euclidean projection on it. The term mu |u_t| n of De Saxce makes e = 0 the exact, non-associated law (Acary,
    Bremond & Huber 2018, hal-01630836, section 2). Differences below the round-off of u count as none; without impulses e is 0 where no
    contact is violated, else infinite.
    """
    arrays = _arrays(problem)
    return _core().residual(*arrays, vector("impulses", impulses, 2 * len(arrays[-1])))[0]
