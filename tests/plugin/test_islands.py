"""Islands of contacts solved apart (`reduce`): what they are, that motion does not depend on it, what it spares."""
import pytest

from . import plane
from .test_invariants import cloud, digest

GRAVITY = (0, -9.81, 0)


def pile(left, rows, mat, gap=0.0):
    """A pile of disks of 1 cm on the floor, `rows` in its lowest row, whose left end is at `left`; ids."""
    return [plane.disk((left + 0.01 * (2 * i + j + 1) + gap * i, 0.01 + 0.0173 * j), 0.01, mat=mat) for j in range(rows) for i in range(rows - j)]


def scene(O, piles=3):
    """Piles apart on one floor, a disk that slides and one that flies."""
    mat = plane.material(0.5)
    plane.floor(mat)
    for k in range(piles):
        pile(0.2 * k, 3, mat)
    plane.disk((-0.3, 0.01), 0.01, velocity=(0.1, 0), mat=mat)
    plane.disk((-0.5, 3), 0.01, mat=mat)


def motion(O):
    return [x for b in O.bodies for x in (*b.state.pos, *b.state.vel, *b.state.angVel)]


def test_counts(O):
    """Three unknowns a disk that touches something; without `reduce` a disk that flies has them, too."""
    scene(O)
    cd = plane.run(1, 1e-4, gravity=GRAVITY, tolerance=1e-8)
    assert (cd.islands, cd.unknowns) == (4, 3 * (3 * 6 + 1))
    cd.reduce = False
    O.run(1, True)
    assert (cd.islands, cd.unknowns) == (1, 3 * (3 * 6 + 2))


@pytest.mark.parametrize("free, islands", [("xyzXYZ", 2), ("yzXYZ", 1)])
def test_a_boundary_that_can_move_joins_what_touches_it(O, free, islands):
    """Two disks on either side of a plate: fixed, or free along x and pushed by nothing."""
    mat = plane.material(0)
    for side in (-1, 1):
        plane.disk((side * 0.11, 0), 0.1, velocity=(-side, 0), mat=mat)
    plate = plane.box((0, 0), (0.01, 0.5), blocked=free, mat=mat)
    cd = plane.run(1, 1e-3, tolerance=1e-12)
    assert (cd.contacts, cd.islands) == (2, islands)
    assert [O.bodies[i].state.vel[0] for i in (0, 1, plate)] == pytest.approx([0, 0, 0], abs=1e-13)


def test_motion_does_not_depend_on_it(O):
    """Bodies falling on each other and coming to rest. Errors of 1e-11 of the impulses, m g dt = 1e-3 N s, on 1 kg over 300 steps of 1e-4 s."""
    moved = []
    for reduce in (True, False):
        O.reset()
        mat = plane.material(0.5)
        plane.floor(mat)
        for k in range(3):
            pile(0.2 * k, 3, mat, gap=1e-3)
        plane.disk((-0.3, 0.012), 0.01, velocity=(0.1, 0), mat=mat)
        cd = plane.run(300, 1e-4, gravity=GRAVITY, tolerance=1e-11, maxIterations=100000, reduce=reduce)
        assert cd.unconvergedSteps == 0
        moved.append(motion(O))
    assert moved[0] == pytest.approx(moved[1], abs=1e-8)


def test_a_single_island_is_the_same_to_the_last_bit(O):
    hashes = []
    for reduce in (True, False):
        O.reset()
        mat = plane.material(0.5)
        plane.floor(mat)
        pile(0, 6, mat)
        cd = plane.run(100, 1e-3, gravity=GRAVITY, tolerance=1e-6, reduce=reduce)
        assert cd.islands == 1
        hashes.append(digest(O))
    assert hashes[0] == hashes[1]


def test_at_rest_most_steps_make_no_sweep(O):
    """The forces of the step before are the solution again, until velocities of their error, at most 1e-6 g dt a step, have added up to it."""
    mat = plane.material(0.5)
    plane.floor(mat)
    for k in range(3):
        plane.disk((0, 0.01 + 0.02 * k), 0.01, mat=mat)
    cd = plane.run(20, 1e-3, gravity=GRAVITY, tolerance=1e-6)
    rested = 0
    for _ in range(40):
        O.run(1, True)
        assert (cd.islands, cd.resting) == (1, int(cd.iterations == 0))
        rested += cd.resting
    assert rested >= 20
    assert abs(O.bodies[3].state.vel[1]) < 10 * 1e-6 * 9.81e-3


def test_a_saved_scene_goes_on_bitwise(O, tmp_path):
    """Which islands rested before is remembered to spare time; it must not show."""
    import cd_engine
    cloud(O, 40, seed=3, speed=2)
    plane.floor()
    for b in O.bodies:
        if b.state.blockedDOFs == "zXY":
            b.state.pos += (0, 0.3, 0)
    O.engines = cd_engine.engines(gravity=GRAVITY, tolerance=1e-6)
    O.dt = 1e-3
    O.run(300, True)
    O.save(str(tmp_path / "half.yade.gz"))
    O.run(100, True)
    whole = digest(O)
    O.load(str(tmp_path / "half.yade.gz"))
    O.run(100, True)
    assert digest(O) == whole
