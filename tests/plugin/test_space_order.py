"""Contacts are ordered by where their bodies are, in scenes too large for the cache; that belongs to the saved state."""
import pytest

from .test_invariants import cloud, digest

DISKS = 2100  # more than 2048, from which on the order is used


def throw(O):
    """Disks thrown at their centre, where they pile up."""
    import cd_engine
    cloud(O, DISKS, seed=4, speed=5)
    O.engines = cd_engine.engines(tolerance=1e-4, maxIterations=10)
    O.dt = 2e-3


def test_a_saved_scene_goes_on_bitwise_though_the_bodies_have_moved(O, tmp_path):
    import cd_engine
    throw(O)
    O.run(40, True)
    saved = list(O.engines[-1].bodyOrder)
    assert len(saved) == len(O.bodies)
    O.save(str(tmp_path / "half.yade.gz"))
    O.run(10, True)
    whole = digest(O)
    assert list(O.engines[-1].bodyOrder) == saved
    O.load(str(tmp_path / "half.yade.gz"))
    O.run(10, True)
    assert digest(O) == whole
    # An order made from the places of now would be another one: it is the saved one that was used.
    O.load(str(tmp_path / "half.yade.gz"))
    O.engines = cd_engine.engines(fixedIterations=1, handover=False)
    O.run(1, True)
    assert list(O.engines[-1].bodyOrder) != saved


def test_the_order_of_the_list_of_pairs_does_not_show(O):
    """In runs of one step the collider runs in every step, and its list is another one."""
    hashes = []
    for at_once in (1, 16):
        O.reset()
        throw(O)
        for _ in range(16 // at_once):
            O.run(at_once, True)
        hashes.append(digest(O))
    assert hashes[0] == hashes[1]


@pytest.mark.parametrize("moved, renewed", [(0, False), (2100, True)])
def test_the_order_is_renewed_at_a_step_that_looks_at_it(O, moved, renewed):
    """Every 64th step looks; disks put in each other's places have lost their order."""
    throw(O)
    O.run(1, True)
    first = list(O.engines[-1].bodyOrder)
    if moved:
        places = [b.state.pos for b in O.bodies]
        for i, b in enumerate(O.bodies):
            b.state.pos = places[i * 997 % DISKS]
    O.run(63, True)
    assert list(O.engines[-1].bodyOrder) == first
    O.run(1, True)
    assert (list(O.engines[-1].bodyOrder) != first) == renewed


def test_few_bodies_keep_their_numbers(O):
    import cd_engine
    cloud(O, 30, seed=1)
    O.engines = cd_engine.engines()
    O.run(2, True)
    assert len(O.engines[-1].bodyOrder) == 0
