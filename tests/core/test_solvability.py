"""What has no solution is named and never counts as solved: compared with all contact states of small problems and with problems built so."""
import itertools

import numpy as np
import pytest

from cd_engine import core

from .test_problem import packed


HOPELESS = [[1, 0, -1, 0], [0, 1, 0, 0], [-1, 0, 1, 0], [0, 0, 0, 1]]  # an impulse that opens one contact closes the other


@pytest.mark.parametrize("method", core.methods())
@pytest.mark.parametrize("tolerance", [1e-2, 1e-5, 1e-8, 1e-11])
def test_what_has_no_solution_is_named(method, tolerance):
    """Both contacts close at 1 m/s, and neither can open without closing the other: impulses grow for ever, so an error relative to them falls."""
    report = core.solve(core.Problem(HOPELESS, [-1, 0, -1, 0], [0, 0]), method=method, tolerance=tolerance, max_iterations=5000)
    assert not report.converged and report.status == "no_solution" and report.contact in (0, 1) and report.bodies is None
    assert report.solved_by == "none" and report.iterations <= 5000


def solutions(W, q, mu):
    """The impulses that solve a problem of few contacts exactly. All combinations of open, sticking and sliding contacts are tried."""
    n = len(mu)
    for states in itertools.product(("open", "stick", 1, -1), repeat=n):  # +-1: slides, with p_t on this side
        columns, rows = [], []
        for i, state in enumerate(states):
            if state == "open":
                continue
            normal, tangential = np.eye(2 * n)[2 * i], np.eye(2 * n)[2 * i + 1]
            columns += [normal, tangential] if state == "stick" else [normal + state * mu[i] * tangential]
            rows += [2 * i, 2 * i + 1] if state == "stick" else [2 * i]
        S = np.array(columns).reshape(-1, 2 * n).T
        p = S @ np.linalg.lstsq((W @ S)[rows], -q[rows], rcond=1e-10)[0] if rows else np.zeros(2 * n)
        u = W @ p + q
        # 1e-9: round-off of a few sums and of the least squares, which leave out singular values below 1e-10.
        speed, push = 1e-9 * (np.abs(W) @ np.abs(p) + np.abs(q)).max(), 1e-9 * np.abs(p).max()
        fits = {"open": lambda un, ut, pn, pt, m: un >= -speed,
                "stick": lambda un, ut, pn, pt, m: max(abs(un), abs(ut)) <= speed and pn >= -push and abs(pt) <= m * pn + push,
                1: lambda un, ut, pn, pt, m: abs(un) <= speed and pn >= -push and ut <= speed,
                -1: lambda un, ut, pn, pt, m: abs(un) <= speed and pn >= -push and ut >= -speed}
        if all(fits[state](*u[2 * i:2 * i + 2], *p[2 * i:2 * i + 2], mu[i]) for i, state in enumerate(states)):
            yield p


def singular(seed):
    """W = H^T H of up to three contacts, mostly of low rank: about one in ten has no solution."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 4))
    shape = int(random.integers(1, 2 * n + 1)), 2 * n
    H = random.standard_normal(shape) if random.random() < 0.5 else random.integers(-1, 2, shape).astype(float)
    H[0] += ~H.any(axis=0)  # a diagonal without zeros
    q = random.standard_normal(2 * n) if random.random() < 0.5 else random.integers(-1, 2, 2 * n).astype(float)
    return H.T @ H, q, random.choice([0, 0, 0.1, 0.3, 1.0], n)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
@pytest.mark.parametrize("method", core.methods())
def test_converged_means_solved(method, tolerance):
    """Singular problems, compared with all states of their contacts: one without a solution is never reported as solved, and mostly named."""
    named = hopeless = 0
    for seed in range(100):
        W, q, mu = singular(seed)
        report = core.solve(core.Problem(W, q, mu), method=method, tolerance=tolerance, max_iterations=10000)
        exact = next(solutions(W, q, mu), None)
        assert report.iterations <= 10000
        if exact is None:
            hopeless += 1
            named += report.status == "no_solution"
            assert not report.converged, (seed, report)
        elif report.converged:
            p, u = report.impulses, W @ report.impulses + q
            # Velocities are right to the tolerance times the impulses, and these are at most 1e4 times those a closing contact asks for.
            allowed = 3 * tolerance * np.sqrt(len(p)) * np.abs(W).max() * np.abs(p).max() + 1e-12
            assert np.all(u[::2] >= -allowed) and np.all(np.abs(p[1::2]) <= mu * p[::2] + 1e-12 * np.abs(p).max()), (seed, report)
            assert np.all(np.minimum(np.abs(u[::2]), W.diagonal()[::2] * p[::2]) <= allowed), (seed, report)
        elif not mu.any():  # with friction, impulses may grow along a self-stress although another motion solves the problem
            assert report.status != "no_solution", (seed, report)
    assert hopeless > 5 and named >= 0.7 * hopeless  # sweeps that oscillate without growing along a self-stress prove nothing


def off_range(seed):
    """W = H^T H without friction, half of them with a self-stress; q is in the range of W except for a part of 1e-9 to 1 of it."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 9))
    H = random.normal(size=(random.integers(1, n + 2), 2 * n))
    if random.random() < 0.5:
        H[:, -2] = -H[:, :-2:2] @ random.uniform(0.1, 1, n - 1)
    q = H.T @ random.normal(size=len(H))
    q[::2] += 10.0 ** random.integers(-9, 1) * random.normal(size=n)
    return H.T @ H, q


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6, 1e-10])
@pytest.mark.parametrize("method", core.methods())
def test_converged_closes_nothing(method, tolerance):
    """If W has no solution, impulses that grow along a self-stress do not count as solved, however small the error relative to them.

    Up to a hundred times the impulses that each contact alone would need, the solvers do not check for growth along a self-stress.
    """
    for seed in range(100):
        W, q = off_range(seed)
        report = core.solve(core.Problem(W, q, np.zeros(len(q) // 2)), method=method, tolerance=tolerance, max_iterations=20000)
        if report.converged:
            W, q = W[::2, ::2], q[::2]
            root = np.sqrt(W.diagonal())  # impulses times it and velocities over it have one unit
            allowed = 100 * tolerance * np.linalg.norm(np.minimum(q, 0) / root) * np.linalg.norm(W / np.outer(root, root), 2)
            assert ((W @ report.impulses[::2] + q) / root).min() >= -allowed, (seed, report)


@pytest.mark.parametrize("method", core.methods())
def test_indefinite(method):
    """W is symmetric with a positive diagonal, but not mechanical: a result that counts as solved satisfies the law, others are often named."""
    random = np.random.default_rng(7)
    statuses = []
    for _ in range(100):
        n = int(random.integers(1, 4))
        A = random.standard_normal((2 * n, 2 * n))
        W = A + A.T
        np.fill_diagonal(W, np.abs(W.diagonal()) + 0.1)
        q, mu = random.standard_normal(2 * n), random.choice([0, 0.3, 1.0], n)
        with np.errstate(over="ignore", invalid="ignore"):
            report = core.solve(core.Problem(W, q, mu), method=method, max_iterations=5000)
            statuses.append(report.status)
            assert not report.converged or (np.abs(report.impulses).max() < 1e8 and next(solutions(W, q, mu), None) is not None), report
    assert statuses.count("indefinite") >= 3 and set(statuses) <= {"converged", "indefinite", "diverged", "stagnated", "max_iterations"}


def test_impulses_beyond_every_bound_are_no_solution():
    """Walls close in on a body whose escape is blocked except for a share of 1e-14: the only solution has impulses 1e14 times larger."""
    escape = 1e-14
    W = np.diag([1.0, 1, 1, 1])
    W[0, 2] = W[2, 0] = -1 + escape
    for method in core.methods():
        report = core.solve(core.Problem(W, [-1, 0, -1, 0], [0, 0]), method=method, max_iterations=5000)
        assert not report.converged and report.status == "no_solution"
    # As first guesses they are not used.
    problem = packed(10, 3)
    for guess in (1e200, 1e308, 1e30):
        assert np.array_equal(core.solve(problem, impulses=np.full(20, guess)).impulses, core.solve(problem).impulses)


def pressed(seed):
    """A frictionless problem without a solution: impulses d >= 0 whose velocities W d vanish, and d . q < 0."""
    r = np.random.default_rng(seed)
    n = r.integers(3, 30)
    normal, tangential = r.normal(size=(2, n, 3 * n // 4 + 1))
    d = np.zeros(n)
    d[r.choice(n, r.integers(2, n + 1), replace=False)] = 1
    d *= r.random(n) + 0.1
    last, q = np.flatnonzero(d)[-1], r.normal(size=n)
    normal[last] = -(d @ normal - d[last] * normal[last]) / d[last]
    q[last] -= (d @ q + np.linalg.norm(d)) / d[last]
    H = np.stack([normal, tangential], axis=1).reshape(2 * n, -1)
    return core.Problem(H @ H.T, np.stack([q, 0 * q], axis=1).ravel(), np.zeros(n))


@pytest.mark.parametrize("method", ["nsgs", "accelerated", "newton", "auto"])
@pytest.mark.parametrize("tolerance", [3e-2, 1e-2, 1e-3, 1e-4])
def test_what_counts_as_solved_closes_by_ten_tolerances_at_most(method, tolerance):
    """e is small long before the impulses have grown enough to show that no solution exists. The closing is relative to that without impulses."""
    solved = 0
    for seed in range(15):
        problem = pressed(seed)
        report = core.solve(problem, method=method, tolerance=tolerance, max_iterations=5000)
        solved += report.converged
        assert not report.converged or -(problem.W @ report.impulses + problem.q)[::2].min() <= 10 * tolerance * -problem.q[::2].min()
    assert solved < 8 and (solved == 0 or tolerance >= 1e-2)
