"""The loop in numbers, and the summary of the study of tolerance, on result files with known answers."""
import numpy as np
import pytest

from analysis import loops
from analysis.studies import tolerance
from tests.analysis.conftest import history, write
from yade_scripts.results import reader


def made(path, method="CD", scale=1e-3, row=None, seed=1):
    columns = history(method, scale=scale)
    if method == "CD":
        columns["iterations"] = np.full(len(columns["time"]), 7.0)
    write(path, method, columns=columns, row=row, seed=seed)
    return reader.load(path)


def test_numbers_of_a_known_loop(tmp_path):
    """gamma = -x^2 up and -(1 + 3x)/4 down: apart by (1 + 3x)/4 - x^2, which is 25/64 at x = 3/8 and less by the square away from it."""
    found = loops.of(made(tmp_path / "a.h5"))
    assert found["largest"] == pytest.approx(1e-3, rel=1e-12)
    assert found["remanent"] == pytest.approx(0.25e-3, rel=1e-12)
    # The nearest samples are at x = 0.37 and 0.38.
    assert found["width"] == pytest.approx(1e-3 * (25 / 64 - 0.005**2), rel=1e-9)


def test_a_cycle_that_is_not_complete_has_no_loop(tmp_path):
    run = made(tmp_path / "a.h5")
    run.history["cycle"] = 0.9 * run.history["cycle"]
    with pytest.raises(reader.ResultError, match="first cycle is not complete"):
        loops.of(run)


def test_spread_over_packings(tmp_path):
    found = loops.spread([made(tmp_path / f"{k}.h5", scale=k * 1e-3) for k in (1, 2, 3)], 10)
    assert (found["largest_low"], found["largest"], found["largest_high"]) == pytest.approx((0.01, 0.02, 0.03), rel=1e-12)


def test_tolerance_sorts_runs_by_what_is_varied(tmp_path):
    varied = [{"tolerance": 1e-4}, {"tolerance": 1e-8}, {"fixed_iterations": 7}, {"cd_dt": 4e-3}]
    runs = [made(tmp_path / "md.h5", "MD", 1e-3)] + [made(tmp_path / f"{k}.h5", "CD", 1e-3 * 10.0**-k, row) for k, row in enumerate(varied)]
    rows = tolerance.summarize(runs)
    assert [(row["effort"], row["value"]) for row in rows] == [("MD", 0.0), ("tolerance", 1e-4), ("tolerance", 1e-8), ("sweeps", 7), ("step", 4e-3)]
    assert rows[3]["sweeps_a_step"] == 7
    tolerance.draw(runs, rows, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 1000
