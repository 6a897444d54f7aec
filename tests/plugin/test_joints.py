"""Boundaries of several boxes: corners behind a face are no obstacles, all others are."""
import math

import pytest

from . import plane

G, R = 9.81, 0.01


def turned(x, y, angle):
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)


@pytest.mark.parametrize("angle", (0, 0.3, -1.1))
@pytest.mark.parametrize("friction", (0, 0.5))
def test_a_disk_goes_over_flush_boxes_as_over_one(O, angle, friction):
    """By half a radius a step: neither speed nor height change by more than round-off. It glides without friction and rolls with it. Two of the
    joints stand over a box whose own corners are inside the floor."""
    mat = plane.material(friction)
    for k in range(12):
        plane.box(turned(0.1 * k, -0.01, angle), (0.05, 0.01), angle, mat=mat)
    plane.box(turned(0.3, -0.03, angle), (0.06, 0.025), angle, mat=mat)
    i = plane.disk(turned(0, R, angle), R, velocity=turned(1, 0, angle), spin=-1 / R if friction else 0, mat=mat)
    plane.run(200, R / 2, gravity=(*turned(0, -G, angle), 0), tolerance=1e-8)
    state = O.bodies[i].state
    assert (state.vel[0], state.vel[1]) == pytest.approx(turned(1, 0, angle), abs=1e-11)
    assert turned(state.pos[0], state.pos[1], -angle)[1] == pytest.approx(R, abs=1e-11)


def test_a_step_up_is_an_obstacle(O):
    """Of a tenth of a radius: the impact on its edge leaves 0.9 of the speed, along the tangent there; landing leaves 0.9 of that, along the
    floor."""
    mat = plane.material(0)
    plane.box((0, -0.01), (0.1, 0.01), mat=mat)
    plane.box((0.2, -0.01 + 0.1 * R), (0.1, 0.01), mat=mat)
    i = plane.disk((0, R), R, velocity=(1, 0), mat=mat)
    plane.run(1, 1e-5, gravity=(0, -G, 0))
    speeds = []
    for _ in range(130):
        O.run(100, True)
        speeds.append(O.bodies[i].state.vel.norm())
    assert speeds[50] == pytest.approx(1, abs=1e-9) and speeds[-1] == pytest.approx(0.81, rel=5e-3)  # a step is 1e-3 R long


@pytest.mark.parametrize("x", (0, 1e-3, -4e-3))
def test_a_ridge_holds(O, x):
    """Two boxes that fall off to both sides meet in an edge: a disk above it does not sink in."""
    mat = plane.material(0)
    for side in (-1, 1):
        plane.box(turned(side * 0.1, -0.01, -side * 0.4), (0.1, 0.01), -side * 0.4, mat=mat)
    plane.disk((x, 1.2 * R), R, mat=mat)
    engine = plane.run(100, 1e-3, gravity=(0, -G, 0))
    assert engine.unconvergedSteps == 0 and engine.contacts > 0 and engine.deepestPenetration < 1e-3 * R


@pytest.mark.parametrize("phase", (0, 0.25, 0.5, 0.75))
@pytest.mark.parametrize("motion", ("rises", "turns", "floor sinks"))
def test_a_corner_that_comes_out_lifts_a_disk(O, motion, phase):
    """It is below the floor at first, and passes it in a part of a step. The disk can only move upwards and rests on the floor."""
    mat = plane.material(0)
    speed, dt = 0.1, 1e-3
    below = 10.5 * speed * dt + phase * speed * dt
    floor = plane.box((0, -0.01), (0.1, 0.01), mat=mat)
    other = plane.box((0.2, -0.01 - below), (0.1, 0.01), mat=mat)
    i = plane.disk((0.1 - 0.3 * R, R), R, mat=mat, blocked="xzXYZ")
    if motion == "floor sinks":
        O.bodies[floor].state.vel = (0, -speed, 0)
        O.bodies[i].state.vel = (0, -speed, 0)
    elif motion == "rises":
        O.bodies[other].state.vel = (0, speed, 0)
    else:
        O.bodies[other].state.angVel = (0, 0, -speed / 0.1)  # about its centre
    engine = plane.run(1, dt, gravity=(0, -G, 0), tolerance=1e-8)
    O.run(49, True)
    assert engine.unconvergedSteps == 0 and engine.deepestPenetration < 1e-6 * R
    assert O.bodies[i].state.pos[1] > R + 1e-3 or motion == "floor sinks"


@pytest.mark.parametrize("speed", (0.1, 0.3))
def test_a_free_plate_uncovers_a_corner(O, speed):
    """A disk falls on a light plate flush with a fixed box, which gives way in the same step: the corner of the box then holds the disk."""
    mat = plane.material(0)
    plane.box((0.2, -0.01), (0.1, 0.01), mat=mat)
    plate = plane.box((0, -0.01), (0.1, 0.01), mat=mat, blocked="xzXYZ", mass=0.1)
    plane.disk((0.1 - 0.6 * R, 1.2 * R), R, mat=mat, velocity=(0, -speed * R / 1e-3))
    engine = plane.run(20, 1e-3, tolerance=1e-8)
    assert O.bodies[plate].state.vel[1] < 0
    assert engine.unconvergedSteps == 0 and engine.deepestPenetration < 1e-6 * R


@pytest.mark.parametrize("beside, step, loses", [("corner", 0.5, 0.08), ("corner", 0.2, 0.02), ("disk", 0.5, 0.03), ("disk", 0.2, 0.005)])
def test_what_a_near_miss_takes(O, beside, step, loses):
    """At a clearance of R/1000 nothing touches; the plane of the contact does. The numbers of the manual, to their last digit."""
    mat = plane.material(0)
    if beside == "corner":
        plane.box((0.05, -0.05), (0.05, 0.05), mat=mat)
    else:
        plane.disk((0, -R), R, blocked="xyzXYZ", mat=mat)
    i = plane.disk((-0.0493, 1.001 * R), R, velocity=(1, 0), mat=mat)
    plane.run(round(0.1 / (step * R)), step * R, tolerance=1e-8)
    assert 1 - O.bodies[i].state.vel[0] == pytest.approx(loses, abs=0.005 if loses > 0.01 else 0.0005)
