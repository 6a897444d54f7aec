"""The loadings against the paper's equations."""
import pytest
from hypothesis import given, strategies as st

from yade_scripts.running import loading
from yade_scripts.parameters import complete

P0, D, T0 = 1200.0, 0.3, 4.0


def test_cosine_is_eq_7():
    for part, share in ((0, 0), (1 / 6, 0.25), (0.25, 0.5), (0.5, 1), (0.75, 0.5), (1, 0)):
        assert loading.cosine(part * T0, P0, D, T0) == pytest.approx(P0 * (1 + D * share), rel=1e-14)


def test_triangle_has_the_same_extremes_and_one_rate():
    for part, share in ((0, 0), (0.125, 0.25), (0.25, 0.5), (0.5, 1), (0.75, 0.5), (1, 0)):
        assert loading.triangle(part * T0, P0, D, T0) == pytest.approx(P0 * (1 + D * share), rel=1e-14)


def test_ramp_is_eq_1():
    assert loading.ramp(0, P0, 0.1) == P0
    assert loading.ramp(2.5, P0, 0.1) == pytest.approx(1.25 * P0, rel=1e-15)


@given(st.floats(0, 100), st.sampled_from(["cosine", "triangle"]))
def test_cycles_repeat_and_stay_between_their_extremes(t, shape):
    goals = loading.goals(complete({"loading": shape, "delta_sigma": D, "period": T0}), P0)
    sigma1, sigma2 = goals(t)
    assert sigma1 == P0
    assert P0 * (1 - 1e-12) <= sigma2 <= P0 * (1 + D) * (1 + 1e-12)
    assert goals(t + T0)[1] == pytest.approx(sigma2, abs=1e-9 * P0)
    assert goals(100 * T0 - t)[1] == pytest.approx(sigma2, abs=1e-9 * P0)  # even in t: unloading mirrors loading


@pytest.mark.parametrize("shape", [dict(loading="cosine"), dict(loading="triangle"), dict(loading="ramp", ramp_rate=0.1)])
def test_the_mean_stress_stays_p0_if_asked_for(shape):
    changing, held = (loading.goals(complete({"period": T0, "delta_sigma": D, "stress_path": path} | shape), P0) for path in ("constant", "mean"))
    for t in (0.0, 0.3 * T0, 0.5 * T0):
        sigma1, sigma2 = held(t)
        assert sigma2 == changing(t)[1] and changing(t)[0] == P0
        assert (sigma1 + sigma2) / 2 == pytest.approx(P0, rel=1e-15)


def test_goals_pick_the_ramp():
    sigma1, sigma2 = loading.goals(complete({"loading": "ramp", "ramp_rate": 0.2}), P0)(3.0)
    assert sigma1 == P0 and sigma2 == pytest.approx(1.6 * P0, rel=1e-15)
