"""What is no problem, and settings that make no sense, are refused in one sentence each."""
import contextlib
import signal
import time

import numpy as np
import pytest
from scipy import sparse

from cd_engine import core
from cd_engine.core.solve import _arrays, _core

from .test_problem import packed

GOOD = np.diag([2.0, 3.0, 2.0, 3.0])


@pytest.mark.parametrize("W, q, mu, words", [
    (np.ones((4, 2)), np.zeros(4), [0, 0], "4 x 2"),
    (np.eye(5), np.zeros(5), [0], "even"),
    (np.eye(4) * np.nan, np.zeros(4), [0, 0], r"W\[0, 0\]"),
    (GOOD + np.pad([[0, np.inf]], ((0, 3), (0, 2))), np.zeros(4), [0, 0], r"W\[0, 1\]"),
    (np.diag([2.0, 3, 0, 3]), np.zeros(4), [0, 0], r"W\[2, 2\].*normal inverse effective mass of contact 1"),
    (np.diag([2.0, 3, 2, -3]), np.zeros(4), [0, 0], r"W\[3, 3\].*tangential inverse effective mass of contact 1"),
    (sparse.csr_matrix((4, 4)), np.zeros(4), [0, 0], r"W\[0, 0\]"),
    (GOOD, np.zeros(3), [0, 0], "q has the shape"),
    (GOOD, np.zeros((4, 1)), [0, 0], "q has the shape"),
    (GOOD, [0, np.nan, 0, 0], [0, 0], r"q\[1\]"),
    (GOOD, [-1e200, 0, 0, 0], [0, 0], r"velocities q are up to 1e\+200.*units"),
    (GOOD, [-1e-165, 0, 0, 0], [0, 0], "velocities q are up to 1e-165.*units"),
    (GOOD * 1e-170, -np.ones(4), [0, 0], r"impulses q/W are up to 5e\+169.*units"),
    (GOOD * 1e170, -np.ones(4), [0, 0], "impulses q/W are up to 5e-171.*units"),
    (GOOD, np.zeros(4), [0, 0, 0], "mu has the shape"),
    (GOOD, np.zeros(4), [0.5, -0.1], r"mu\[1\] = -0.1 is negative"),
    (GOOD, np.zeros(4), [np.inf, 0], r"mu\[0\]"),
    (GOOD, np.zeros(4), [0, 1e7], r"mu\[1\] = 1e\+07 is larger than 1e\+06"),
    (GOOD * 1j, np.zeros(4), [0, 0], "complex"),
    (GOOD, ["a"] * 4, [0, 0], "q is not an array of numbers"),
    ("W", np.zeros(4), [0, 0], "W is not a matrix"),
    (GOOD.astype(str), np.zeros(4), [0, 0], "W is not a matrix.*<U"),
    (np.where(GOOD, GOOD, None), np.zeros(4), [0, 0], "W is not a matrix.*None"),
    (np.ma.masked_equal(GOOD, 3), np.zeros(4), [0, 0], "W is not a matrix.*masked"),
    (GOOD, np.ma.masked_equal([1.0, 2, 3, 4], 3), [0, 0], "q is not an array.*masked"),
    (GOOD, np.zeros(4), np.ma.masked_equal([0.5, 0.2], 0.2), "mu is not an array.*masked"),
    (GOOD, ["1", "2", "3", "4"], [0, 0], "q is not an array.*<U1"),
    (GOOD, np.zeros(4, "M8[s]"), [0, 0], "q is not an array.*datetime"),
    (GOOD, [10**400, 0, 0, 0], [0, 0], "q is not an array.*too large"),
    (None, np.zeros(4), [0, 0], "W is not a matrix"),
])
def test_refused(W, q, mu, words):
    with pytest.raises(ValueError, match=words):
        core.Problem(W, q, mu)


@pytest.mark.parametrize("wrong", [None, 3, "problem.hdf5", (GOOD, np.zeros(4), [0, 0])])
def test_only_problems_are_solved(wrong):
    for call in (core.solve, lambda problem: core.residual(problem, np.zeros(4))):
        with pytest.raises(ValueError, match="no contact problem"):
            call(wrong)


def test_only_problems_are_written(tmp_path):
    with pytest.raises(ValueError, match="no contact problem"):
        core.write_problem(tmp_path / "none.h5", {"W": GOOD})
    for wrong, words in (({"title": 3}, "title=3 is not a text"), ({"contact_ids": [[1.9, 1]] * 2}, "contact_ids is not .* whole numbers"),
                         ({"contact_ids": [[2**32, 1]] * 2}, "32 bits"), ({"contact_ids": [1, 2]}, "shape")):
        with pytest.raises(ValueError, match=words):
            core.write_problem(tmp_path / "none.h5", core.Problem(GOOD, np.zeros(4), [0, 0]), **wrong)
    assert not list(tmp_path.iterdir())


def test_no_error_is_told_of_impulses_whose_squares_overflow():
    with pytest.raises(ValueError, match=r"impulses are up to 1e\+200"):
        core.residual(core.Problem(GOOD, -np.ones(4), [0, 0]), [1e200, 0, 0, 0])


def test_a_mask_that_hides_nothing_is_none():
    assert core.solve(core.Problem(np.ma.array(GOOD), np.ma.array(-np.ones(4)), np.ma.array([0.0, 0.0]))).converged


@pytest.mark.parametrize("wrong, words", [
    ({"method": "lemke"}, "lemke"), ({"tolerance": 0}, "tolerance"), ({"tolerance": np.nan}, "tolerance"), ({"tolerance": "small"}, "tolerance"),
    ({"max_iterations": 0}, "max_iterations"), ({"max_iterations": 2.5}, "max_iterations"), ({"fixed_iterations": -1}, "fixed_iterations"),
    ({"max_iterations": 2**31}, "max_iterations"), ({"tolerance": 10**400}, "tolerance"), ({"method": np.array(["nsgs", "auto"])}, "method"),
    ({"impulses": np.ma.masked_all(4)}, "masked"), ({"seed": -1}, "seed"), ({"impulses": [1.0]}, "impulses"),
    ({"impulses": [np.nan] * 4}, "impulses"),
])
def test_refused_by_solve(wrong, words):
    with pytest.raises(ValueError, match=words):
        core.solve(core.Problem(GOOD, np.zeros(4), [0, 0]), **wrong)


@pytest.mark.parametrize("method", ["nsgs", "newton"])  # the loop of all sweeps, and that of Newton's method
def test_a_signal_ends_a_solution(method):
    """Such as Ctrl-C: it comes after a tenth of the processor time that the solution takes, which then ends before half of that."""
    class Stop(Exception):
        pass

    def stop(*_):
        raise Stop
    draw = np.random.default_rng(1)
    half = draw.normal(size=(600, 300))
    arrays = _arrays(core.Problem(half @ half.T / 300, draw.normal(size=600) - 1, np.full(300, 0.5)))

    def solve():
        begin = time.process_time()
        with contextlib.suppress(Stop):
            _core().solve(arrays, np.zeros(600), method, 1e-300, 10**6, 0, 0, False, 1)
        return time.process_time() - begin
    whole = solve()
    before = signal.signal(signal.SIGPROF, stop)
    try:
        signal.setitimer(signal.ITIMER_PROF, whole / 10)
        assert solve() < whole / 2
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def test_a_problem_spoilt_later_is_refused_too():
    problem = packed(5, 1)
    problem.q[3] = np.nan
    with pytest.raises(ValueError, match=r"q\[3\]"):
        core.solve(problem)
    with pytest.raises(ValueError, match=r"q\[3\]"):
        core.residual(problem, np.zeros(10))
