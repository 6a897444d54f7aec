"""Belts: a Wall that moves along itself, which is endless, so that its surface moves and the wall stays; and bodies that `mask` keeps in place."""
import math

import pytest
from yade import utils, wrapper as w

from . import plane


@pytest.mark.parametrize("speed", [0.6, -0.6])
def test_what_is_put_on_a_belt(O, speed):
    """Until it has the belt's speed V a block is driven by mu g. So is a disk of I = m R^2/2 until it rolls, at V/3 after V/(3 mu g)."""
    mu, g, dt = 0.3, 9.81, 1e-3
    mat = plane.material(mu)
    O.bodies.append(utils.wall(0, axis=1, sense=1, material=mat))
    O.bodies[0].state.vel = (speed, 0, 0)
    block, disk = plane.disk((0, 0.1), 0.1, blocked="zXYZ", mat=mat), plane.disk((1, 0.1), 0.1, mat=mat)
    plane.engine(dt, gravity=(0, -g, 0))
    O.run(50, True)
    sign = speed / abs(speed)
    assert [O.bodies[i].state.vel[0] for i in (block, disk)] == pytest.approx([sign * mu * g * 50 * dt] * 2, rel=1e-5)
    assert O.bodies[disk].state.angVel[2] == pytest.approx(sign * 2 * mu * g * 50 * dt / 0.1, rel=1e-5)
    O.run(250, True)
    assert O.bodies[block].state.vel[0] == pytest.approx(speed, rel=1e-6)
    assert O.bodies[disk].state.vel[0] == pytest.approx(speed / 3, rel=1e-4) and O.bodies[disk].state.angVel[2] * 0.1 == pytest.approx(
        speed - O.bodies[disk].state.vel[0], rel=1e-4)


G = 9.81


def belt(O, speed, angle=0., mu=0.5, half=(1, 0.05), mat=None):
    """Append a box whose surface moves along its upper face, which passes through the origin. Return its id."""
    body = plane.box((0.05 * math.sin(angle), -0.05 * math.cos(angle)), half, angle, mat=plane.material(mu) if mat is None else mat)
    O.bodies[body].state.vel = (speed * math.cos(angle), speed * math.sin(angle), 0)
    return body


def block(O, place, mat):
    """Append a disk that does not turn, in a group that shares a bit with mask=4, as boundaries do not. Return its id."""
    body = plane.disk(place, 0.1, mass=2, blocked="zXYZ", mat=mat)
    O.bodies[body].groupMask = 5
    return body


@pytest.mark.parametrize("settings", [dict(), dict(method="nsgs"), dict(stiffness=1e7, tangentialStiffness=5e6)], ids=str)
def test_a_box_as_a_belt_stays_and_carries(O, settings):
    """A block at rest is driven by mu g to the belt's speed V; the belt does the work m V^2, of which half is lost. The box and its State stay."""
    speed, mu = 0.6, 0.5
    mat = plane.material(mu)
    box = belt(O, speed, mat=mat, half=(5, 0.05))
    body = block(O, (0, 0.1), mat)
    place = tuple(O.bodies[box].state.pos)
    cd = plane.run(60, 1e-3, gravity=(0, -G, 0), mask=4, **settings)
    rigid = not settings.get("stiffness")
    assert O.bodies[body].state.vel[0] == pytest.approx(mu * G * 0.06, rel=1e-5 if rigid else 0.03)
    assert O.forces.f(box)[0] == pytest.approx(-mu * 2 * G, rel=1e-5 if rigid else 0.03)
    O.run(400, True)
    assert O.bodies[body].state.vel[0] == pytest.approx(speed, rel=1e-5 if rigid else 1e-3)
    assert cd.dissipatedEnergy == pytest.approx(0.5 * 2 * speed**2, rel=1e-5 if rigid else 0.02)
    assert tuple(O.bodies[box].state.pos) == place and tuple(O.bodies[box].state.vel) == (speed, 0, 0)
    assert cd.unconvergedSteps == 0


def test_an_inclined_belt_carries_upwards_and_its_end_pushes_nothing(O):
    angle, speed = math.atan(0.4), 0.3
    mat = plane.material(0.6)
    belt(O, speed, angle, mat=mat, half=(3, 0.05))
    c, s = math.cos(angle), math.sin(angle)
    body = block(O, (-0.1 * s, 0.1 * c), mat)
    beside = block(O, (3.1 * c + 0.05 * s, 3.1 * s - 0.05 * c), mat)  # touches the end of the box, on a table
    start = tuple(O.bodies[beside].state.pos)
    plane.box((start[0] + 0.4, start[1] - 0.15), (0.5, 0.05), mat=mat)
    plane.run(500, 1e-3, gravity=(0, -G, 0), mask=4)
    assert tuple(O.bodies[body].state.vel) == pytest.approx((speed * c, speed * s, 0), rel=1e-5)
    assert tuple(O.bodies[beside].state.pos) == pytest.approx(start, abs=1e-6)


def test_a_belt_that_starts_wakes_what_sleeps_on_it(O):
    mat = plane.material(0.5)
    box = belt(O, 0, mat=mat, half=(5, 0.05))
    body = block(O, (0, 0.1), mat)
    cd = plane.run(200, 1e-3, gravity=(0, -G, 0), mask=4)
    assert cd.sleeping == 1
    O.bodies[box].state.vel = (0.1, 0, 0)
    O.run(100, True)
    assert O.bodies[body].state.vel[0] == pytest.approx(0.1, rel=1e-5) and "belt" in cd.woken
    cd.mask = 0  # now it is a box that moves
    O.run(10, True)
    assert O.bodies[box].state.pos[0] == pytest.approx(1e-3, rel=1e-9)


def test_a_wheel_on_a_belt_without_and_with_rolling_resistance(O):
    """It rolls at V/3 for I = m R^2/2; rolling resistance then brings it to rest on the belt."""
    for eta in (0, 0.1):
        O.reset()
        mat = O.materials.append(w.CohFrictMat(frictionAngle=math.atan(0.5), etaRoll=eta, momentRotationLaw=True, density=1000))
        belt(O, 0.6, mat=mat, half=(5, 0.05))
        wheel = plane.disk((0, 0.1), 0.1, mat=mat)
        O.bodies[wheel].groupMask = 5
        plane.run(1000, 1e-3, gravity=(0, -G, 0), mask=4)
        s = O.bodies[wheel].state
        assert (s.vel[0], 0.1 * s.angVel[2]) == pytest.approx((0.2, 0.4) if eta == 0 else (0.6, 0), abs=1e-4)


def test_only_a_boundary_can_be_a_belt(O):
    mat = plane.ground(0.5)
    plane.disk((0, 0.1), 0.1, mat=mat)
    plane.engine(1e-3, gravity=(0, -G, 0), mask=4)
    with pytest.raises(RuntimeError, match="groupMask"):
        O.run(1, True)
