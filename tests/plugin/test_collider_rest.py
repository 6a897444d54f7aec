"""Pairs are searched anew when bodies have left their margins; YADE's collider rests. Both change only the cost."""
import math

import numpy as np
import pytest
from yade import utils, wrapper

import cd_engine
from yade_scripts.running.hooks import runner

from . import plane


def run(O, steps, at_once, **settings):
    """Make the steps in runs of `at_once` steps; in runs of one step the collider never rests. Return the collider."""
    plane.engine(tolerance=1e-9, maxIterations=100000, **settings)
    for _ in range(steps // at_once):
        O.run(at_once, True)
    return O.engines[1]


@pytest.mark.parametrize("scene, settings", [
    (lambda O: plane.heap(mu=0.3), dict(gravity=(0, -9.81, 0))),
    (lambda O: plane.cloud(40, seed=6, speed=3), {}),
], ids=["falling heap", "fast cloud"])
def test_results_are_the_same_to_the_last_bit(O, scene, settings):
    """The motions are many radii long, so that the collider must work many times."""
    hashes = []
    for at_once in (1, 300):
        O.reset()
        scene(O)
        run(O, 300, at_once, **settings)
        hashes.append(plane.digest())
    assert hashes[0] == hashes[1]


def test_it_rests_within_a_run_and_is_awake_after_it(O):
    plane.heap(mu=0.3)
    O.timingEnabled = True
    try:
        collider = run(O, 1500, 1500, gravity=(0, -9.81, 0))  # at rest at the end
        before = collider.execCount
        O.run(200, True)
        assert collider.execCount - before == 1  # the first step of a run
        assert not collider.dead
    finally:
        O.timingEnabled = False


@pytest.mark.parametrize("change", ["move a disk by hand", "append a disk", "grow a disk"])
def test_what_the_user_changes_between_or_within_runs_is_noticed(O, change):
    """The change makes a contact that only a new search can find."""
    plane.floor()
    low = plane.disk((0, 0.1), 0.1)
    far = plane.disk((1, 0.1), 0.1, mass=2.0)

    def act():
        if O.iter != 20:
            return
        if change == "move a disk by hand":
            O.bodies[far].state.pos = (0, 0.3, 0)
        elif change == "append a disk":
            plane.disk((0, 0.3), 0.1, mass=2.0)
        else:
            O.bodies[far].shape.radius = 0.9

    reset, collider, cd = cd_engine.engines(gravity=(0, -9.81, 0), tolerance=1e-12)
    O.engines = [reset, runner(act, iterPeriod=1, initRun=True), collider, cd]
    O.dt = 1e-3
    O.run(40, True)
    if change == "grow a disk":
        assert cd.contacts == 3  # with each other and with the floor; nothing presses the two together
    else:
        top = far if change == "move a disk by hand" else len(O.bodies) - 1
        assert O.interactions[low, top].phys.normalForce.norm() == pytest.approx(2 * 9.81)


@pytest.mark.parametrize("speed", [1, 5, 20, 100])
def test_fast_disks_do_not_pass_through_walls_or_each_other(O, speed):
    """At 100 m/s a disk of 1 cm goes ten radii a step; pairs are listed as far as a step needs."""
    plane.floor()
    falling = plane.disk((0, 0.333), 0.01, velocity=(0, -speed))
    left, right = plane.disk((10, 0.5), 0.01, velocity=(speed, 0)), plane.disk((10.777, 0.5), 0.01, velocity=(-speed, 0))
    plane.engine(tolerance=1e-12)
    O.run(round(0.5 / speed / 1e-3) + 10, True)
    assert O.bodies[falling].state.pos[1] == pytest.approx(0.01, abs=1e-12)
    assert O.bodies[right].state.pos[0] - O.bodies[left].state.pos[0] == pytest.approx(0.02, abs=1e-9)
    assert O.engines[-1].dissipatedEnergy == pytest.approx(1.5 * speed**2, rel=1e-9)


def test_the_list_of_pairs_may_be_cleared_by_somebody_else(O):
    ids, = plane.columns(0, disks=5)
    clear = runner(lambda: O.iter == 50 and O.interactions.clear(), iterPeriod=1)
    O.engines = [clear] + cd_engine.engines(gravity=(0, -9.81, 0), tolerance=1e-10)
    O.dt = 1e-4
    O.run(300, True)
    assert [O.bodies[i].state.pos[1] for i in ids] == pytest.approx([0.01 + 0.02 * k for k in range(5)], abs=1e-9)


def test_it_is_awake_for_a_factory_of_spheres(O):
    """YADE's factories ask the collider for free space; without its answer disks are put into each other."""
    plane.material()
    factory = wrapper.BoxFactory(center=(0, 0.5, 0), extents=(0.08, 0, 0), rMin=0.008, rMax=0.01, vMin=0.1, vMax=0.1, vAngle=0, massFlowRate=0.1,
                                 maxParticles=20, normal=(0, -1, 0), blockedDOFs="zXY", materialId=0, exactDiam=False)
    O.engines, O.dt = cd_engine.engines(gravity=(0, -9.81, 0)) + [factory], 1e-3
    O.run(700, True)
    assert len(O.bodies) == 20 and O.engines[2].deepestPenetration < 1e-4 * 0.008


@pytest.mark.parametrize("count, anew", [(300, False), (1200, True)])
def test_it_sorts_anew_where_many_bodies_have_moved(O, count, anew):
    """YADE's insertion sort takes 6 s for 40 000 facets that have turned, a sort from the beginning 0.5 s. It finds the same pairs."""
    angle = 2 * math.pi / count
    ends = [(math.cos(k * angle), math.sin(k * angle)) for k in range(count + 1)]
    ring = O.bodies.append([utils.facet([(*a, 0), (*b, 0), (1.02 * b[0], 1.02 * b[1], 0.01)]) for a, b in zip(ends, ends[1:])])
    O.bodies.append(utils.sphere((0, 0, 0), 0.01))
    plane.engine()
    O.engines = [*O.engines[:2], wrapper.RotationEngine(ids=ring, rotationAxis=(0, 0, 1), rotateAroundZero=True, angularVelocity=1.0), O.engines[-1]]
    O.dt = 1e-2
    O.run(60, True)
    assert O.engines[1].doSort == anew
    O.run(1, True)
    assert not O.engines[1].doSort
    near = [b.bound for b in O.bodies]
    low, high = (np.array([getattr(bound, end) for bound in near]) for end in ("min", "max"))
    overlap = (np.minimum(high[:, None], high) - np.maximum(low[:, None], low)).min(axis=2)
    expected = {(one, other) for one, other in zip(*np.nonzero(overlap > 1e-9)) if one < other}  # neighbours have a corner in common
    assert expected and {pair for pair in expected if not O.interactions.has(*map(int, pair))} == set()
