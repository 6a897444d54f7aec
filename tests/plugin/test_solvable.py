"""A problem without a solution is named, and does not spoil the solution of others in the scene."""
import math
import random

import pytest
import yade

import cd_engine

from . import plane

G = 9.81


def press(O, method="auto", tolerance=1e-6, beside=False, speed=0.1):
    """Press a disk on the floor by a wall of `speed` [m/s]; with `beside`, a column of two stands next to it. Return the engine after a step."""
    plane.columns(0, disks=1)
    lid = plane.box((0, 0.025), (0.02, 0.005))
    O.bodies[lid].state.vel = (0, -speed, 0)
    if beside:
        plane.disk((0.2, 0.01), 0.01)
        plane.disk((0.2, 0.03), 0.01, mass=2)
    return plane.run(1, 1e-3, gravity=(0, -G, 0), method=method, tolerance=tolerance)


@pytest.mark.parametrize("method", ["nsgs", "accelerated", "newton", "auto"])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-8])
def test_a_disk_pressed_between_boundaries_has_no_solution(O, capfd, method, tolerance):
    engine = press(O, method, tolerance)
    O.run(20, True)
    assert engine.unconvergedSteps == engine.steps == 21 and not engine.converged
    assert engine.status == "no_solution" and 1 in engine.unsolvableContact
    assert engine.iterations <= engine.maxIterations
    said = capfd.readouterr().err
    assert said.count("are squeezed or wedged, and no solution was found") == 1


@pytest.mark.parametrize("method", ["nsgs", "accelerated", "newton", "auto"])
@pytest.mark.parametrize("share", [1e-1, 1e-2, 1e-4])
def test_nor_where_the_boundary_is_slow_beside_gravity(O, method, share):
    """The wall's speed is this share of gravity's velocity in a step. Impulses of the order of speed over tolerance make e small."""
    engine = press(O, method, speed=share * G * 1e-3)
    O.run(20, True)
    assert engine.unconvergedSteps == engine.steps == 21 and engine.status == "no_solution"


@pytest.mark.parametrize("speed", [0.1, 1.0])
def test_an_earlier_step_without_a_solution_hides_no_overlap(O, capfd, speed):
    """However deep bodies were squeezed there: by 1e-4 or 1e-3 m in each of the steps."""
    engine = press(O, speed=speed)
    O.run(6, True)
    assert engine.status == "no_solution"
    O.bodies.erase(next(b.id for b in O.bodies if b.state.vel[1] == -speed))
    for height in (0.01, 0.021):
        plane.disk((0.3, height), 0.01)
    O.run(2, True)
    assert engine.converged and "#3 and #4 overlap by 0.009" in capfd.readouterr().err


def hexagons(rows, speed, mu, along=0, sides=0, **settings):
    """Rows of disks, each on two, between a floor, two walls that close in at `sides` and a lid that comes down at `speed` and slides at `along`
    [m/s]; the id of the lid, the engine after one step."""
    r, mat = 0.01, plane.material(mu)
    height = r * (2 + math.sqrt(3) * (rows - 1))
    plane.floor(mat)
    for x, velocity in ((-r, sides), ((2 * rows + 1) * r, -sides)):
        yade.O.bodies[plane.box((x, height), (r, 2 * height), mat=mat)].state.vel = (velocity, 0, 0)
    plane.hollows(rows, rows, mat)
    lid = plane.box((rows * r, height + r), (2 * rows * r, r), mat=mat)
    yade.O.bodies[lid].state.vel = (along, -speed, 0)
    return lid, plane.run(1, 1e-3, gravity=(0, -G, 0), **settings)


@pytest.mark.parametrize("method", ["accelerated", "newton", "auto"])
@pytest.mark.parametrize("mu", [0, 0.3, 1])
def test_a_packing_pressed_slowly_has_no_solution_and_one_that_rests_after_it_has(O, method, mu):
    """The press leaves impulses of 1e3 weights. They are no prestress: at rest again the floor carries the weight, and the lid nothing."""
    lid, engine = hexagons(6, 0.01 * G * 1e-3, mu, method=method, tolerance=1e-6)
    pressed = 0
    for _ in range(10):
        O.step()
        pressed += abs(O.forces.f(lid)[1]) > 1
        assert engine.status == "no_solution" or abs(O.forces.f(lid)[1]) < 1
    assert pressed > 0
    O.bodies[lid].state.vel = (0, 0.01, 0)
    O.run(20, True)
    assert engine.converged and O.forces.f(lid)[1] == 0
    weight = sum(b.state.mass for b in O.bodies if b.state.blockedDOFs == "zXY") * G
    # Without friction the walls carry no weight. With it they may, or press down what is wedged between them.
    assert -O.forces.f(0)[1] == pytest.approx(weight, rel=1e-3) if mu == 0 else -O.forces.f(0)[1] < 3 * weight


@pytest.mark.parametrize("mu, speed, method, tolerance, along", [
    (0.5, 1e-3, "auto", 1e-4, 3), (0.5, 1e-3, "newton", 1e-8, 0.5), (0.5, 1e-3, "newton", 1e-10, 0.5),
    (1, 1e-3, "auto", 1e-4, 3), (1, 1e-3, "auto", 1e-8, 0.5), (1, 1e-3, "newton", 1e-10, 0.5), (1, 1e-5, "auto", 1e-4, 3),
    (1, 1e-5, "newton", 1e-8, 0.5)])
def test_nor_where_the_boundary_also_slides(O, method, tolerance, along, mu, speed):
    """The power of sliding, which friction takes, is a hundred times that of closing, and the disk may turn with it."""
    _, engine = hexagons(1, speed, mu, along=along, method=method, tolerance=tolerance)
    for _ in range(6):
        O.step()
        assert not engine.converged


@pytest.mark.parametrize("method, tolerance", [("auto", 1e-2), ("auto", 1e-4), ("newton", 1e-2), ("newton", 1e-8)])
def test_nor_where_a_doubt_remains_though_the_error_is_small(O, method, tolerance):
    """Walls close in at 0.05 m/s on two disks under a third. Impulses of 1e8 N s have an error of 1e-10; no proof is found, as the normals are not
    parallel to the last digit. In some steps a disk is squeezed out at 200 m/s, which is a solution.
    """
    lid, engine = hexagons(2, 0, 0, sides=0.05, method=method, tolerance=tolerance)
    O.bodies.erase(lid)
    for _ in range(8):
        O.step()
        strongest = max((i.phys.normalForce.norm() for i in O.interactions if i.isReal), default=0) * O.dt
        assert not engine.converged or engine.residual * strongest / 1.0 < 0.1 * 0.05  # velocity of disks of 1 kg that the error amounts to


@pytest.mark.parametrize("method", ["auto", "newton"])
def test_wedged_disks_that_rebound_gain_no_energy(O, method):
    """Columns of disks between a floor and two walls, thrown at random, friction 1 and 2: impulses that wedge them have no bound."""
    draw = random.Random(4)
    for _ in range(60):
        O.reset()
        columns, mat = draw.randint(2, 4), plane.material(draw.choice([1, 2]))
        plane.floor(mat)
        for x in (-0.01, (2 * columns + 1) * 0.01):
            plane.box((x, 0.1), (0.01, 0.2), mat=mat)
        for j in range(draw.randint(1, 4)):
            for i in range(columns):
                plane.disk(((2 * i + 1) * 0.01, (2 * j + 1) * 0.01), 0.01 * draw.uniform(0.95, 1),
                           velocity=(draw.uniform(-1, 1), draw.uniform(-1, 1)), mat=mat)
        tolerance = 10.0**draw.choice([-2, -3, -4])
        plane.engine(method=method, tolerance=tolerance, restitution=draw.choice([0.3, 0.5, 0.8, 0.95]), maxIterations=3000)
        for _ in range(3):
            before = plane.kinetic_energy()
            O.step()
            assert not O.engines[-1].converged or plane.kinetic_energy() <= before * (1 + tolerance)


def test_a_press_that_has_stopped_moves_nothing(O):
    """Boxes that touch a thrown disk at random places move in two steps and stop. Impulses by which they have pressed it are no first guess then."""
    draw, pressed = random.Random(5), 0
    for _ in range(300):
        O.reset()
        radius, mat, tolerance = 0.1, plane.material(draw.choice([0.3, 0.5, 1, 1.5, 2])), draw.choice([1e-4, 1e-6])
        plane.disk((0, 0), radius, velocity=(draw.gauss(0, 1), draw.gauss(0, 1)), spin=draw.gauss(0, 5), mat=mat)
        boxes = []
        for _ in range(draw.randint(2, 4)):
            angle = math.radians(15 * draw.randrange(24))
            boxes.append(plane.box((0.12 * math.cos(angle), 0.12 * math.sin(angle)), (0.02, 0.005), angle, mat=mat))
            O.bodies[boxes[-1]].state.vel = (draw.gauss(0, 0.3), draw.gauss(0, 0.3), 0)
        method, restitution = draw.choice(["auto", "newton"]), draw.choice([0.3, 0.5])
        plane.engine(1e-4, method=method, tolerance=tolerance, restitution=restitution, handover=False)
        for _ in range(2):
            O.step()
        pressed += O.engines[-1].unsolvableContact != []
        for box in boxes:
            O.bodies[box].state.vel = (0, 0, 0)
        for _ in range(3):
            before = plane.kinetic_energy()
            O.step()
            error = 0.5 * (10 * tolerance * 1)**2  # [J]: of 1 kg, if ten tolerances of a speed of 1 m/s are wrong
            assert not O.engines[-1].converged or plane.kinetic_energy() <= before * (1 + 10 * tolerance) + error
    assert pressed > 30


@pytest.mark.parametrize("settings", [dict(), dict(reduce=False)], ids=["islands", "whole"])
def test_nor_in_an_island_of_several_disks(O, settings):
    """Two disks and one on top of them, in a box whose wall has moved by 0.05 m/s. Afterwards no disk is faster than one that falls freely."""
    radius, mat = 0.05, plane.material(0.3)
    disks = [plane.disk(place, radius, mat=mat) for place in ((0, 0), (2 * radius, 0), (radius, radius * 3**0.5))]
    O.bodies.append(yade.utils.wall(-radius, axis=1, material=mat))
    plane.box((-radius - 0.01, 0.4), (0.01, 0.6), mat=mat)
    wall = plane.box((3 * radius + 0.01, 0.4), (0.01, 0.6), mat=mat)
    O.bodies[wall].state.vel = (-0.05, 0, 0)
    engine = plane.run(3, 3e-4, gravity=(0, -G, 0), **settings)
    assert engine.status == "no_solution"
    for body in (wall, *disks):
        O.bodies[body].state.vel = O.bodies[body].state.angVel = (0, 0, 0)
    for step in range(1, 9):
        O.step()
        assert engine.converged and plane.kinetic_energy() < len(disks) * 0.5 * (step * O.dt * G)**2


@pytest.mark.parametrize("driven", [False, True], ids=["all at rest", "another box moves far away"])
def test_what_a_press_has_left_holds_nothing_down(O, driven):
    """Two disks between boxes that have closed in rest on the floor. Pulled up by 20 N, one of 1 kg rises as if nothing touched it."""
    radius, mat = 0.1, plane.ground()
    elsewhere = plane.box((50, 5), (0.1, 0.1), mat=mat)
    disk = plane.disk((0, radius), radius, mat=mat)
    plane.disk((2 * radius, radius), radius, mat=mat)
    boxes = [plane.box((x, radius), (0.01, 0.3), mat=mat) for x in (-radius - 0.01, 3 * radius + 0.01)]
    for box, speed in zip(boxes, (0.5, -0.5)):
        O.bodies[box].state.vel = (speed, 0, 0)
    engine = plane.run(2, 1e-4, gravity=(0, -G, 0))
    assert engine.status == "no_solution"
    for body in O.bodies:
        body.state.vel = body.state.angVel = (0, 0, 0)
    O.bodies[elsewhere].state.vel = (0.01 * driven, 0, 0)
    O.run(100, True)
    O.forces.setPermF(disk, (0, 20, 0))
    O.run(5, True)
    assert engine.converged and O.bodies[disk].state.vel[1] == pytest.approx(5 * O.dt * (20 - G), rel=1e-5)  # ten tolerances


@pytest.mark.parametrize("settings", [dict(), dict(gapCorrection=0.1), dict(restitution=0.5)], ids=["belt", "gap correction", "rebounds"])
def test_a_pile_stays_one_where_the_sweeps_do_not_suffice(O, settings):
    """A column of 30 disks on a belt with 20 sweeps a step: unsolved while it settles, but without deep overlaps."""
    mat = plane.material()
    O.bodies[plane.box((0, -0.01), (1, 0.01), mat=mat)].state.vel = (0 if settings else 0.01, 0, 0)
    plane.grid(30, 1, (0, 0.01), (0, 0.02001), mat)
    engine = plane.run(200, 1e-3, gravity=(0, -G, 0), tolerance=1e-6, maxIterations=20, **settings)
    assert engine.unconvergedSteps > 10 and engine.deepestPenetration < 0.1 * 0.01


def test_forces_that_hold_each_other_are_kept(O):
    """A lid pressed on three disks is then fixed, and gravity ends: nothing moves, so the forces must stay."""
    plane.columns(0)
    lid = plane.box((0, 0.065), (0.02, 0.005), blocked="xzXYZ")
    O.forces.setPermF(lid, (0, -500, 0))
    engine = plane.run(50, 1e-3, gravity=(0, -G, 0), tolerance=1e-4)
    assert engine.converged and O.interactions[0, 1].phys.normalForce.norm() == pytest.approx(500 + 4 * G, rel=1e-3)
    O.bodies[lid].state.blockedDOFs = "xyzXYZ"
    O.forces.setPermF(lid, (0, 0, 0))
    engine.gravity = (0, 0, 0)
    O.run(50, True)
    assert engine.converged and O.interactions[0, 1].phys.normalForce.norm() == pytest.approx(500, rel=0.1)


def test_what_stands_beside_it_is_solved(O):
    engine = press(O, beside=True)
    O.run(20, True)
    assert engine.status == "no_solution" and 1 in engine.unsolvableContact
    for body in (3, 4):
        assert abs(O.bodies[body].state.vel[1]) < 10 * 1e-6 * 2 * G * 1e-3  # as in test_deep_overlap.py
    assert O.interactions[3, 4].phys.normalForce.norm() == pytest.approx(2 * G, rel=1e-5)


@pytest.mark.parametrize("method, tolerance", [("auto", 1e-12), ("newton", 1e-12), ("newton", 1e-13)])
def test_impulses_of_an_unsolved_step_excuse_none_in_the_next(O, method, tolerance):
    """A lid comes down on one of two overlapping disks. The first step ends with impulses of 1e12 N s. As first guess of the next step they are so
    large that the error relative to them is within the tolerance."""
    plane.columns(0, disks=1)
    plane.disk((0.019, 0.0105), 0.01)
    lid = plane.box((0, 0.025), (0.02, 0.005))
    O.bodies[lid].state.vel = (0, -0.1, 0)
    engine = plane.run(1, 1e-3, gravity=(0, -G, 0), method=method, tolerance=tolerance)
    solved = 0
    for _ in range(100):
        O.step()
        pressed = O.bodies[1].state.pos[1] < 0.01 and O.bodies[lid].state.pos[1] - 0.005 < O.bodies[1].state.pos[1] + 0.01 - 1e-4
        solved += engine.converged and pressed
    assert solved == 0


@pytest.mark.parametrize("most", [1, 3, 50])
def test_the_bound_on_iterations_is_one(O, most):
    """A cold pile of 40 disks, in which contacts are added within the steps."""
    plane.grid(40, 5, (0, 0.0101), (0.0201, 0.0203), plane.ground(), velocity=(0, -1))
    engine = plane.run(1, 1e-3, gravity=(0, -G, 0), maxIterations=most, tolerance=1e-10)
    for _ in range(40):
        assert engine.iterations <= most
        O.step()


def test_a_collider_finds_pairs_after_a_body_has_been_erased(O):
    """A disk rolls at 5 m/s towards another; meanwhile the engines are set anew. The allowed overlap is that of the scheme."""
    plane.floor()
    still = plane.disk((0, 0.1), 0.1)
    fast = plane.disk((0.5, 0.1), 0.1, velocity=(-5, 0))
    O.bodies.erase(plane.disk((3, 0.1), 0.1))
    plane.run(2, 1e-3, gravity=(0, -G, 0))
    O.engines = cd_engine.engines(gravity=(0, -G, 0))
    O.run(100, True)
    assert O.bodies[fast].state.pos[0] - O.bodies[still].state.pos[0] > 0.2 * (1 - 1e-3)
    assert O.engines[1].numReinit > 0
