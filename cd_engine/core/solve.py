"""Solves contact problems, and computes the error of a solution."""
import numbers
import operator
import sys
from dataclasses import dataclass, replace

import numpy as np

from .files.body_problem import BodyProblem
from .files.problem import LARGEST, Problem, vector
from .files.space_bodies import SpaceBodyProblem, tangents

MOST_IN_MATRIX = 5000  # contacts of spheres up to which Newton's method is tried where sweeps fail


@dataclass(frozen=True)
class Report:
    """The result of `solve`."""
    impulses: np.ndarray      # [N s], 2n, in space 3n, normal then tangential: the best ones found if it did not converge
    iterations: int           # sweeps and factorizations
    factorizations: int       # of these iterations; above 0: Newton's method was used
    residual: float           # the error e of `residual`
    residual_max: float       # error of the worst contact over the root mean square of the impulses
    converged: bool
    status: str               # converged, fixed_iterations, max_iterations, stagnated, diverged, no_solution, indefinite
    contact: object           # where velocities are not resolved or, with no_solution, contacts must close; diverged: of NaN or infinity; else None
    bodies: object            # for a problem of bodies, the two bodies of that contact; else None
    solved_by: str            # the method that reached the tolerance, or none
    seconds: float            # of the calling thread's processor time, spent in the solver
    trace: object = None      # with trace=True: rows (sweeps and factorizations made so far, error), one for each check of the error


def _core():
    try:
        from . import _core
    except ImportError as error:
        raise ImportError(f"the solvers of cd_engine.core are not built ({error}): run `make build` at the top of the repository.") from None
    return _core


def methods():
    """Return the names of the methods that `solve` knows."""
    return list(_core().methods())


def instruction_sets():
    """Return the names of the instruction sets that sweeps over bodies can use on this processor, the fastest first."""
    return list(_core().instruction_sets())


def use_instruction_set(name):
    """Use this one of `instruction_sets()` in sweeps from now on. For comparisons of speed; the results have the same bits with all of them."""
    _core().use_instruction_set(name)


def bytes_of_a_sweep():
    """Return the memory that sweeps over bodies read [bytes]: for a contact, for its impulses of the sweep before (with momentum), for a body."""
    return tuple(_core().bytes_of_a_sweep())


def _arrays(problem):
    """Return the problem's arrays for the compiled core: those of the bodies, or the rows of W in 2 x 2 or 3 x 3 blocks. They are checked anew, since
    they may have been changed."""
    if isinstance(problem, BodyProblem):
        problem = replace(problem)
        return (problem.inverse_masses, problem.free_velocities, problem.pairs, problem.normals, problem.arms, problem.bias, problem.mu,
                problem.compliances, problem.slip_bias)
    if isinstance(problem, SpaceBodyProblem):
        problem = replace(problem).delassus()
    if not isinstance(problem, Problem):
        raise ValueError(f"{problem!r} is no contact problem: make a core.Problem of W, q and mu, or a core.BodyProblem")
    problem = Problem(problem.W, problem.q, problem.mu, problem.dimension)
    if problem.contacts == 0:
        empty = np.zeros(0)
        return np.zeros(1, np.int64), np.zeros(0, np.int32), empty, empty, empty
    blocks = problem.W.tobsr((problem.dimension, problem.dimension))
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


def solve(problem, method="auto", tolerance=1e-8, max_iterations=100000, impulses=None, *, fixed_iterations=0, seed=0, threads=1, trace=False):
    """Return a `Report` with impulses that solve `problem` to an error e (see `residual`), and the same weighted by W_nn, of at most `tolerance`.

    method            one of `methods()`. nsgs: plain Gauss-Seidel sweeps; accelerated: sweeps with momentum; newton: proximal-point semismooth
                      Newton, for small problems; auto: accelerated, and newton if that stagnates (up to about 1 s more). If one of the last
                      three makes no progress, plain sweeps are tried as well
    max_iterations    sweeps and factorizations together, never exceeded; plain Gauss-Seidel may need 1e5 to reach 1e-8
    impulses          first guess [N s], by default zero. It is ignored if it is 1e11 times larger than what would stop each closing contact alone
    fixed_iterations  positive: exactly so many plain Gauss-Seidel sweeps, whatever the method, and no test
    seed              positive: every sweep in a new random order, drawn from this seed
    threads           number of threads for a large `BodyProblem`; the result has the same bits with any number. A `Problem` uses one thread
    trace             also record the error of all methods tried, one after the other (`Report.trace`). It jumps where the next method begins, and is
                      infinite while no contact carries a load

    A problem that is not solved raises no exception: `status` in the report says so, and the report holds the best impulses found. Input of a wrong
    kind or out of range raises ValueError. `converged`: the error is within the tolerance, and no contact closes, or parts under load, by more than
    ten tolerances of the fastest closing without impulses. `no_solution`: proven, since no velocities (of a matrix problem, W p + q) keep all
    contacts from closing. `stagnated` or `max_iterations` with a `contact`: impulses grew, and neither a solution nor such a proof was found.
    `indefinite`: the same, and p^T W p is negative, which is impossible in mechanics. In a dense packing of disks a sweep reads about 7 n blocks of
    W, but for a `BodyProblem` only the n contacts. The arrays are copied once. Ctrl-C ends the search, except with `fixed_iterations`.
    """
    core = _core()
    if not isinstance(method, str) or method not in core.methods():
        raise ValueError(f"method={method!r} is not known; there is {', '.join(map(repr, core.methods()))}")
    if not (isinstance(tolerance, numbers.Real) and 0 < tolerance <= sys.float_info.max):
        raise ValueError(f"tolerance={tolerance!r} is out of range: it must be a positive number")
    max_iterations = _count("max_iterations", max_iterations, 1)
    fixed_iterations = _count("fixed_iterations", fixed_iterations, 0)
    seed = _count("seed", seed, 0)
    threads = _count("threads", threads, 1)
    if threads > 1024:
        raise ValueError(f"threads={threads} is out of range: it must be at most 1024")
    if isinstance(problem, SpaceBodyProblem) and method != "newton" and (spheres := replace(problem).spheres()) is not None:
        p = None if impulses is None else vector("impulses", impulses, 3 * problem.contacts)
        factorizes = method == "auto" and problem.contacts <= MOST_IN_MATRIX
        most = (max_iterations + 1) // 2 if factorizes else max_iterations  # sweeps
        report = _solve_spheres(spheres, problem, method, tolerance, most, p, fixed_iterations, seed, threads, trace)
        left = max_iterations - report.iterations
        if not factorizes or report.converged or fixed_iterations > 0 or left <= 0:
            return report
        rest = solve(problem.delassus(), method, tolerance, left, report.impulses, seed=seed, trace=trace)
        evaluations = np.vstack([report.trace, rest.trace + [report.iterations, 0]]) if trace else None
        return replace(rest, iterations=rest.iterations + report.iterations, seconds=rest.seconds + report.seconds, trace=evaluations)
    arrays = _arrays(problem)
    size = problem.dimension * len(arrays[-1])
    p = np.zeros(size) if impulses is None else vector("impulses", impulses, size)
    p, found = core.solve(arrays, p, method, float(tolerance), max_iterations, fixed_iterations, seed, bool(trace), threads)
    return _report(problem, np.frombuffer(p).copy(), found, tolerance, trace)


def _solve_spheres(spheres, problem, method, tolerance, max_iterations, impulses, fixed_iterations, seed, threads, trace):
    """Solve by sweeps over the bodies, which know friction as a vector of the world."""
    axes = np.stack([problem.normals, *tangents(problem.normals)], axis=1)
    p = np.zeros((problem.contacts, 4))
    if impulses is not None:
        guess = impulses.reshape(-1, 3)
        p[:, 0], p[:, 1:] = guess[:, 0], np.einsum("nk,nkj->nj", guess[:, 1:], axes[:, 1:])
    p, found = _core().solve_spheres(spheres, p, method != "nsgs", float(tolerance), max_iterations, fixed_iterations, seed, bool(trace), threads)
    p = np.frombuffer(p).reshape(-1, 4)
    p = np.column_stack([p[:, 0], np.einsum("nj,nkj->nk", p[:, 1:], axes[:, 1:])])
    return _report(problem, p.ravel(), found, tolerance, trace)


def _report(problem, p, found, tolerance, trace):
    iterations, factorizations, e, worst, error, status, contact, solved_by, seconds, evaluations = found
    converged = status == "converged" or (status == "fixed_iterations" and error <= tolerance)
    contact = contact if contact >= 0 and not converged else None
    bodies = tuple(map(int, problem.pairs[contact])) if not isinstance(problem, Problem) and contact is not None else None
    evaluations = np.array(evaluations, float).reshape(-1, 2) if trace else None
    return Report(p, iterations, factorizations, e, worst, converged, status, contact, bodies, solved_by, seconds, evaluations)


def residual(problem, impulses):
    """Return the error e of impulses p, computed anew from the impulses; tests compare it with its definition.

    e = ||p - P_K(p - (u + mu |u_t| n)/W_nn)|| / ||p||, 2-norms over all contacts: u = W p + q, W_nn each contact's inverse effective mass in
    the normal direction [1/kg], K Coulomb's cone, P_K the Euclidean projection on it. The term mu |u_t| n of De Saxce makes e = 0 the exact,
    non-associated law (Acary, Bremond & Huber 2018, hal-01630836, section 2). Differences below the round-off of u count as zero. If all impulses are
    zero, e is 0 if no contact is violated, else infinite.
    """
    return _residuals(problem, impulses)[0]


def residual_max(problem, impulses):
    """Return the same error for the worst contact alone, over the root mean square of the impulses."""
    return _residuals(problem, impulses)[1]


def _residuals(problem, impulses):
    arrays = _arrays(problem)
    p = vector("impulses", impulses, problem.dimension * len(arrays[-1]))
    if (largest := np.abs(p).max(initial=0)) > LARGEST:
        raise ValueError(f"impulses are up to {largest:g}; squares can be computed of numbers up to {LARGEST:g}")
    return _core().residual(arrays, p)
