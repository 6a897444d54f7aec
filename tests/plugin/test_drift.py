"""Errors within the tolerance do not add up from step to step: bodies move as far as what moves them."""
import math

import pytest

from . import plane

G = 9.81


@pytest.mark.parametrize("mu", [0.5, 0.3, 0.1])
@pytest.mark.parametrize("speed", [1e-4, 3e-4])
def test_a_disk_pushed_slowly_moves_as_far_as_what_pushes_it(O, mu, speed):
    """It rolls, and nothing slows it down, so what it has gained stays. 1e-3: an error of the tolerance, 1e-6 g dt = 1e-8 m/s, ten times."""
    mat = plane.ground(mu)
    pusher = plane.box((-0.2, 0.1), (0.1, 0.09), mat=mat)
    disk = plane.disk((0, 0.1), 0.1, mat=mat)
    engine = plane.engine(gravity=(0, -G, 0))
    O.run(500, True)
    O.bodies[pusher].state.vel = (speed, 0, 0)
    O.run(20000, True)
    assert engine.converged and engine.unconvergedSteps == 0
    assert O.bodies[disk].state.pos[0] == pytest.approx(20 * speed, rel=1e-3)


def test_a_row_pushed_slowly_keeps_its_pace(O):
    """Eight disks, of which each pushes the next. Their first contact is solved to 1e-6 of the weight of all, 5e-7 m/s; nothing may be added."""
    mat = plane.ground(0.5)
    pusher = plane.box((-0.2, 0.1), (0.1, 0.09), mat=mat)
    disks = [plane.disk((0.2 * k, 0.1), 0.1, mat=mat) for k in range(8)]
    plane.engine(gravity=(0, -G, 0))
    O.run(500, True)
    O.bodies[pusher].state.vel = (1e-4, 0, 0)
    O.run(1000, True)
    before = [O.bodies[i].state.vel[0] for i in disks]
    O.run(9000, True)
    for i, speed in zip(disks, before):
        assert O.bodies[i].state.vel[0] == pytest.approx(speed, abs=1e-8) and speed == pytest.approx(1e-4, rel=0.01)


def test_disks_on_a_belt_stay_at_a_wall(O):
    """The belt slides under them for 1 cm. Each step may be wrong by 1e-6 g dt = 1e-8 m/s, of the speed and of a rotation: 1e-7 m a second."""
    mat = plane.material(0.3)
    belt = plane.box((0, -0.05), (50, 0.05), mat=mat)
    plane.box((0.03, 0.1), (0.02, 0.099), mat=mat)
    disks = [plane.disk((-0.02 * k, 0.01), 0.01, mat=mat) for k in range(5)]
    plane.engine(gravity=(0, -G, 0))
    O.run(500, True)
    O.bodies[belt].state.vel = (1e-3, 0, 0)
    before = [O.bodies[i].state.pos[0] for i in disks]
    O.run(10000, True)
    assert all(abs(O.bodies[i].state.pos[0] - x) < 1e-6 for i, x in zip(disks, before))


def test_what_friction_holds_on_a_slope_near_its_angle_stays(O):
    """Two layers of disks that cannot turn, at tan(a) = 0.9998 mu: in 10 s not even a millionth of the tolerance's free fall, 1e-6 g t^2/2."""
    mat = plane.ground(0.5)
    disks = [plane.disk((0.02 * k, 0.01), 0.01, blocked="zXYZ", mat=mat) for k in range(10)]
    disks += [plane.disk((0.02 * k + 0.01, 0.01 + 0.01 * math.sqrt(3)), 0.01, blocked="zXYZ", mat=mat) for k in range(9)]
    angle = math.atan(0.4999)
    plane.engine(gravity=(G * math.sin(angle), -G * math.cos(angle), 0))
    before = [O.bodies[i].state.pos[0] for i in disks]
    O.run(10000, True)
    assert all(abs(O.bodies[i].state.pos[0] - x) < 1e-8 for i, x in zip(disks, before))


@pytest.mark.parametrize("restarts", [False, True])
def test_a_block_on_a_slope_below_its_angle_holds_to_the_last_bit(O, restarts):
    """From tan(a) = 0.999999 mu down it never moves, also after it has slid to rest."""
    mat = plane.ground(0.5)
    block = plane.disk((0, 0.01), 0.01, blocked="zXYZ", velocity=(0.01 if restarts else 0, 0), mat=mat)
    angle = math.atan(0.5 * (0.9 if restarts else 0.999999))
    plane.engine(gravity=(G * math.sin(angle), -G * math.cos(angle), 0))
    O.run(1000, True)
    before = plane.digest()
    O.run(5000, True)
    assert O.bodies[block].state.vel.norm() == 0 and plane.digest() == before
