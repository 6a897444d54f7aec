"""Boxes that turn at a prescribed speed, inside YADE: bounds, contacts and orientation have to fit together."""
import math

import pytest
import yade

import cd_engine
from yade_scripts.running import hooks

from . import plane

RADIUS, THIN, LENGTH = 0.011, 0.5e-3, 0.5  # of the disks, half of the paddle's thickness and length [m]
SPIN = 60.0  # [rad/s]: in a step of 1 ms the tip of the paddle goes 2.7 radii


def in_paddle(O, paddle, disk):
    """Return the place of a disk along and across the paddle, and the cosine and sine of the paddle's angle."""
    q = O.bodies[paddle].state.ori
    c, s = q[3]**2 - q[2]**2, 2 * q[2] * q[3]
    d = O.bodies[disk].state.pos - O.bodies[paddle].state.pos
    return c * d[0] + s * d[1], -s * d[0] + c * d[1], c, s


@pytest.mark.parametrize("at_once", [1, 300], ids=["step by step", "in one run, the collider resting"])
@pytest.mark.parametrize("centre", [0.0, 3.0])
def test_a_paddle_takes_every_disk_in_its_way_with_it(O, at_once, centre):
    """Disks at rest in its way, near the tip, where one that is not foreseen is passed through. None is beyond the paddle, and each is as fast
    as the paddle where it was hit, or faster, being thrown outwards. Spaced so that they do not meet before they have left it."""
    for k in range(5):
        O.reset()
        mat = plane.material(0)
        paddle = plane.box((centre, 0), (LENGTH, THIN), mat=mat)
        O.bodies[paddle].state.angVel = (0, 0, SPIN)
        angle, distance = 0.3 + 0.17 * k, 0.4
        disk = plane.disk((centre + distance * math.cos(angle), distance * math.sin(angle)), RADIUS, mat=mat)
        plane.run(at_once, 1e-3, tolerance=1e-12)
        done = at_once
        while done < round((angle + 0.3) / SPIN / 1e-3):
            along, across, _, _ = in_paddle(O, paddle, disk)
            # A step ends half a step's turning off the place where contact is required: (w h)^2/8 of the distance.
            assert across > THIN + RADIUS - 0.06**2 / 8 * LENGTH - 1e-9 or along > LENGTH, (angle, done)
            O.run(at_once, True)
            done += at_once
        v = O.bodies[disk].state.vel
        assert v.norm() > 0.99 * SPIN * distance, angle


def drum(O, step, turns, mu):
    """A disk pressed by its own inertia on the middle of one of eight boxes that turn about the origin: how far it is from where it should be [m].

    The velocities of the boxes change in every step, which contact learns half a step late: gapCorrection takes the overlap back, which would
    otherwise grow by half a step times the change of velocity, and by gapVelocity what is missing in the disk's velocity, too.
    """
    spin, inner, half, radius = 5.0, 0.5, 0.05, 0.1
    mat = plane.material(mu)
    places, boxes = [], []
    for k in range(8):
        angle = math.pi / 4 * k
        places.append(((inner + half) * math.cos(angle), (inner + half) * math.sin(angle)))
        boxes.append(plane.box(places[-1], (half, inner * math.tan(math.pi / 8)), angle=angle, mat=mat))
    disk = plane.disk((inner - radius, 0), radius, velocity=(0, spin * (inner - radius)), spin=spin, mat=mat)

    def turn():
        """The velocities that take the boxes in a straight way to where they should be."""
        now, then = spin * yade.O.time, spin * (yade.O.time + yade.O.dt)
        for box, (x, y) in zip(boxes, places):
            dc, ds = (math.cos(then) - math.cos(now)) / yade.O.dt, (math.sin(then) - math.sin(now)) / yade.O.dt
            state = yade.O.bodies[box].state
            state.vel, state.angVel = (dc * x - ds * y, ds * x + dc * y, 0), (0, 0, spin)

    reset, collider, engine = cd_engine.engines(tolerance=1e-13, gapCorrection=1, gapVelocity=True, allowedOverlap=0)
    O.engines = [reset, hooks.runner(turn, iterPeriod=1, initRun=True), collider, engine]
    O.dt = step
    O.run(round(turns * 2 * math.pi / spin / step), True)
    end = spin * O.time
    pos = O.bodies[disk].state.pos
    return math.hypot(pos[0] - (inner - radius) * math.cos(end), pos[1] - (inner - radius) * math.sin(end))


def test_a_drum_made_of_boxes_carries_a_disk_round_to_second_order(O):
    """Sticking to the wall, it turns with the drum as one body. A quarter of a turn: on a flat wall it is in an unstable balance."""
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        O.reset()
        errors.append(drum(O, step, 0.25, mu=0.8))
    assert errors[0] < 2e-3 * 0.1, errors  # a five hundredth of the radius at (w h)^2 = 4e-4
    for coarse, fine in zip(errors, errors[1:]):
        assert coarse / fine == pytest.approx(4, rel=0.02), errors  # half of the step, a quarter of the error


def test_five_touching_disks_at_a_wall_hit_by_a_sixth_make_no_energy(O):
    """By restitutions up to 1, after every step: round-off and the tolerance."""
    for e in (0.5, 0.8, 0.9, 0.95, 1.0):
        O.reset()
        mat = plane.ground(0)
        for k in range(5):
            plane.disk((0, 0.1 * (2 * k + 1)), 0.1, mat=mat)
        plane.disk((0, 1.1005), 0.1, velocity=(0, -1), mat=mat)
        plane.run(1, 1e-3, restitution=e, tolerance=1e-12, maxIterations=100000)
        last = 0.5
        for _ in range(300):
            O.step()
            now = plane.kinetic_energy()
            assert now <= last * (1 + 1e-9), (e, O.iter)
            last = now
        assert e < 1 or last == pytest.approx(0.5, rel=1e-7)


def test_a_disk_on_a_plate_that_is_carried_round_sinks_in_and_the_engine_says_so_twice(O, capfd):
    """By w^2 R dt t/2, where R is the distance of the plate's centre (manual, driven boundaries): 0.33 of its radius in 0.25 s. A hundredth and a
    quarter of a radius have a line each."""
    w, distance, radius, dt, steps = 10.0, 0.5, 0.02, 1e-3, 250
    for centre, half in (((0, distance + radius + 0.01), (0.1, 0.01)), ((-radius - 0.01, distance), (0.01, 0.02)),
                         ((radius + 0.01, distance), (0.01, 0.02))):
        plane.box(centre, half)
    disk = plane.disk((0, distance), radius, velocity=(-w * distance, 0), spin=w)
    reset, collider, engine = cd_engine.engines()
    O.engines = [reset, collider, yade.wrapper.RotationEngine(ids=[0, 1, 2], rotationAxis=(0, 0, 1), rotateAroundZero=True, zeroPoint=(0, 0, 0),
                                                              angularVelocity=w), engine]
    O.dt = dt
    O.run(steps, True)
    centre = distance + radius + 0.01
    assert O.bodies[disk].state.pos.norm() - distance == pytest.approx(w**2 * centre * dt * steps * dt / 2, rel=w * dt)  # of first order
    said = [line for line in capfd.readouterr().err.splitlines() if "overlap by" in line]
    assert len(said) == 2 and engine.unconvergedSteps == 0
