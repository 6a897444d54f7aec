"""What no step may change or create: momentum, angular momentum, energy; and what it must keep: cone, gap, determinism."""
import math
import random

import numpy as np
import pytest

from . import plane


@pytest.mark.parametrize("restitution", [0, 0.5, 1])
def test_collisions_keep_momentum_and_angular_momentum_and_create_no_energy(O, restitution):
    """400 steps of 40 colliding disks; the momenta to round-off. With restitution and friction together Newton's law may
    create energy in simultaneous impacts (Kane's paradox); here contacts close one by one."""
    plane.cloud(40, seed=1)
    before, energy = plane.momenta(), plane.kinetic_energy()
    hits = 0
    cd = plane.run(1, 1e-3, tolerance=1e-12, restitution=restitution, maxIterations=100000)
    for _ in range(20):
        O.run(20, True)
        now = plane.kinetic_energy()
        assert now <= energy * (1 + 1e-12)
        energy = now
        hits += cd.contacts
    assert cd.dissipatedEnergy > 0 and hits > 0
    assert plane.momenta() == pytest.approx(before, abs=1e-12 * np.abs(before).max() * 400 + 1e-13)


def test_energy_lost_is_the_dissipation_reported(O):
    """Sum over contacts of -p (u + u')/2 against the kinetic energy: an identity of the scheme, round-off over 300 steps."""
    plane.cloud(40, seed=2)
    start = plane.kinetic_energy()
    cd = plane.run(300, 1e-3, tolerance=1e-12, maxIterations=100000)
    assert cd.dissipatedEnergy > 0.01 * start
    assert start - plane.kinetic_energy() == pytest.approx(cd.dissipatedEnergy, rel=1e-11)


def test_energy_balance_with_gravity_and_friction(O):
    """Work of the weights = kinetic energy + dissipation, exact for the scheme: the mean velocity moves the body."""
    plane.heap(mu=0.3)
    potential = lambda: sum(9.81 * b.state.mass * b.state.pos[1] for b in O.bodies if b.state.blockedDOFs == "zXY")
    start = potential()
    cd = plane.run(800, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-9, maxIterations=100000)
    assert start - potential() - plane.kinetic_energy() == pytest.approx(cd.dissipatedEnergy, rel=1e-10)
    # The overlap that is left by the curvature of the paths, second order in dt.
    assert cd.maxPenetration < 1e-4 * 0.02


def test_a_free_box_takes_part_in_the_balance_of_angular_momentum(O):
    """A disk meets the end of a bar that may move and turn (a general 2 x 2 contact)."""
    plane.box((0, 0), (0.3, 0.02), blocked="zXY", mass=3.0, inertia=0.1, angle=0.2)
    plane.disk((0.2, 0.3), 0.03, mass=1.0, velocity=(0.1, -1.0), spin=20)
    before, energy = plane.momenta(), plane.kinetic_energy()
    cd = plane.run(600, 1e-3, tolerance=1e-13)
    assert cd.dissipatedEnergy > 0
    assert O.bodies[0].state.angVel[2] != 0
    assert plane.momenta() == pytest.approx(before, abs=1e-12)
    assert plane.kinetic_energy() < energy


def test_forces_lie_in_the_cone_and_sliding_ones_on_it(O):
    """In every sampled state of a falling heap, for what YADE's interactions say."""
    plane.heap(mu=0.25)
    cd = plane.run(1, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-9, maxIterations=100000)
    seen = sliding = 0
    for _ in range(40):
        O.run(20, True)
        on_cone = 0
        for i in (i for i in O.interactions if i.isReal):
            n, t = i.phys.normalForce.dot(i.geom.normal), i.phys.shearForce.norm()
            assert n > 0 and t <= 0.25 * n * (1 + 1e-12)
            assert abs(i.phys.shearForce.dot(i.geom.normal)) <= 1e-12 * (n + t)
            on_cone += t >= 0.25 * n * (1 - 1e-9)
            seen += 1
        assert on_cone == cd.slidingContacts
        sliding += on_cone
    assert seen > 400 and sliding > 10


def test_a_scene_saved_after_steps_without_sweeps_goes_on_bitwise(O, tmp_path):
    """Where a step needs no sweep, velocities are summed in another order; whether the next one begins so is part of the saved state."""
    without = 0
    for at in range(5, 120, 5):
        O.reset()
        plane.floor()
        for k in range(16):
            row, column = divmod(k, 4)
            plane.disk((0.01 * (2 * column + 1 + row % 2 + 1e-4 * math.sin(k)), 0.01 * (1 + row * math.sqrt(3))), 0.01)
        engine = plane.run(at, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-2)
        without += engine.iterations == 0 and engine.sleeping == 0
        plane.goes_on(tmp_path / "half.yade.gz", 21)
    assert without


@pytest.mark.parametrize("tolerance", [1e-4, 2e-3, 1e-2, 1e-1])
def test_an_elastic_disk_in_a_cage_gains_no_energy_at_any_tolerance(O, tolerance):
    """Weightless, between three fixed disks with friction, which lets Newton's law create energy; a little in every impact would add up. The energy
    after each hundred steps is at most that at the start, up to what one step may add: 1e-5 of sum m |dv|^2, which is 8 times the energy at most."""
    mat = plane.material(0.1)
    for k in range(3):
        a = 2 * math.pi * k / 3 + 0.2 * k
        plane.disk((0.0200028 * math.cos(a), 0.0200028 * math.sin(a)), 0.01, blocked="xyzXYZ", mat=mat)
    plane.disk((0, 0), 0.01, velocity=(0.479, 0.682), mat=mat)
    before = plane.kinetic_energy()
    cd = plane.engine(1e-3, restitution=1, tolerance=tolerance)
    for _ in range(20):
        O.run(100, True)
        assert plane.kinetic_energy() < before * (1 + 8e-5)
    assert cd.unconvergedSteps == 0


@pytest.mark.parametrize("tolerance", [1e-4, 1e-2])
def test_an_elastic_gas_keeps_its_energy_as_exactly_as_steps_are_solved(O, tolerance):
    """49 dense disks without friction, e = 1. The error of a solution changes the energy in a step by up to 8 tolerances (sum m |dv|^2 is 8 times the
    energy at most), forth and back; rebounds are not lowered because of it, which would add up."""
    mat = plane.material(0)
    for x, y, half in ((0.075, -0.01, (0.1, 0.01)), (0.075, 0.16, (0.1, 0.01)), (-0.01, 0.075, (0.01, 0.1)), (0.16, 0.075, (0.01, 0.1))):
        plane.box((x, y), half, mat=mat)
    r = random.Random(1)
    for k in range(49):
        plane.disk((0.0105 + 0.0215 * (k % 7), 0.0105 + 0.0215 * (k // 7)), 0.01, velocity=(r.uniform(-1, 1), r.uniform(-1, 1)), mat=mat)
    before = plane.kinetic_energy()
    plane.run(1000, 5e-4, restitution=1, tolerance=tolerance)
    assert plane.kinetic_energy() == pytest.approx(before, rel=8 * tolerance)
