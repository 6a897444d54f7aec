"""In scenes too large for the cache, contacts are ordered by the places of their bodies; the order is part of the saved state."""
import numpy as np
import pytest
from yade import utils

import cd_engine

from . import plane
from .test_export_problem import ids

DISKS = 2100  # more than 2048, from which on the order is used


def throw(O):
    """Disks thrown at their centre, where they pile up."""
    plane.cloud(DISKS, seed=4, speed=5)
    plane.engine(2e-3, tolerance=1e-4, maxIterations=10)


def test_a_saved_scene_goes_on_bitwise_though_the_bodies_have_moved(O, tmp_path):
    throw(O)
    O.run(40, True)
    saved = list(O.engines[-1]._bodyOrder)
    assert len(saved) == len(O.bodies)
    plane.goes_on(tmp_path / "half.yade.gz", 10, lambda: (plane.digest(), list(O.engines[-1]._bodyOrder)))
    assert list(O.engines[-1]._bodyOrder) == saved
    # An order from the present places would differ, so this shows that the saved one was used.
    O.load(str(tmp_path / "half.yade.gz"))
    O.engines = cd_engine.engines(fixedIterations=1, handover=False)
    O.run(1, True)
    assert list(O.engines[-1]._bodyOrder) != saved


def test_the_order_of_the_list_of_pairs_does_not_show(O):
    """In runs of one step the collider runs in every step and makes another list of pairs."""
    hashes = []
    for at_once in (1, 16):
        O.reset()
        throw(O)
        for _ in range(16 // at_once):
            O.run(at_once, True)
        hashes.append(plane.digest())
    assert hashes[0] == hashes[1]


@pytest.mark.parametrize("moved, renewed", [(0, False), (2100, True)])
def test_the_order_is_renewed_at_a_step_that_looks_at_it(O, moved, renewed):
    """Every 64th step checks the order; disks that have changed places make it invalid."""
    throw(O)
    O.run(1, True)
    first = list(O.engines[-1]._bodyOrder)
    if moved:
        places = [b.state.pos for b in O.bodies]
        for i, b in enumerate(O.bodies):
            b.state.pos = places[i * 997 % DISKS]
    O.run(63, True)
    assert list(O.engines[-1]._bodyOrder) == first
    O.run(1, True)
    assert (list(O.engines[-1]._bodyOrder) != first) == renewed


def pairs_of_one_key(most):
    """Two pairs of ids below `most` to which core/search/pair_order.cpp gives one key where their disks are among the first 32 of the order."""
    low, high = np.triu_indices(most, 1)
    h = (low.astype(np.uint64) << np.uint64(32) | high.astype(np.uint64)) * np.uint64(0x9E3779B97F4A7C15)
    h ^= h >> np.uint64(32)
    h = h * np.uint64(0xD6E8FEB86659FD93) >> np.uint64(24)
    order = np.argsort(h, kind="stable")
    for k in np.flatnonzero(h[order][1:] == h[order][:-1]):
        pairs = [(int(low[i]), int(high[i])) for i in order[k:k + 2]]
        if len({*pairs[0], *pairs[1]}) == 4:
            return sorted(pairs)


def test_pairs_of_one_key_are_ordered_by_their_ids(O, tmp_path):
    """Whichever the collider, which goes along x, finds first."""
    pairs = pairs_of_one_key(2800)
    for side in (1, -1):
        O.reset()
        mat = plane.material()
        places = {pair[i]: (side * k, 0.2 * i, 0) for k, pair in enumerate(pairs) for i in (0, 1)}
        for body, place in {**places, 2799: (9, 9, 0)}.items():
            sphere = utils.sphere(place, 0.1, material=mat)
            sphere.state.blockedDOFs = "zXY"
            O.bodies.insertAtId(sphere, body)
        plane.engine()
        O.step()
        O.engines[-1].exportProblem(str(tmp_path / "a"))
        assert list(map(tuple, ids(tmp_path / "a"))) == pairs
