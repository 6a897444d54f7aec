"""Per-cycle numbers and regimes of made-up histories whose rates are known."""

import numpy as np
import pytest

from analysis import cycles
from yade_scripts.results import reader, schema
from yade_scripts.results.reader import ResultError
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
    return reader.load(write(folder / name, columns=columns, row=dict(loading="cosine", cycles=len(rates), records_per_cycle=PER_CYCLE), **attributes))


def test_numbers_per_cycle(tmp_path):
    found = cycles.of(run_of(tmp_path, [-3e-4, -2e-4, -1e-4], first=1e-5))
    np.testing.assert_array_equal(found.number, [1, 2, 3])
    np.testing.assert_allclose(found.permanent, [-2.9e-4, -4.9e-4, -5.9e-4], rtol=1e-12)
    np.testing.assert_allclose(found.rate, [-3e-4, -2e-4, -1e-4], rtol=1e-12)
    # P0 V0 = 1200 Pa on a square metre 1 m deep of side 0.2 m: 48 J.
    np.testing.assert_allclose(found.dissipated, 1e-3 / 48, rtol=1e-12)
    np.testing.assert_allclose(found.sliding_max, 0.1, rtol=1e-12)
    # The mean of sin^2 over 21 samples that include both ends.
    np.testing.assert_allclose(found.sliding_mean, 0.1 * 10 / 21, rtol=1e-12)
    np.testing.assert_allclose(found.contacts, 4.0)


def test_an_unfinished_cycle_does_not_count(tmp_path):
    run = run_of(tmp_path, [-1e-4] * 3)
    for name in run.history:
        run.history[name] = run.history[name][:-5]
    assert len(cycles.of(run).number) == 2
    for name in run.history:
        run.history[name] = run.history[name][:PER_CYCLE - 1]
    with pytest.raises(ResultError, match="no cycle is complete"):
        cycles.of(run)


def test_windows_cover_every_cycle_once():
    found = cycles.windows(1000)
    covered = [n for first, last in found for n in range(first, last + 1)]
    assert covered == list(range(1, 1001)) and len(found) < 60


def test_rates_of_windows_are_means(tmp_path):
    rates = -np.arange(1.0, 11.0) * 1e-5
    found = cycles.of(run_of(tmp_path, rates))
    np.testing.assert_allclose(found.rates([(1, 1), (2, 4), (5, 10)]), [-1e-5, -3e-5, -7.5e-5], rtol=1e-9)


@pytest.mark.parametrize("power, name", [(0.0, cycles.RATCHETING), (0.5, cycles.RATCHETING), (1.5, cycles.SHAKEDOWN), (3.0, cycles.SHAKEDOWN)])
def test_decay_and_regime_of_a_power_law(tmp_path, power, name):
    number = np.arange(1, 129)
    rates = -1e-5 * number**-power
    regime = cycles.regime(run_of(tmp_path, rates))
    # A difference of two windows stands for a derivative; the sum of n^-p over an octave bends the exponent by a few per cent.
    assert regime.decay == pytest.approx(power, abs=0.05) and regime.name == name
    assert regime.late_rate == pytest.approx(rates[64:].mean(), rel=1e-9)


def test_scatter_about_rest_is_shakedown(tmp_path):
    """gamma read with an error at every cycle's end: rates of both signs and no trend."""
    noise = np.random.default_rng(1).normal(0, 1e-4, 65)
    noise[-1] += 2e-4
    regime = cycles.regime(run_of(tmp_path, np.diff(noise)))
    # The last reading is two standard deviations up: not small, but within the noise.
    assert abs(regime.late_rate) * cycles.RULE.practical > 6e-4 and regime.name == cycles.SHAKEDOWN
    # The difference of two readings scatters by sqrt(2) sigma; 32 of them determine it within a third.
    assert regime.noise == pytest.approx(np.sqrt(2) * 1e-4, rel=0.35)


def test_a_slip_in_the_early_window_is_no_decay(tmp_path):
    rates = np.full(64, -1e-5)
    rates[20] = -1e-3
    assert cycles.regime(run_of(tmp_path, rates)).name == cycles.RATCHETING


def test_a_rate_that_takes_more_than_a_thousand_cycles_to_matter_is_shakedown(tmp_path):
    rates = np.full(64, -1e-10)
    rates[0] = -1e-5
    assert cycles.regime(run_of(tmp_path, rates)).name == cycles.SHAKEDOWN
    # 1000 cycles at 1e-7 are ten times that strain, but less than P0/k_n = 6e-4; at 1e-6 they are more.
    for rate, name in ((-1e-7, cycles.SHAKEDOWN), (-1e-6, cycles.RATCHETING)):
        rates[1:] = rate
        assert cycles.regime(run_of(tmp_path, rates, f"{name}{rate}.h5")).name == name


def test_collapse(tmp_path):
    """By its outcome; or at a rate that reaches collapse_strain (0.2) in as many cycles again."""
    gone = dict(outcome=f"{schema.OUTCOME_COLLAPSED}the walls lost their load")
    assert cycles.regime(run_of(tmp_path, [-1e-3] * 3, "gone.h5", **gone)).name == cycles.COLLAPSE
    assert cycles.regime(run_of(tmp_path, [-4e-3] * 32, "going.h5")).name == cycles.COLLAPSE
    assert cycles.regime(run_of(tmp_path, [-2e-3] * 32, "not yet.h5")).name == cycles.RATCHETING


def test_too_short_to_tell(tmp_path):
    regime = cycles.regime(run_of(tmp_path, [-1e-9] * (cycles.FEWEST_CYCLES - 1)))
    assert regime.name == cycles.SHORT and np.isnan(regime.late_rate)
    # Long enough to see that nothing moves, not to tell a decay from a constant rate.
    assert cycles.regime(run_of(tmp_path, [-1e-9] * cycles.FEWEST_CYCLES, "still.h5")).name == cycles.SHAKEDOWN
    assert cycles.regime(run_of(tmp_path, [-1e-4] * (cycles.FEWEST_FOR_DECAY - 1), "moving.h5")).name == cycles.SHORT
