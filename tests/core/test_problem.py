"""Problems given by their matrix: what the error e means, that every method reduces it to the tolerance, and what a report tells."""
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import sparse

from cd_engine import core


def packed(contacts, seed, mu=0.4):
    """A problem with W = H^T H + 0.3 I, where H has fewer rows than columns, as in a dense packing."""
    random = np.random.default_rng(seed)
    H = sparse.random(max(3, 3 * contacts // 2), 2 * contacts, density=min(1, 6 / contacts), random_state=seed, data_rvs=random.standard_normal)
    W = (H.T @ H + 0.3 * sparse.eye(2 * contacts)).tocsr()
    return core.Problem(W, random.standard_normal(2 * contacts) - np.tile([0.5, 0], contacts), np.full(contacts, mu))


def on_cone(mu, n, t):
    """Euclidean projection of (n, t) on |t| <= mu n as the nearest of three points: itself, the apex, the feet on the two edges."""
    if n >= 0 and abs(t) <= mu * n:
        return np.array([n, t])
    edge = [np.array([1, side * mu]) for side in (-1, 1)]
    feet = [max(0, e @ (n, t)) / (e @ e) * e for e in edge]
    return min(feet, key=lambda foot: np.hypot(*(foot - (n, t))))


def error(problem, p):
    """e from its definition, contact by contact."""
    u = problem.W.toarray() @ p + problem.q
    total = 0
    for i, mu in enumerate(problem.mu):
        own = problem.W[2 * i, 2 * i]
        n, t = p[2 * i] - (u[2 * i] + mu * abs(u[2 * i + 1])) / own, p[2 * i + 1] - u[2 * i + 1] / own
        total += np.sum((p[2 * i:2 * i + 2] - on_cone(mu, n, t)) ** 2)
    return np.sqrt(total) / np.linalg.norm(p)


NUMBER = st.floats(-10, 10).map(lambda x: round(x, 6))


MU = st.floats(0, 2).map(lambda x: round(x, 6))
POINT = arrays(float, 2, elements=NUMBER)


@given(MU, POINT, POINT)
@settings(deadline=None)
def test_projection(mu, a, b):
    """The projection the errors below are compared with: on the cone, idempotent, nonexpansive."""
    pa, pb = on_cone(mu, *a), on_cone(mu, *b)
    # 1e-13: round-off of numbers up to 10, some operations each.
    assert abs(pa[1]) <= mu * pa[0] + 1e-13
    assert np.allclose(on_cone(mu, *pa), pa, rtol=0, atol=1e-13)
    assert np.linalg.norm(pa - pb) <= np.linalg.norm(a - b) + 1e-13


@given(st.integers(1, 4), st.integers(0, 10**6), MU, st.data())
@settings(deadline=None)
def test_error_is_its_definition(contacts, seed, mu, data):
    problem = packed(contacts, seed, mu)
    p = data.draw(arrays(float, 2 * contacts, elements=NUMBER))
    if not p.any():
        return
    # 1e-12: both sum a few numbers of order 1 to 100.
    assert core.residual(problem, p) == pytest.approx(error(problem, p), rel=1e-12, abs=1e-12)


@given(MU, st.sampled_from(["open", "stick", "slide"]), st.floats(0.1, 5), st.floats(-1, 1), st.floats(0.1, 5))
@settings(deadline=None)
def test_no_error_where_the_law_holds(mu, state, pn, share, speed):
    """One contact in each state; and one if the velocity or the impulse is off it."""
    W = np.array([[2.0, 0.3], [0.3, 3.0]])
    side = 1 if share >= 0 else -1
    p = {"open": [0, 0], "stick": [pn, share * mu * pn], "slide": [pn, -side * mu * pn]}[state]
    u = {"open": [speed, share], "stick": [0, 0], "slide": [0, side * speed]}[state]
    solved = core.Problem(W, np.array(u) - W @ p, [mu])
    assert core.residual(solved, p) < 1e-13  # round-off
    off = core.residual(core.Problem(W, np.array(u) - [speed + 0.1, 0] - W @ p, [mu]), p)
    assert off > 1e-3  # closing: infinite where there is no impulse at all


@pytest.mark.parametrize("method", core.methods())
@pytest.mark.parametrize("mu", [0, 0.1, 0.8])
def test_every_method_solves(method, mu):
    problem = packed(60, 5, mu)
    report = core.solve(problem, method=method, tolerance=1e-10)
    assert report.converged and report.status == "converged" and report.iterations > 0 and report.seconds > 0
    assert report.residual <= 1e-10 and report.residual <= report.residual_max
    assert core.residual(problem, report.impulses) == report.residual
    assert error(problem, report.impulses) < 2e-10  # the definition, with its own round-off
    again = core.solve(problem, method=method, tolerance=1e-10, impulses=report.impulses)
    assert again.iterations == 0 and np.array_equal(again.impulses, report.impulses)


def test_units_do_not_matter():
    """Impulses of 1e-20 N s are solved as those of 1: the error has no scale."""
    problem = packed(30, 2)
    small = core.Problem(problem.W, problem.q * 2.0**-70, problem.mu)
    a, b = core.solve(problem), core.solve(small)
    assert a.iterations == b.iterations and np.array_equal(a.impulses * 2.0**-70, b.impulses)


def test_what_is_not_solved_says_so():
    problem = packed(60, 5)
    few = core.solve(problem, max_iterations=2, tolerance=1e-12)
    assert not few.converged and few.status == "max_iterations" and few.iterations == 2
    assert core.residual(problem, few.impulses) == few.residual


@pytest.mark.parametrize("method", core.methods())
def test_a_trace_tells_how_the_error_falls(method):
    """Its last row is the result, its rows before it are the errors of as many sweeps, and it changes nothing."""
    problem = packed(200, 3)
    report, without = core.solve(problem, method, 1e-9, trace=True), core.solve(problem, method, 1e-9)
    assert without.trace is None and (without.impulses == report.impulses).all()
    made, errors = report.trace.T
    assert (np.diff(made) >= 0).all() and made[0] == 0 and made[-1] == report.iterations and len(made) > 3
    assert (errors[:-1] > 1e-9).all() and errors[-1] <= 1e-9 and errors[-1] >= report.residual
    if method == "nsgs":
        own = problem.W.diagonal()[::2]
        weighted = np.sqrt(own.max() / own.min())  # by this the error weighted by W_nn may be larger
        for sweeps, found in report.trace[1:]:
            e = core.solve(problem, fixed_iterations=int(sweeps)).residual
            assert e * (1 - 1e-9) <= found <= weighted * e


def test_fixed_iterations_and_seed():
    problem = packed(60, 5)
    a, b = (core.solve(problem, method=method, fixed_iterations=9, seed=4) for method in ("nsgs", "accelerated"))
    assert a.iterations == 9 and a.status == "fixed_iterations" and np.array_equal(a.impulses, b.impulses)
    assert not np.array_equal(a.impulses, core.solve(problem, fixed_iterations=9, seed=5).impulses)


def test_given_sweeps_have_converged_only_if_the_solver_itself_would_accept_them():
    """A column with heavy bodies at its foot: e, relative to all impulses, is small long before its light bodies are carried."""
    masses = np.array([1e6, 1e3, 1, 1, 1])
    touching = np.array([[-1, 0], [0, 1], [1, 2], [2, 3], [3, 4]])  # -1: the ground
    heights = np.zeros((5, 5))  # column: body; row: contact
    for row, (low, high) in enumerate(touching):
        heights[row, high] += 1
        if low >= 0:
            heights[row, low] -= 1
    W, q = np.zeros((10, 10)), np.zeros(10)
    W[::2, ::2] = heights @ np.diag(1 / masses) @ heights.T
    W[1::2, 1::2] = np.diag(1 / masses)
    q[::2] = heights @ np.full(5, -1.0)
    problem = core.Problem(W, q, np.full(5, 0.5))
    enough = core.solve(problem, "nsgs", tolerance=1e-4).iterations
    few = core.solve(problem, fixed_iterations=2, tolerance=1e-4)
    assert enough > 10 and few.residual <= 1e-4 and not few.converged
    assert core.solve(problem, fixed_iterations=enough, tolerance=1e-4).converged


def test_nothing_given_is_changed_and_none_is_needed():
    problem = packed(20, 1)
    first = np.ones(40)
    before = problem.W.copy(), problem.q.copy()
    core.solve(problem, impulses=first)
    assert np.all(first == 1) and (problem.W != before[0]).nnz == 0 and np.array_equal(problem.q, before[1])
    none = core.Problem(sparse.csr_matrix((0, 0)), [], [])
    assert core.solve(none).converged and core.residual(none, []) == 0


def test_no_yade_is_needed(root):
    """Tested in a fresh interpreter without YADE."""
    import subprocess
    code = "import sys; sys.path.insert(0, sys.argv[1]); from cd_engine import core; core.methods(); assert 'yade' not in sys.modules"
    subprocess.run(["/usr/bin/python3", "-I", "-c", code, str(root)], check=True)


def test_who_solved_it():
    """solved_by is the method of sweeps if they suffice. The factorizations of Newton's method count among the iterations."""
    problem = packed(60, 5)
    a, b, c = (core.solve(problem, method=method) for method in ("accelerated", "auto", "newton"))
    assert np.array_equal(a.impulses, b.impulses) and b.solved_by == a.solved_by == "accelerated" and b.factorizations == 0
    assert c.solved_by == "newton" and 0 < c.factorizations <= c.iterations and core.residual(problem, c.impulses) == c.residual
    assert core.solve(problem, max_iterations=2, tolerance=1e-12).solved_by == "none"
