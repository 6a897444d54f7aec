"""The static limit of spheres against planar samples, whose limit a linear programme gives exactly."""
import math

import numpy as np
import pytest

from yade_scripts.results.reader import ResultError
from yade_scripts.theory import cone_limits, statics

from .test_statics import DEPTH, P0, RADIUS, diagonal_pair

DOWN, UP = 4, 5  # walls


def between_plates(planar, turn=np.eye(3)):
    """The planar sample made of spheres, each of which touches two smooth plates in front and behind; axes turned by a permutation matrix."""
    spheres = len(planar["radius"])
    deep = lambda rows, z=0.0: np.column_stack([rows, np.full(len(rows), z)]) @ turn.T
    # The walls x and y come first; planar contacts name them 0 to 3, in space the walls of the turned axes.
    axis_of = {axis: int(np.argmax(turn[:, axis])) for axis in range(3)}
    renamed = lambda ids: np.array([[wall if wall > 5 else 2 * axis_of[wall // 2] + wall % 2 for wall in pair] for pair in ids])
    plates = [[wall, body] for body in planar["body_ids"] for wall in (DOWN, UP)]
    normal = np.tile([[0, 0, 1.0], [0, 0, -1.0]], (spheres, 1)) @ turn.T
    box = np.array([*planar["box"], -RADIUS, RADIUS]).reshape(3, 2)
    return {"position": deep(planar["position"]), "radius": planar["radius"], "body_ids": planar["body_ids"],
            "contact_ids": np.vstack([renamed(planar["contact_ids"]), renamed(plates)]),
            "contact_normal": np.vstack([deep(planar["contact_normal"]), normal]),
            "contact_point": np.vstack([deep(planar["contact_point"]), np.repeat(deep(planar["position"]), 2, axis=0) - RADIUS * normal]),
            "contact_friction": np.concatenate([planar["contact_friction"], np.zeros(2 * spheres)]),
            "box": (np.abs(turn) @ box).ravel()}


@pytest.mark.parametrize("mu", [0.05, 0.1, 0.2])
def test_a_planar_sample_has_its_planar_limit(mu):
    """Friction out of the plane takes from the cones and gives nothing, so the limit is that of the disks. sigma1 is held, and smooth plates carry
    sigma3. Bounds on both sides, no farther apart than friction that differs by SHARPNESS makes them."""
    planar = diagonal_pair(math.pi / 4, mu, mu)
    exact = statics.limit_loads(planar, P0, DEPTH)[1]
    below, above = cone_limits.limit_load(between_plates(planar), P0)
    # The share that the limit changes with friction is below 3 mu here, and both bounds are linear programmes solved to 1e-7.
    assert below <= exact * (1 + 1e-7) and above >= exact * (1 - 1e-7)
    assert above - below < 2 * 3 * mu * cone_limits.SHARPNESS * exact + 1e-6


def test_the_axes_are_alike_but_for_the_loaded_one():
    """The same sample in the plane y-z: the stress along y is the one that rises, z has the place of x."""
    planar = diagonal_pair(math.pi / 4, 0.1, 0.1)
    swapped = between_plates(planar, np.array([[0, 0, 1.0], [0, 1, 0], [1, 0, 0]]))
    assert cone_limits.limit_load(swapped, P0) == pytest.approx(cone_limits.limit_load(between_plates(planar), P0), rel=1e-6)


def test_friction_that_turns_in_its_plane_carries_as_much_as_any_other():
    """Coulomb's cone is circular: friction along a diagonal carries mu R, neither the corner of a square cone (sqrt(2) mu R) nor less."""
    planar = diagonal_pair(math.pi / 4, 0.1, 0.1)
    snapshot = between_plates(planar)
    below, above = cone_limits.limit_load(snapshot, P0)
    rotated = dict(snapshot)
    original = cone_limits._tangents
    try:
        cone_limits._tangents = lambda normal: tuple((one + sign * other) / math.sqrt(2) for sign, (one, other) in
                                                     ((1, original(normal)), (-1, original(normal))))
        assert cone_limits.limit_load(rotated, P0) == pytest.approx((below, above), rel=2 * 3 * 0.1 * cone_limits.SHARPNESS + 1e-6)
    finally:
        cone_limits._tangents = original


def test_a_sample_that_carries_no_load_is_named():
    """A sphere that touches no wall along z."""
    snapshot = between_plates(diagonal_pair(math.pi / 4, 0.1, 0.1))
    plates = np.any(snapshot["contact_ids"] == UP, axis=1)
    with pytest.raises(ResultError, match="its contacts cannot carry P0 along x and z"):
        cone_limits.limit_load({name: values[~plates] if name.startswith("contact") else values for name, values in snapshot.items()}, P0)
