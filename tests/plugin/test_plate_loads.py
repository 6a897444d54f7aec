"""PlateLoads: the same loads for springs and for rigid grains, against what is known of them."""
import math
import random

import pytest
from yade import utils, wrapper as w

import cd_engine

from . import plane

P0 = 1200.0
SHAPES = {"constant": lambda rise, t, period: 0, "ramp": lambda rise, t, period: rise * t,
          "cosine": lambda rise, t, period: rise / 2 * (1 - math.cos(2 * math.pi * t / period)),
          "triangle": lambda rise, t, period: rise * (1 - abs(1 - 2 * ((t / period) % 1.0))),
          "smoothStep": lambda rise, t, period: rise / 2 * (1 - math.cos(math.pi * min(t / period, 1)))}


def set_engines(O, method, loads, dt=1e-3):
    """Set the engines of a method, PlateLoads among them. Return it."""
    if method == "CD":
        reset, collider, cd = cd_engine.engines(tolerance=1e-10)
        O.engines = [reset, collider, loads, cd]
    else:
        O.engines = [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb()]),
                     w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(), w.Ig2_Box_Sphere_ScGeom()], [w.Ip2_FrictMat_FrictMat_FrictPhys()],
                                       [w.Law2_ScGeom_FrictPhys_CundallStrack()]), loads, w.NewtonIntegrator(damping=0.2)]
    O.dt = dt
    return loads


def box_of_plates(O, sides=(0.2, 0.3), free=("x", "y"), mass=5.0):
    """Append the six plates of aabbWalls around (0, 0, -0.5) .. (sides, 0.5); the upper ones of these axes are free to move along their normal."""
    mat = plane.material(0)
    O.bodies.append(utils.aabbWalls([(0, 0, -0.5), (*sides, 0.5)], thickness=0, material=mat))
    for plate, axis in ((1, "x"), (3, "y")):
        if axis in free:
            O.bodies[plate].state.mass, O.bodies[plate].state.inertia = mass, (mass,) * 3
            O.bodies[plate].state.blockedDOFs = "xyzXYZ".replace(axis, "")
    return mat


@pytest.mark.parametrize("method", ["MD", "CD"])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_goals_change_as_is_said_to_the_last_bit(O, shape, method):
    """A goal is that of the beginning of a step with springs, and of its middle with Contact Dynamics."""
    box_of_plates(O, mass=1e12)
    plane.disk((0.1, 0.1), 0.01, blocked="xyzXYZ")
    loads = set_engines(O, method, cd_engine.PlateLoads(goals=(-P0, 2 * P0, 0), rise=(0.3, -0.7, 0), loading=shape, period=0.37))
    draw = random.Random(5).uniform
    for _ in range(50):
        O.dt = draw(1e-3, 0.1)
        t = O.time + (O.dt / 2 if method == "CD" else 0.0)
        O.step()
        for axis, (goal, rise) in enumerate(((-P0, 0.3), (2 * P0, -0.7))):
            assert loads.goal[axis] == goal * (1 + SHAPES[shape](rise, t, 0.37))


def test_the_mean_stress_stays_if_asked_for(O):
    box_of_plates(O)
    plane.disk((0.1, 0.1), 0.01, blocked="xyzXYZ")
    loads = set_engines(O, "CD", cd_engine.PlateLoads(goals=(-P0, -2 * P0, 0), rise=(0, 0.5, 0), loading="ramp", holdMean=True))
    O.run(100, True)
    assert loads.goal[0] + loads.goal[1] == pytest.approx(-3 * P0, rel=1e-14) and loads.goal[1] == pytest.approx(-2 * P0 * (1 + 0.5 * 0.0995))


@pytest.mark.parametrize("method", ["MD", "CD"])
def test_plates_carry_the_stress_over_their_area(O, method):
    """Four disks in a square: the forces on a plate sum to stress times the other side times the depth of 1 m."""
    mat = box_of_plates(O, (0.2, 0.2))
    O.materials[mat].young = 1e7
    for x in (0.05, 0.15):
        for y in (0.05, 0.15):
            plane.disk((x, y), 0.05, mat=mat)
    loads = set_engines(O, method, cd_engine.PlateLoads(goals=(-P0, -2 * P0, 0)), 1e-3 if method == "CD" else 1e-4)
    O.run(10 if method == "CD" else 40_000, True)
    sides = [O.bodies[1].state.pos[0], O.bodies[3].state.pos[1]]
    for plate, axis, stress in ((0, 0, P0), (1, 0, P0), (2, 1, 2 * P0), (3, 1, 2 * P0)):
        force = sum(abs(i.phys.normalForce[axis]) for i in O.bodies[plate].intrs() if i.isReal)
        assert force == pytest.approx(stress * sides[1 - axis], rel=1e-8 if method == "CD" else 1e-3)
    strain = [math.log(side / 0.2) for side in sides]
    assert [*loads.strain] == pytest.approx([*strain, 0], abs=1e-9) and (max(strain) < 0 or method == "CD")


@pytest.mark.parametrize("method", ["MD", "CD"])
@pytest.mark.parametrize("symmetric", [False, True])
def test_a_strain_rate_is_exact(O, method, symmetric):
    box_of_plates(O, free=())
    plane.disk((0.1, 0.1), 0.01)
    loads = set_engines(O, method, cd_engine.PlateLoads(goals=(-0.5, 0.2, 0), stressMask=0, symmetric=symmetric))
    middle = O.bodies[0].state.pos[0] + O.bodies[1].state.pos[0]
    O.run(400, True)
    lengths = [O.bodies[1].state.pos[0] - O.bodies[0].state.pos[0], O.bodies[3].state.pos[1] - O.bodies[2].state.pos[1]]
    assert lengths == pytest.approx([0.2 * math.exp(-0.5 * 0.4), 0.3 * math.exp(0.2 * 0.4)], rel=1e-12)
    assert [*loads.strain] == pytest.approx([-0.5 * 0.399, 0.2 * 0.399, 0], rel=1e-12)
    if symmetric:
        assert O.bodies[0].state.pos[0] + O.bodies[1].state.pos[0] == pytest.approx(middle, abs=1e-15)


@pytest.mark.parametrize("method", ["MD", "CD"])
def test_the_work_becomes_kinetic_energy_of_a_plate(O, method):
    box_of_plates(O, (1, 1), free="x")
    plane.disk((0.1, 0.1), 0.01)
    O.bodies[1].state.mass = 1e4
    loads = set_engines(O, method, cd_engine.PlateLoads(goals=(-P0, -0.1, 0), stressMask=1, rise=(1, 0, 0), loading="cosine", period=0.5))
    if method == "MD":
        O.engines[-1].damping = 0
    O.run(1000, True)
    plate = O.bodies[1].state
    before = plate.vel[0]  # of the beginning of the step in which the work is read; in leapfrog half a step earlier, its mean counts
    O.step()
    speed = before if method == "CD" else (before + plate.vel[0]) / 2
    assert loads.work == pytest.approx(plate.mass * speed**2 / 2, rel=1e-10 if method == "CD" else 1e-5)
    assert loads.work == pytest.approx(plate.mass * before**2 / 2, rel=1e-2) and loads.work > 1


def sheared(O, publish, runs):
    O.reset()
    mat = box_of_plates(O, (0.12, 0.14))
    plane.grid(30, 5, (0.015, 0.015), (0.021, 0.021), mat=mat)
    loads = cd_engine.PlateLoads(goals=(-P0, -P0, 0), rise=(0, 0.8, 0), loading="cosine", period=0.1)
    set_engines(O, "CD", loads)
    O.engines[-1].publish = publish
    for steps in runs:
        O.run(steps, True)
    return state(O)


def state(O):
    return [(*b.state.pos, *b.state.vel, *b.state.ori) for b in O.bodies] + [(O.engines[2].work, *O.engines[2].goal)]


def test_the_motion_does_not_depend_on_when_the_scene_is_written(O, tmp_path):
    """In a run only the plates are written. A saved scene goes on as if it had not been saved."""
    due = sheared(O, "due", [300])
    assert due == sheared(O, "always", [300]) == sheared(O, "due", [1] * 20 + [280])
    sheared(O, "due", [100])
    O.save(str(tmp_path / "scene.xml.gz"))
    O.load(str(tmp_path / "scene.xml.gz"))
    O.run(200, True)
    assert state(O) == due


@pytest.mark.parametrize("spoil, words", [
    (dict(plates=[0, 1, 2, 77]), "there is no body #77, which plates names"),
    (dict(plates=[0, 6]), "body #6 is no Box, and no Wall perpendicular to x"),
    (dict(plates=[1, 0]), "plates #1 and #0 have met along x"), (dict(stressMask=1), "plate #3 is free along y, where a strain rate is its goal"),
    (dict(goals=(0, 0, -1)), "neither of the plates #4 and #5 is free along z"),
    (dict(plates=[0, 1]), "goals has -.* along y, where plates names no two plates"), (dict(plates=[0, 1, 2, 3, 4, 5, 6]), "plates has 7 ids")])
def test_what_makes_no_sense_is_refused(O, spoil, words):
    box_of_plates(O)
    plane.disk((0.1, 0.1), 0.01)
    set_engines(O, "CD", cd_engine.PlateLoads(**{"goals": (-P0, -P0, 0)} | spoil))
    with pytest.raises(RuntimeError, match=f"PlateLoads: {words}"):
        O.step()


def test_its_place_is_checked(O):
    box_of_plates(O)
    plane.disk((0.1, 0.1), 0.01)
    reset, collider, cd = cd_engine.engines()
    O.dt = 1e-3
    for engines, words in (([reset, collider, cd, cd_engine.PlateLoads()], "behind the engine that moves the bodies"),
                           ([cd_engine.PlateLoads(), reset, collider, cd], "no ForceResetter stands before it"),
                           ([reset, cd_engine.PlateLoads()], "no engine behind it moves the bodies")):
        O.engines = engines
        with pytest.raises(RuntimeError, match=words):
            O.step()
    with pytest.raises(ValueError, match="='sine' is not known; there is 'constant'"):
        cd_engine.PlateLoads(loading="sine")


@pytest.mark.parametrize("runs", [1, 10])
def test_plates_that_others_move_are_seen_in_every_step(O, runs):
    """A stress along x over a side that the user shortens: the force follows, however the run is cut."""
    box_of_plates(O, (0.3, 0.3), free="x")
    plane.disk((0.15, 0.05), 0.15, blocked="yzXYZ")
    for plate in 2, 3:
        O.bodies[plate].bounded = False
    O.bodies[3].state.vel = (0, -0.1, 0)
    loads = set_engines(O, "CD", cd_engine.PlateLoads(goals=(-P0, 0, 0)))
    for _ in range(runs):
        O.run(1000 // runs, True)
    before = 0.3 - 0.1 * 0.999  # the side at the beginning of the last step
    assert sum(i.phys.normalForce[0] for i in O.bodies[0].intrs() if i.isReal) == pytest.approx(P0 * before, rel=1e-9)
    assert loads.strain[1] == pytest.approx(math.log(before / 0.3), rel=1e-9)


@pytest.mark.parametrize("method", ["MD", "CD"])
@pytest.mark.parametrize("change", [dict(symmetric=False), dict(stressMask=1), dict(plates=[-1, -1, 2, 3, -1, -1], goals=(0, 0, 0))])
def test_a_plate_stops_where_a_strain_rate_no_longer_moves_it(O, method, change):
    box_of_plates(O, free=())
    plane.disk((0.1, 0.1), 0.01)
    loads = set_engines(O, method, cd_engine.PlateLoads(goals=(-0.1, 0, 0), stressMask=0, symmetric=True))
    O.run(200, True)
    assert O.bodies[0].state.vel[0] > 0 > O.bodies[1].state.vel[0]
    if "stressMask" in change:
        O.bodies[1].state.mass, O.bodies[1].state.blockedDOFs = 1e9, "yzXYZ"
    for name, value in change.items():
        setattr(loads, name, value)
    O.run(1, True)
    place = O.bodies[0].state.pos[0]
    O.run(100, True)
    assert O.bodies[0].state.pos[0] == place and O.bodies[0].state.vel[0] == 0
    assert ("plates" in change) == (O.bodies[1].state.vel[0] == 0)
    if "symmetric" in change:  # the rate goes on, by the upper plate alone
        assert loads.strain[0] == pytest.approx(-0.1 * 0.3, rel=1e-12)


def test_a_plate_to_which_the_user_gives_another_velocity_keeps_it(O):
    box_of_plates(O, free=())
    plane.disk((0.1, 0.1), 0.01)
    loads = set_engines(O, "CD", cd_engine.PlateLoads(goals=(-0.1, 0, 0), stressMask=0, symmetric=True))
    O.run(10, True)
    O.bodies[0].state.vel, loads.symmetric = (0.02, 0, 0), False
    O.run(10, True)
    assert O.bodies[0].state.vel[0] == 0.02


def test_no_work_is_counted_while_it_is_dead_and_none_between_plates(O):
    """Dead, its force does not act, and the plate flies on. Other plates have a strain of their own."""
    box_of_plates(O, (1, 1), free="x")
    plane.disk((0.1, 0.1), 0.01)
    loads = set_engines(O, "CD", cd_engine.PlateLoads(goals=(P0, 0, 0)))
    O.run(100, True)
    loads.dead = True
    O.run(100, True)
    loads.dead = False
    O.run(1, True)
    before = loads.work
    assert loads.strain[0] == pytest.approx(math.log(O.bodies[1].state.pos[0] - O.bodies[1].state.vel[0] * O.dt), rel=1e-3)
    O.run(1, True)
    kinetic = O.bodies[1].state.mass * (O.bodies[1].state.vel[0] - P0 * O.dt / O.bodies[1].state.mass)**2 / 2
    assert loads.work > before and loads.work == pytest.approx(kinetic, rel=0.02)  # the last step before the pause is not counted: 2/100
    work = loads.work
    others = O.bodies.append(utils.aabbWalls([(-1, 0, -0.5), (3, 1, 0.5)], thickness=0, material=O.materials[0]))
    O.bodies[others[1]].state.mass, O.bodies[others[1]].state.blockedDOFs = 5, "yzXYZ"
    loads.plates = [*others[:2], 2, 3, -1, -1]
    O.run(1, True)
    assert loads.work == work and tuple(loads.strain) == (0, 0, 0)
