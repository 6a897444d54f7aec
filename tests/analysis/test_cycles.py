"""Per-cycle numbers of made-up histories whose rates are known."""

import numpy as np
import pytest

from analysis import cycles
from yade_scripts.results import reader
from tests.analysis.conftest import history, write

PER_CYCLE = 20


def run_of(folder, rates, name="run.h5", first=0.0, **attributes):
    """A finished MD run whose gamma changes by rates[n] over cycle n; sliding contacts come and go in each cycle."""
    ends = np.concatenate([[first], first + np.cumsum(rates)])
    samples = PER_CYCLE * len(rates) + 1
    cycle = np.arange(samples) / PER_CYCLE
    columns = {name: np.zeros(samples) for name in history("MD")}
    gamma = np.interp(cycle, np.arange(len(ends)), ends)
    columns |= dict(time=cycle, cycle=cycle, gamma=gamma, strain2=gamma / 2, strain1=-gamma / 2, sigma1=np.full(samples, 1200.0),
                    sigma2=np.full(samples, 1200.0), contacts=np.full(samples, 800.0), dissipated_energy=cycle * 1e-3,
                    sliding_contacts=80 * np.sin(np.pi * cycle)**2)
    return reader.load(write(folder / name, columns=columns, row=dict(loading="cosine", cycles=len(rates), records_per_cycle=PER_CYCLE),
                             **attributes))


def test_numbers_per_cycle(tmp_path):
    found = cycles.of(run_of(tmp_path, [-3e-4, -2e-4, -1e-4], first=1e-5))
    np.testing.assert_array_equal(found.number, [1, 2, 3])
    np.testing.assert_allclose(found.permanent, [-2.9e-4, -4.9e-4, -5.9e-4], rtol=1e-12)
    np.testing.assert_allclose(found.rate, [-3e-4, -2e-4, -1e-4], rtol=1e-12)
    # P0 V0 = 1200 Pa on a square metre 1 m deep of side 0.2 m: 48 J.
    np.testing.assert_allclose(found.dissipated, 1e-3 / 48, rtol=1e-12)
    np.testing.assert_allclose(found.sliding_max, 0.1, rtol=1e-12)
    np.testing.assert_allclose(found.contacts, 4.0)


def test_an_unfinished_cycle_does_not_count(tmp_path):
    run = run_of(tmp_path, [-1e-4] * 3)
    for name in run.history:
        run.history[name] = run.history[name][:-5]
    assert len(cycles.of(run).number) == 2
    for name in run.history:
        run.history[name] = run.history[name][:PER_CYCLE - 1]
    assert len(cycles.of(run).number) == 0 and np.isnan(cycles.of(run).first)


def test_windows_cover_every_cycle_once():
    found = cycles.windows(1000)
    covered = [n for first, last in found for n in range(first, last + 1)]
    assert covered == list(range(1, 1001)) and len(found) < 60


def test_rates_of_windows_are_means(tmp_path):
    rates = -np.arange(1.0, 11.0) * 1e-5
    found = cycles.of(run_of(tmp_path, rates))
    np.testing.assert_allclose(found.rates([(1, 1), (2, 4), (5, 10)]), [-1e-5, -3e-5, -7.5e-5], rtol=1e-9)


def test_late_rate_and_last_quarter(tmp_path):
    found = cycles.of(run_of(tmp_path, -1e-5 / np.arange(1, 65)))
    assert found.late_rate == pytest.approx(-1e-5 / 32 * sum(1 / np.arange(33, 65)), rel=1e-9)
    assert found.last_quarter == pytest.approx(sum(1 / np.arange(49, 65)) / sum(1 / np.arange(33, 49)), rel=1e-9)


def test_too_short_to_tell(tmp_path):
    assert np.isnan(cycles.of(run_of(tmp_path, [-1e-4])).late_rate) and np.isnan(cycles.of(run_of(tmp_path, [-1e-4] * 7)).last_quarter)
