"""Forces that rigid contacts do not determine, solved by hand: a disk in a groove with friction has a one-parameter family of them."""
import math

import numpy as np
import pytest

import cd_engine
from yade_scripts.preparing import force_network
from yade_scripts.running import hooks

from . import plane

G = 9.81


def groove(O, degrees, mu, radius=0.1):
    """A disk of 1 kg in a symmetric groove, its walls at `degrees` to the horizontal; its id."""
    t, half = math.radians(degrees), 0.05
    mat = plane.material(mu)
    for side in (-1, 1):
        plane.box((side * (radius + half) * math.sin(t), -(radius + half) * math.cos(t)), (1, half), angle=side * t, mat=mat)
    return plane.disk((0, 0), radius, mat=mat)


@pytest.mark.parametrize("degrees, mu", [(45, 0.3), (30, 0.5), (60, 0.1)])
def test_walk_fills_the_interval_of_a_disk_in_a_groove(O, degrees, mu):
    """Balance: R1 = R2 = N, T1 = -T2 = T, 2 N cos t + 2 T sin t = m g; with |T| <= mu N: T from -mu m g/(2 (cos t - mu sin t)) to
    mu m g/(2 (cos t + mu sin t)).

    The walk must lie on that segment (1e-9 of the weight, tolerance 1e-12 on the impulses). Perturbations of +-5 <R> are many times the
    segment's length, at most 1.2 <R>, and what begins beyond an end is brought to it: 100 samples must come within 5 % of both.
    """
    ball = groove(O, degrees, mu)
    O.engines = cd_engine.engines(gravity=(0, -G, 0), tolerance=1e-12)
    O.dt = 1e-2  # of a length at which gaps of round-off, 1e-17 m, weigh 1e-14 of the impulses
    hooks.simulate(1)
    place = tuple(O.bodies[ball].state.pos)
    walk = force_network.Walk(seed=1, amplitude=5.0)
    walk.surround()
    hooks.simulate(100)
    t = math.radians(degrees)
    normal, tangential = np.array(walk.normal), np.array(walk.tangential)
    # Contact 0 is with the left wall: normal (sin t, cos t), tangent (-cos t, sin t), up that wall.
    least, largest = -mu * G / (2 * (math.cos(t) - mu * math.sin(t))), mu * G / (2 * (math.cos(t) + mu * math.sin(t)))
    assert all(walk.converged)
    assert np.abs(normal[:, 0] - normal[:, 1]).max() < 1e-9 * G and np.abs(tangential.sum(axis=1)).max() < 1e-9 * G
    assert np.abs(2 * normal[:, 0] * math.cos(t) + 2 * tangential[:, 0] * math.sin(t) - G).max() < 1e-9 * G
    assert least - 1e-9 * G <= tangential[:, 0].min() and tangential[:, 0].max() <= largest + 1e-9 * G
    assert np.ptp(tangential[:, 0]) > 0.95 * (largest - least)
    assert tuple(O.bodies[ball].state.pos) == place


def test_the_solver_leaves_an_admissible_network_as_it_is(O):
    """Warm start from a point of the set: no sweep changes it, to the tolerance."""
    groove(O, 45, 0.3)
    O.engines = cd_engine.engines(gravity=(0, -G, 0), tolerance=1e-10)
    O.dt = 1e-2  # of a length at which gaps of round-off, 1e-17 m, weigh 1e-14 of the impulses
    hooks.simulate(1)
    frozen = force_network.Frozen()
    tangential = 0.05 * G
    normal = (G - 2 * tangential * math.sin(math.pi / 4)) / (2 * math.cos(math.pi / 4))
    frozen.impose([normal, normal], [tangential, -tangential])
    hooks.simulate(1)
    np.testing.assert_allclose(frozen.forces(), [[normal, normal], [tangential, -tangential]], rtol=1e-8)
