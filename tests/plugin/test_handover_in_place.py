"""Springs and rigid contacts that take one scene over from each other in one process: what ran before must not decide which contacts are found."""
import random

import pytest
from yade import wrapper as w

import cd_engine

from . import plane

RADIUS = 0.01
THIN = 0.5e-3  # half the thickness of a box that a disk at 30 m/s crosses sixty times a step


def springs(O, steps, **collider):
    """YADE's own engines and steps, with a collider of their own."""
    cd_engine.release()
    O.engines, O.dt = plane.springs((0, 0, 0), 0.3, **collider), 1e-5
    O.run(steps, True)


def rigid(O, steps, gravity=0.0):
    """The documented hand-over; the ContactDynamics engine."""
    return plane.run(steps, 1e-3, gravity=(0, -gravity, 0), tolerance=1e-9, maxIterations=100000)


BEFORE = {
    "nothing": lambda O: None,
    "springs": lambda O: springs(O, 3),
    "springs without a Verlet distance": lambda O: springs(O, 3, verletDist=0),
    "rigid": lambda O: rigid(O, 3),
    "rigid, springs": lambda O: (rigid(O, 3), springs(O, 3)),
    "springs, rigid, springs": lambda O: (springs(O, 3), rigid(O, 3), springs(O, 3)),
}


def deepest(O):
    """Largest overlap of two disks, or of a disk and the floor, over the smaller radius: from places and radii alone."""
    disks = [(b.state.pos[0], b.state.pos[1], b.shape.radius) for b in O.bodies if type(b.shape).__name__ == "Sphere"]
    worst = max((r - y) / r for _, y, r in disks)
    for i, (x, y, r) in enumerate(disks):
        for u, v, s in disks[:i]:
            worst = max(worst, (r + s - ((x - u)**2 + (y - v)**2)**0.5) / min(r, s))
    return worst


@pytest.mark.parametrize("before", BEFORE)
def test_a_fast_disk_is_stopped_by_a_thin_box(O, before):
    mat = plane.material(0)
    plane.box((0, 0), (1, THIN), mat=mat)
    disk = plane.disk((0, 0.5), RADIUS, mat=mat)
    BEFORE[before](O)
    O.bodies[disk].state.vel = (0, -30, 0)
    rigid(O, 40)
    assert O.bodies[disk].state.pos[1] == pytest.approx(THIN + RADIUS, abs=1e-12)


@pytest.mark.parametrize("before", BEFORE)
def test_falling_disks_do_not_pass_into_each_other(O, before):
    """Two hundred of them, of unequal size. A thousandth of a radius: what the curvature of their paths leaves, a few 1e-4."""
    draw = random.Random(4)
    mat = plane.ground(0.3)
    for k in range(200):
        plane.disk((0.03 * (k % 10) + draw.uniform(-.003, .003), 0.03 * (k // 10 + 1)), draw.uniform(0.6, 1) * RADIUS, mat=mat)
    BEFORE[before](O)
    for b in O.bodies:
        if b.id > 0:
            b.state.vel = (0, -2, 0)
    rigid(O, 200, gravity=9.81)
    assert deepest(O) < 1e-3


@pytest.mark.parametrize("publish", ["always", "due"])
def test_a_collider_that_lists_more_than_the_engine_changes_nothing(O, publish):
    """It lists disks and boxes the disk first; published contacts have the boundary first, whoever made their interaction."""
    found = []
    for factor in (1, 3):
        O.reset()
        mat = plane.material(0.3)
        ids = [plane.disk((0.021 * k, 0.022 + 0.003 * (k % 3)), RADIUS, mat=mat) for k in range(6)]
        floor = plane.box((0.05, -THIN), (0.2, THIN), mat=mat)
        collider = w.InsertionSortCollider([w.Bo1_Sphere_Aabb(aabbEnlargeFactor=factor), w.Bo1_Box_Aabb()], verletDist=0)
        O.engines = [w.ForceResetter(), collider, cd_engine.ContactDynamics(gravity=(0, -9.81, 0), tolerance=1e-8, publish=publish)]
        O.dt = 1e-3
        for steps in (200, 100):
            O.run(steps, True)
            assert all(i.id1 == floor and i.geom.normal[1] > 0.99 for i in O.interactions if i.isReal and floor in (i.id1, i.id2))
        assert sum(floor in (i.id1, i.id2) for i in O.interactions if i.isReal) == len(ids)
        found.append(([tuple(O.bodies[i].state.pos) for i in ids], O.engines[-1].totalIterations))
    assert found[0] == found[1]


@pytest.mark.parametrize("collider", ["none", "without a functor for boxes"])
def test_pairs_do_not_hang_on_the_collider(O, collider):
    mat = plane.material(0)
    plane.box((0, 0), (1, THIN), mat=mat)
    disk = plane.disk((0, 0.5), RADIUS, velocity=(0, -30), mat=mat)
    between = [] if collider == "none" else [w.InsertionSortCollider([w.Bo1_Sphere_Aabb()], verletDist=0)]
    O.engines = [w.ForceResetter(), *between, cd_engine.ContactDynamics(gravity=(0, -9.81, 0))]
    O.dt = 1e-3
    O.run(60, True)
    assert O.bodies[disk].state.pos[1] == pytest.approx(THIN + RADIUS, abs=1e-12)
    assert O.interactions[0, disk].isReal
    O.run(20, True)
    O.bodies[disk].state.vel = (0, 1, 0)
    O.run(20, True)
    assert not O.interactions.has(0, disk, True)
