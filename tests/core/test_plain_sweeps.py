"""No method fails, or takes far more sweeps, where plain Gauss-Seidel sweeps succeed."""
import numpy as np
import pytest
from scipy import sparse

from cd_engine import core


@pytest.mark.parametrize("coupling", [0.01, 0.1, 1])
def test_momentum_that_swings_leaves_plain_sweeps_their_share(coupling):
    """accelerated solves what nsgs solves, in at most three times its sweeps or 300: momentum comes first, so one bound for both cannot be had."""
    n = 8
    problem = core.Problem(np.eye(2 * n) + coupling * np.ones((2 * n, 2 * n)), -np.ones(2 * n), np.full(n, 0.3))
    for tolerance in (1e-2, 1e-4, 1e-6):
        plain = core.solve(problem, method="nsgs", tolerance=tolerance, max_iterations=10000)
        assert plain.converged
        assert core.solve(problem, method="accelerated", tolerance=tolerance, max_iterations=max(300, 3 * plain.iterations)).converged


def definite(seed):
    """Symmetric positive definite, of up to 60 contacts: all coupled alike, any spectrum up to 1e6, sparse, rows of different size."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 60))
    kind = seed % 4
    if kind == 0:
        W = np.eye(2 * n) + random.uniform(0, 0.05) * np.ones((2 * n, 2 * n))
    elif kind == 1:
        Q = np.linalg.qr(random.standard_normal((2 * n, 2 * n)))[0]
        W = Q @ np.diag(np.geomspace(1, 10**random.uniform(0, 6), 2 * n)) @ Q.T
    elif kind == 2:
        H = sparse.random(4 * n, 2 * n, density=min(1, 2 / n), random_state=seed, data_rvs=random.standard_normal).toarray()
        W = H.T @ H + 10**random.uniform(-6, 0) * np.eye(2 * n)
    else:
        H = np.abs(random.standard_normal((2 * n, 2 * n)))
        W = H.T @ H / n + 10**random.uniform(-4, 0) * np.eye(2 * n)
    q = random.standard_normal(2 * n) if random.random() < 0.5 else np.tile([-1.0, -1.0], n)
    return core.Problem((W + W.T) / 2, q, np.full(n, random.choice([0, 0.1, 0.3, 0.6, 1.0])))


@pytest.mark.parametrize("form", ["matrix", "bodies"])
def test_no_method_does_worse_than_plain_sweeps(form):
    """On positive definite W each solves what nsgs solves, in three times its sweeps and 600: 100 before plain sweeps are tried beside momentum,
    which then make a quarter to all of its number, and 500 at the start of newton. In the form of bodies momentum first has to be in vain for
    3000."""
    for seed in range(200 if form == "matrix" else 40):
        problem = definite(seed) if form == "matrix" else heap(seed)
        plain = core.solve(problem, method="nsgs", max_iterations=10000)
        assert plain.status != "no_solution"
        for method in ("accelerated", "newton", "auto"):
            report = core.solve(problem, method=method, max_iterations=100000)
            assert report.status != "no_solution"
            if plain.converged:
                most = 3 * plain.iterations + (600 if form == "matrix" else 9000)
                assert report.converged and report.iterations <= most, (seed, method, plain, report)


def heap(seed):
    """A tree of bodies in contact, each held by the one before: W is positive definite."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 40))
    angle = random.uniform(0, np.pi, n)
    masses = 10**random.uniform(-1, 1, n + 1)
    return core.BodyProblem(np.outer(np.where(np.arange(n + 1), 1 / masses, 0), [1, 1, 2]),
                            np.where(np.arange(n + 1)[:, None], random.standard_normal((n + 1, 3)), 0),
                            np.stack([[int(random.integers(0, i + 1)) for i in range(n)], np.arange(1, n + 1)], axis=1),
                            np.stack([np.cos(angle), np.sin(angle)], axis=1), np.tile([0, 1, 0, -1.0], (n, 1)), random.uniform(-0.1, 0.1, n),
                            np.full(n, random.choice([0, 0.3, 1.0])))


def test_all_contacts_coupled_alike():
    """With momentum for each contact separately the sweeps would oscillate for ever here; plain sweeps need some 250."""
    n = 500
    W = np.eye(2 * n) + 0.04
    for q in (-np.ones(2 * n), np.tile([-1.0, 0.0], n)):
        problem = core.Problem(W, q, np.full(n, 0.3))
        plain = core.solve(problem, method="nsgs")
        for method in ("accelerated", "auto"):
            report = core.solve(problem, method=method)
            assert report.converged and report.iterations <= 2 * plain.iterations + 400
            assert core.residual(problem, report.impulses) <= 1e-8
