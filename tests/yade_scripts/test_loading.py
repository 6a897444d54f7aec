"""The loadings against the paper's equations."""
import pytest
from hypothesis import given, strategies as st

from yade_scripts.running import loading
from yade_scripts.parameters import complete

P0, D, T0 = 1200.0, 0.3, 4.0


def goals(shape, **more):
    return loading.goals(complete({"loading": shape, "delta_sigma": D, "period": T0} | more), P0)


@pytest.mark.parametrize("shape, quarter", [("cosine", 1 / 6), ("triangle", 0.125)])
def test_a_cycle_is_that_of_the_paper(shape, quarter):
    """Eq. 7, and a triangle of the same extremes and one rate."""
    for part, share in ((0, 0), (quarter, 0.25), (0.25, 0.5), (0.5, 1), (0.75, 0.5), (1, 0)):
        assert goals(shape)(part * T0) == (P0, pytest.approx(P0 * (1 + D * share), rel=1e-14))


def test_ramp_is_eq_1():
    assert goals("ramp", ramp_rate=0.1)(0) == (P0, P0)
    assert goals("ramp", ramp_rate=0.1)(2.5) == (P0, pytest.approx(1.25 * P0, rel=1e-15))


@given(st.floats(0, 100), st.sampled_from(["cosine", "triangle"]))
def test_cycles_repeat_and_stay_between_their_extremes(t, shape):
    sigma1, sigma2 = goals(shape)(t)
    assert sigma1 == P0
    assert P0 * (1 - 1e-12) <= sigma2 <= P0 * (1 + D) * (1 + 1e-12)
    assert goals(shape)(t + T0)[1] == pytest.approx(sigma2, abs=1e-9 * P0)
    assert goals(shape)(100 * T0 - t)[1] == pytest.approx(sigma2, abs=1e-9 * P0)  # even in t: unloading mirrors loading


@pytest.mark.parametrize("shape", ["cosine", "triangle", "ramp"])
def test_the_mean_stress_stays_p0_if_asked_for(shape):
    changing, held = (goals(shape, stress_path=path) for path in ("constant", "mean"))
    for t in (0.0, 0.3 * T0, 0.5 * T0):
        sigma1, sigma2 = held(t)
        assert sigma2 == changing(t)[1] and changing(t)[0] == P0
        assert (sigma1 + sigma2) / 2 == pytest.approx(P0, rel=1e-15)
