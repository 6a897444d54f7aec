"""cd_engine.timeStep: its formula, and what it refuses."""
import math

import pytest
import yade
from yade import utils, wrapper

import cd_engine

from . import plane

G = 9.81


def test_a_fall_sets_it(O):
    """The smallest movable disk, at the speed of a fall from the highest disk to the lowest body."""
    plane.floor()
    plane.disk((0, 0.51), 0.01)
    plane.disk((1, 0.3), 0.005)
    plane.disk((2, 0.1), 0.001, blocked="xyzXYZ")
    O.engines = cd_engine.engines(gravity=(0, -G, 0))
    assert cd_engine.timeStep() == pytest.approx(0.25 * 0.005 / math.sqrt(2 * G * 0.51))
    assert cd_engine.timeStep(share=1, gravity=(0, -4 * G, 0)) == pytest.approx(0.5 * 0.005 / math.sqrt(2 * G * 0.51))


def test_the_fall_ends_on_a_box_not_in_it(O):
    plane.disk((0, 0.5), 0.01)
    plane.box((0, -1), (1, 2), angle=math.pi / 2)  # turned: 1 m high from its middle, so that its top is at 0
    assert cd_engine.timeStep(gravity=(0, -G, 0)) == pytest.approx(0.25 * 0.01 / math.sqrt(2 * G * 0.5))


@pytest.mark.parametrize("slope", [30, 60, 89])
def test_the_fall_ends_at_the_foot_of_a_slope(O, slope):
    """A chute and nothing below it: a disk slides to the lower end of its upper face, however steep that is."""
    angle = math.radians(slope)
    plane.box((0, 0), (1, 0.02), angle=angle)
    plane.disk((0, 0.5), 0.01)
    foot = -math.sin(angle) + 0.02 * math.cos(angle)
    assert cd_engine.timeStep(gravity=(0, -G, 0)) == pytest.approx(0.25 * 0.01 / math.sqrt(2 * G * (0.5 - foot)))


def test_the_speeds_present_count(O):
    plane.disk((0, 0), 0.01, velocity=(3, 4))
    O.engines = cd_engine.engines()
    assert cd_engine.timeStep() == pytest.approx(0.25 * 0.01 / 5)
    turning = plane.box((5, 0), (1, 0), blocked="xyzXYZ")
    O.bodies[turning].state.angVel = (0, 0, 100)
    assert cd_engine.timeStep() == pytest.approx(0.25 * 0.01 / (100 * math.hypot(1, 0.5)))


CENTRE = dict(rotationAxis=(0, 0, 2), rotateAroundZero=True, zeroPoint=(0, 1, 3))


@pytest.mark.parametrize("engine, speed", [
    (lambda: wrapper.RotationEngine(**CENTRE, angularVelocity=-5.0), lambda size, away: 5 * (away + size)),
    (lambda: wrapper.RotationEngine(rotationAxis=(0, 0, 1), angularVelocity=5.0), lambda size, away: 5 * size),
    (lambda: wrapper.HelixEngine(**CENTRE, angularVelocity=5.0, linearVelocity=2.0), lambda size, away: 5 * (away + size) + 2),
    (lambda: wrapper.TranslationEngine(translationAxis=(1, 0, 0), velocity=-4.0), lambda size, away: 4),
    (lambda: wrapper.HarmonicMotionEngine(A=(0.3, 0, 0.4), f=(2, 2, 2)), lambda size, away: 2 * math.pi),
    (lambda: wrapper.HarmonicRotationEngine(A=0.5, f=2, rotationAxis=(0, 0, 1)), lambda size, away: 2 * math.pi * size),
    (lambda: wrapper.BicyclePedalEngine(rotationAxis=(0, 0, 1), angularVelocity=5.0, radius=0.7), lambda size, away: 3.5),
    (lambda: wrapper.CombinedKinematicEngine(comb=[wrapper.TranslationEngine(translationAxis=(1, 0, 0), velocity=4.0),
                                                   wrapper.RotationEngine(**CENTRE, angularVelocity=5.0)]), lambda size, away: 4 + 5 * (away + size)),
    (lambda: wrapper.InterpolatingHelixEngine(**CENTRE, times=[0, 1], angularVelocities=[1, -5], slope=0.4),
     lambda size, away: 5 * (away + size) + 2),
], ids=["turns", "spins", "helix", "moves", "shakes", "swings", "pedals", "combined", "interpolated"])
def test_the_speeds_that_engines_will_give_count(O, engine, speed):
    """Before the first step nothing moves yet."""
    facet = utils.facet([(1, 1, 0), (3, 1, 0), (2, 1.1, 0)])
    O.bodies.append(facet)
    O.bodies.append(utils.sphere((0, 0, 0), 0.01))
    drives = engine()
    drives.ids = [0]
    O.engines = [*cd_engine.engines(), drives]
    size, away = max(corner.norm() for corner in facet.shape.vertices), (facet.state.pos - yade.Vector3(0, 1, 0)).norm()
    assert cd_engine.timeStep() == pytest.approx(0.25 * 0.01 / speed(size, away))
    drives.dead = True
    with pytest.raises(ValueError, match="nothing moves"):
        cd_engine.timeStep()


@pytest.mark.parametrize("velocity", [math.nan, math.inf])
def test_an_engine_without_a_finite_velocity_is_named(O, velocity):
    plane.disk((0, 0), 0.01)
    O.engines = [*cd_engine.engines(gravity=(0, -G, 0)), wrapper.TranslationEngine(translationAxis=(1, 0, 0), velocity=velocity, ids=[0])]
    with pytest.raises(ValueError, match="TranslationEngine has a velocity that is not finite"):
        cd_engine.timeStep()


def test_a_strain_rate_sets_it(O):
    """Its plate moves at the rate times the distance of the plates, which a load may raise."""
    O.bodies.append(utils.aabbWalls([(0, 0, 0), (0.2, 0.3, 0.4)], thickness=0, material=plane.material()))
    O.bodies.append(utils.sphere((0.1, 0.1, 0.1), 0.01))
    reset, collider, cd = cd_engine.engines()
    O.engines = [reset, collider, cd_engine.PlateLoads(goals=(0, 0, -5), rise=(0, 0, 0.5), loading="cosine", stressMask=3), cd]
    assert cd_engine.timeStep() == pytest.approx(0.25 * 0.01 / (5 * 1.5 * 0.4))


def test_dead_engines_do_not_count(O):
    """Neither their gravity nor their stiffness."""
    plane.disk((0, 0), 0.01)
    engines = cd_engine.engines(gravity=(0, -G, 0))
    dead = cd_engine.ContactDynamics(gravity=(0, -1e-6, 0), stiffness=1e12, dead=True)
    O.engines = [dead, *engines]
    assert cd_engine.timeStep() == pytest.approx(0.25 * math.sqrt(0.01 / G))


def test_a_body_without_a_place_is_named(O):
    plane.disk((0, 0), 0.01)
    body = plane.disk((1, 0), 0.01)
    O.bodies[body].state.pos = (math.nan, 0, 0)
    with pytest.raises(ValueError, match=f"body #{body} has a position"):
        cd_engine.timeStep(gravity=(0, -G, 0))


@pytest.mark.parametrize("blocked", ["zXY", "xyzXYZ"])
def test_the_spin_of_a_disk_counts(O, blocked):
    """Friction turns it into motion, its own or, of a roller, that of others."""
    plane.disk((0, 0), 0.01, spin=500, blocked=blocked)
    plane.disk((0.02, 0), 0.01)
    assert cd_engine.timeStep(gravity=(0, 0, 0)) == pytest.approx(0.25 * 0.01 / 5)


def test_where_nothing_is_fast_free_fall_sets_it(O):
    plane.disk((0, 0), 0.01)
    O.engines = cd_engine.engines(gravity=(0, -G, 0))
    assert cd_engine.timeStep(speed=1e-3) == pytest.approx(0.25 * math.sqrt(0.01 / G))


def test_permanent_forces_count_where_a_body_is_free(O):
    plane.disk((0, 0), 0.01)
    lid = plane.box((0, 1), (1, 0.1), blocked="xzXYZ")
    O.bodies[lid].state.mass = 2
    O.forces.setPermF(lid, (1e6, -300, 0))
    O.engines = cd_engine.engines()
    assert cd_engine.timeStep() == pytest.approx(0.25 * math.sqrt(0.01 / 150))
    assert cd_engine.timeStep(gravity=(0, -200, 0)) == pytest.approx(0.25 * math.sqrt(0.01 / 200))
    assert cd_engine.timeStep(speed=0.1) == pytest.approx(0.25 * 0.01 / 0.1)  # who knows the speed needs no force
    O.forces.setPermF(lid, (0, math.inf, 0))
    with pytest.raises(ValueError, match=f"on body #{lid} is not finite"):
        cd_engine.timeStep()


def test_disks_that_bounce_take_shorter_steps(O):
    plane.disk((0, 0), 0.01)
    O.engines = cd_engine.engines(gravity=(0, -G, 0), restitution=0.3)
    assert cd_engine.timeStep() == pytest.approx(0.05 * math.sqrt(0.01 / G))
    assert cd_engine.timeStep(share=0.25) == pytest.approx(0.25 * math.sqrt(0.01 / G))
    O.engines[-1].dead = True
    assert cd_engine.timeStep(gravity=(0, -G, 0)) == pytest.approx(0.25 * math.sqrt(0.01 / G))


def test_gravity_of_springs_is_found(O):
    plane.disk((0, 0), 0.01)
    O.engines = [wrapper.NewtonIntegrator(gravity=(0, -G, 0))]
    assert cd_engine.timeStep() == pytest.approx(0.25 * math.sqrt(0.01 / G))


def test_a_stress_on_a_plate_sets_it(O):
    """As the permanent force that it stands for; a plate that is held counts for nothing, a slow strain rate little."""
    O.bodies.append(utils.aabbWalls([(0, 0, 0), (0.2, 0.3, 0.4)], thickness=0, material=plane.material()))
    O.bodies.append(utils.sphere((0.1, 0.1, 0.1), 0.01))
    plate = O.bodies[3].state  # the upper one of y, of 0.2 m x 0.4 m
    plate.mass, plate.blockedDOFs = 2, "xzXYZ"
    reset, collider, cd = cd_engine.engines()
    O.engines = [reset, collider, cd_engine.PlateLoads(goals=(-5e3, -1e3, -1e-3), stressMask=3), cd]
    expected = 0.25 * math.sqrt(0.01 / (1e3 * 0.2 * 0.4 / 2))
    assert cd_engine.timeStep() == pytest.approx(expected)
    O.engines = [reset, collider, cd]
    O.forces.setPermF(3, (0, -1e3 * 0.2 * 0.4, 0))
    assert cd_engine.timeStep() == pytest.approx(expected)


def test_a_wall_along_gravity_has_no_height(O):
    plane.disk((0, 100), 0.01)
    O.bodies.append(utils.wall(-1, axis=0, material=0))
    assert cd_engine.timeStep(gravity=(0, -G, 0)) == pytest.approx(0.25 * math.sqrt(0.01 / G))


@pytest.mark.parametrize("disks, arguments, said", [
    (0, dict(gravity=(0, 0, 0)), "no disk in the scene can move"),
    (1, {}, r"no engine of O.engines has a gravity\. Set O\.engines first"),
    (1, dict(gravity=(0, 0, 0)), r"no speed can be estimated.*speed=0\.1"),
    (1, dict(share=0), "share=0 is out of range"),
    (1, dict(share="half"), "share='half' is out of range: it must be a number above 0"),
    (1, dict(speed=-1), "speed=-1 m/s is out of range"),
    (1, dict(speed=(1, 0, 0)), "speed=.1, 0, 0. m/s is out of range: it must be a number"),
    (1, dict(gravity=(0, 0, -9.81)), "points along an axis along which no disk can move"),
    (1, dict(gravity=9.81), "gravity=9.81 is not a vector of three finite numbers, such as .0, -9.81, 0."),
    (1, dict(gravity=(0, float("nan"), 0)), "not a vector of three finite numbers"),
    (1, dict(gravity=(0, -9.81)), "gravity=.0, -9.81. is not a vector of three finite numbers"),
    (1, dict(gravity="down"), "gravity='down' is not a vector of three finite numbers"),
])
def test_what_is_refused(O, disks, arguments, said):
    for _ in range(disks):
        plane.disk((0, 0), 0.01)
    with pytest.raises(ValueError, match=said):
        cd_engine.timeStep(**arguments)
