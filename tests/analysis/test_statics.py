"""Statics of grains in the box against samples solved by hand."""
import math
import types

import numpy as np
import pytest

from analysis import limits
from yade_scripts import parameters
from yade_scripts.theory import statics
from yade_scripts.results.reader import ResultError

P0, DEPTH, RADIUS = 1000.0, 0.5, 0.01


def diagonal_pair(angle, mu, wall_mu):
    """Two equal disks in a box, one in each corner, touching along `angle` [rad]; contacts A with x-, y-, B with x+, y+, A with B."""
    a = np.array([RADIUS, RADIUS])
    b = a + 2 * RADIUS * np.array([math.cos(angle), math.sin(angle)])
    normal = np.array([[1, 0], [0, 1], [-1, 0], [0, -1], (b - a) / (2 * RADIUS)])
    point = np.array([[0, a[1]], [a[0], 0], [b[0] + RADIUS, b[1]], [b[0], b[1] + RADIUS], (a + b) / 2])
    return {"position": np.array([a, b]), "radius": np.full(2, RADIUS), "body_ids": np.array([6, 7]),
            "contact_ids": np.array([[0, 6], [2, 6], [1, 7], [3, 7], [6, 7]]), "contact_normal": normal, "contact_point": point,
            "contact_friction": np.array([wall_mu] * 4 + [mu]), "box": np.array([0, b[0] + RADIUS, 0, b[1] + RADIUS])}


@pytest.mark.parametrize("angle", [0.3, 0.8, 1.2])
def test_smooth_walls_leave_one_load(angle):
    """No torque from the walls, so none from the contact: its force is along the line of centres, sigma2 Lx/(sigma1 Ly) = tan(angle)."""
    snapshot = diagonal_pair(angle, 0.5, 0.0)
    _, width, _, height = snapshot["box"]
    exact = math.tan(angle) * height / width
    assert statics.limit_loads(snapshot, P0, DEPTH) == pytest.approx((exact, exact), rel=1e-9)
    assert statics.dimension(snapshot, np.ones(5, bool)) == 0
    # 5 R and the one T at a contact with friction, 4 + 2 equations of disks (each has that one contact), 2 walls: one too many of them,
    # which is why only one load is carried.
    assert statics.degrees_of_freedom(snapshot, np.ones(5, bool)) == (5, 2, -2)


@pytest.mark.parametrize("mu", [0.05, 0.1, 0.2])
def test_rough_walls_widen_the_range_of_loads(mu):
    """At 45 degrees, contact and walls y sliding: sigma2/sigma1 = (1 + k)/(1 - k (1 + 2 mu)), k = (sqrt 2 + 1) mu/(sqrt 2 + mu); and its inverse.

    From the torque t1 - t2 = T on the upper disk, forces R2 - R1 = (sqrt 2 + 1) T, R1 + R2 = sqrt 2 R + t1 + t2, with T = mu R, t2 = -mu R2
    (t1, t2: friction of the walls x+ and y+, R1 and R2 their pressures).
    """
    k = (math.sqrt(2) + 1) * mu / (math.sqrt(2) + mu)
    exact = (1 + k) / (1 - k * (1 + 2 * mu))
    assert statics.limit_loads(diagonal_pair(math.pi / 4, mu, mu), P0, DEPTH) == pytest.approx((1 / exact, exact), rel=1e-9)


def test_the_limit_under_a_constant_mean_stress():
    """With smooth walls sigma2/sigma1 is given by the geometry, so sigma2 = 2 P0 r/(1 + r) where sigma1 = 2 P0 - sigma2."""
    snapshot = diagonal_pair(0.8, 0.5, 0.0)
    ratio = statics.limit_loads(snapshot, P0, DEPTH)[1]
    exact = 2 * ratio / (1 + ratio)
    assert statics.limit_loads(snapshot, P0, DEPTH, "mean") == pytest.approx((exact, exact), rel=1e-9)


def test_the_limit_of_a_run_depends_on_friction():
    """Packings of other friction may have the same contacts to the last bit. Without loaded walls there is no limit."""
    def run(mu, box=None):
        snapshot = diagonal_pair(math.pi / 4, mu, mu) | ({} if box is None else {"box": box})
        return types.SimpleNamespace(snapshots=[snapshot], pressure=P0, parameters=parameters.complete({}), attributes={"depth": DEPTH})
    exact = [statics.limit_loads(diagonal_pair(math.pi / 4, mu, mu), P0, DEPTH)[1] for mu in (0.1, 0.2)]
    assert [limits.static_limit(run(mu)) for mu in (0.1, 0.2)] == exact
    assert math.isnan(limits.static_limit(run(0.15, box=np.full(4, np.nan))))


def test_the_largest_load_of_a_ramp_is_where_it_ends():
    assert parameters.highest_load(parameters.complete({"delta_sigma": 0.3})) == pytest.approx(1.3)
    assert parameters.highest_load(parameters.complete({"loading": "ramp", "ramp_rate": 0.1, "period": 4.0})) == pytest.approx(1.4)


def test_violations_tell_balance_cone_and_pull_apart():
    snapshot = diagonal_pair(math.pi / 4, 0.3, 0.0)
    load = statics.wall_loads(snapshot, (P0, P0), DEPTH)
    push = P0 * DEPTH * snapshot["box"][1]
    normal, none = np.array([push] * 4 + [math.sqrt(2) * push]), np.zeros(5)
    mean = normal.mean()
    assert statics.violations(snapshot, normal, none, load)[0] == pytest.approx([0, 0, -push / mean], abs=1e-12)
    harmed = normal.copy()
    harmed[0] *= 1.1
    assert statics.violations(snapshot, harmed, none, load)[0][0] == pytest.approx(0.1 * push / harmed.mean(), rel=1e-9)
    slipping = none.copy()
    slipping[4] = 0.4 * normal[4]
    assert statics.violations(snapshot, normal, slipping, load)[0][1] == pytest.approx(0.1 * normal[4] / mean, rel=1e-9)
    # That T also turns both disks: its torque over the radius.
    assert statics.violations(snapshot, normal, slipping, load)[0][0] == pytest.approx(0.4 * normal[4] / mean, rel=1e-9)


def test_force_range_of_a_determinate_sample_is_a_point():
    snapshot = diagonal_pair(math.pi / 4, 0.3, 0.0)
    load = statics.wall_loads(snapshot, (P0, P0), DEPTH)
    force = math.sqrt(2) * P0 * DEPTH * snapshot["box"][1]
    assert statics.force_range(snapshot, load, 4) == pytest.approx((force, force), rel=1e-9)


def test_sample_that_nothing_bounds_is_refused():
    """One disk between rough walls: each pair of walls carries any load on it, so no load is the largest."""
    snapshot = diagonal_pair(math.pi / 4, 0.3, 0.0)
    single = {"position": snapshot["position"][:1], "radius": np.full(1, RADIUS), "body_ids": np.array([6]),
              "contact_ids": np.array([[0, 6], [2, 6], [1, 6], [3, 6]]), "contact_normal": snapshot["contact_normal"][:4],
              "contact_point": np.array([[0, RADIUS], [RADIUS, 0], [2 * RADIUS, RADIUS], [RADIUS, 2 * RADIUS]]),
              "contact_friction": np.full(4, 0.3), "box": np.array([0, 2 * RADIUS, 0, 2 * RADIUS])}
    with pytest.raises(ResultError, match="carry any load"):
        statics.limit_loads(single, P0, DEPTH)
