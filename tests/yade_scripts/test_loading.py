"""The loadings against the paper's equations."""
import itertools

import pytest

import cd_engine
from yade_scripts.running import loading
from yade_scripts.parameters import complete

P0, D, T0 = 1200.0, 0.3, 4.0


@pytest.fixture
def stresses(O):
    """A function that gives (sigma1, sigma2) of a loading at a time."""
    from yade import utils, wrapper
    O.bodies.append(utils.aabbWalls([(0, 0, 0), (1, 1, 1)], thickness=0))
    for wall, blocked in ((1, "yzXYZ"), (3, "xzXYZ")):
        O.bodies[wall].state.mass, O.bodies[wall].state.blockedDOFs = 1e30, blocked

    def of(t, **row):
        loads = cd_engine.PlateLoads(**loading.of_row(complete({"delta_sigma": D, "period": T0} | row), P0))
        O.resetTime()
        O.engines = [wrapper.ForceResetter(), loads, wrapper.NewtonIntegrator()]
        O.dt = t
        for _ in range(1 + (t > 0)):
            O.step()
        return tuple(-loads.goal[axis] for axis in (0, 1))
    return of


@pytest.mark.parametrize("shape, quarter", [("cosine", 1 / 6), ("triangle", 0.125)])
def test_a_cycle_is_that_of_the_paper(stresses, shape, quarter):
    """Eq. 7, and a triangle of the same extremes and one rate; cycles repeat."""
    times = (0, 0), (quarter, 0.25), (0.25, 0.5), (0.5, 1), (0.75, 0.5), (1, 0)
    for (part, share), cycle in itertools.product(times, (0, 1, 100)):
        assert stresses((part + cycle) * T0, loading=shape) == (P0, pytest.approx(P0 * (1 + D * share), rel=1e-12))


def test_ramp_is_eq_1(stresses):
    assert stresses(0, loading="ramp", ramp_rate=0.1) == (P0, P0)
    assert stresses(2.5, loading="ramp", ramp_rate=0.1) == (P0, pytest.approx(1.25 * P0, rel=1e-15))


@pytest.mark.parametrize("shape", ["cosine", "triangle", "ramp"])
def test_the_mean_stress_stays_p0_if_asked_for(stresses, shape):
    for t in (0.0, 0.3 * T0, 0.5 * T0):
        changing, (sigma1, sigma2) = (stresses(t, loading=shape, stress_path=path) for path in ("constant", "mean"))
        assert sigma2 == changing[1] and changing[0] == P0
        assert (sigma1 + sigma2) / 2 == pytest.approx(P0, rel=1e-15)
