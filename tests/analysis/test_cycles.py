"""Per-cycle numbers of made-up histories whose rates are known."""

import numpy as np
import pytest

from analysis import cycles
from tests.analysis.conftest import PER_CYCLE, cyclic

def test_numbers_per_cycle(tmp_path):
    found = cycles.of(cyclic(tmp_path / "run.h5", [-3e-4, -2e-4, -1e-4], first=1e-5))
    np.testing.assert_array_equal(found.number, [1, 2, 3])
    np.testing.assert_allclose(found.permanent, [-2.9e-4, -4.9e-4, -5.9e-4], rtol=1e-12)
    np.testing.assert_allclose(found.rate, [-3e-4, -2e-4, -1e-4], rtol=1e-12)
    # P0 V0 = 1200 Pa on a square metre 1 m deep of side 0.2 m: 48 J.
    np.testing.assert_allclose(found.dissipated, 1e-3 / 48, rtol=1e-12)
    np.testing.assert_allclose(found.sliding_max, 0.1, rtol=1e-12)
    np.testing.assert_allclose(found.contacts, 4.0)


def test_an_unfinished_cycle_does_not_count(tmp_path):
    run = cyclic(tmp_path / "run.h5", [-1e-4] * 3)
    for name in run.history:
        run.history[name] = run.history[name][:-5]
    assert len(cycles.of(run).number) == 2
    for name in run.history:
        run.history[name] = run.history[name][:PER_CYCLE - 1]
    assert len(cycles.of(run).number) == 0 and np.isnan(cycles.of(run).first)


def test_ends_of_cycles_beside_whole_numbers(tmp_path):
    """By rounding, or sampled twice."""
    run = cyclic(tmp_path / "run.h5", [-1e-4] * 2)
    run.history["cycle"] = np.insert(run.history["cycle"] + 1e-12, PER_CYCLE, 1 - 1e-3)
    np.testing.assert_array_equal(cycles.ends(run), [0, PER_CYCLE, 2 * PER_CYCLE + 1])


def test_windows_cover_every_cycle_once():
    found = cycles.windows(1000)
    covered = [n for first, last in found for n in range(first, last + 1)]
    assert covered == list(range(1, 1001)) and len(found) < 60


def test_rates_of_windows_are_means(tmp_path):
    rates = -np.arange(1.0, 11.0) * 1e-5
    found = cycles.of(cyclic(tmp_path / "run.h5", rates))
    np.testing.assert_allclose(found.rates([(1, 1), (2, 4), (5, 10)]), [-1e-5, -3e-5, -7.5e-5], rtol=1e-9)


def test_late_rate_and_last_quarter(tmp_path):
    found = cycles.of(cyclic(tmp_path / "run.h5", -1e-5 / np.arange(1, 65)))
    assert found.late_rate == pytest.approx(-1e-5 / 32 * sum(1 / np.arange(33, 65)), rel=1e-9)
    assert found.last_quarter == pytest.approx(sum(1 / np.arange(49, 65)) / sum(1 / np.arange(33, 49)), rel=1e-9)


def test_too_short_to_tell(tmp_path):
    one, seven = (cycles.of(cyclic(tmp_path / "run.h5", [-1e-4] * count)) for count in (1, 7))
    assert np.isnan(one.late_rate) and np.isnan(seven.last_quarter)
