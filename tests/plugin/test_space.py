"""Scenes in space: solutions known in closed form, and what publishing, saving and threads must leave as it is. Each tolerance: round-off of the
steps made, or the scheme's own order."""
import math
import random

import numpy as np
import pytest
import yade
from yade import utils

import cd_engine

G = 9.81


def material(mu=0.5):
    return yade.O.materials.append(yade.wrapper.FrictMat(frictionAngle=math.atan(mu), density=1000))


def ball(position, radius, mat, velocity=(0, 0, 0), spin=(0, 0, 0)):
    body = utils.sphere(position, radius, material=mat)
    body.state.vel, body.state.angVel = velocity, spin
    return yade.O.bodies.append(body)


def run(steps, dt, label="", **settings):
    """Make so many steps with new engines, to 1e-12. Return the engine."""
    yade.O.engines = cd_engine.engines(**{"tolerance": 1e-12, "gravity": (0, 0, -G)} | settings)
    yade.O.dt = dt
    yade.O.run(steps, True)
    engine = yade.O.engines[2]
    assert engine.inSpace and engine.unconvergedSteps == 0
    return engine


def vector(v):
    return np.array([v[0], v[1], v[2]])


@pytest.mark.parametrize("way", [(1, 0, 0), (0.6, 0.8, 0), (0, -1, 0)])
@pytest.mark.parametrize("floor", ["wall", "box"])
def test_sliding_sphere_ends_rolling_at_five_sevenths_of_its_speed(O, way, floor):
    """Angular momentum about the contact point, I = 2/5 m R^2; at t = 2 v0/(7 mu g), until then with mu g."""
    mat, radius, mu, dt = material(0.2), 0.1, 0.2, 1e-3
    O.bodies.append(utils.wall(0, axis=2, material=mat) if floor == "wall" else utils.box((0, 0, -0.1), (2, 2, 0.1), fixed=True, material=mat))
    state = O.bodies[ball((0, 0, radius), radius, mat, velocity=way)].state
    run(100, dt)
    assert vector(state.vel) == pytest.approx((1 - mu * G * 0.1) * vector(way), abs=1e-12)
    O.run(round(2 / (7 * mu * G) / dt) - 100 + 2, True)
    assert vector(state.vel) == pytest.approx(5 / 7 * vector(way), abs=1e-12)
    assert vector(state.angVel) * radius == pytest.approx(np.cross((0, 0, 1), vector(state.vel)), abs=1e-12)
    assert state.pos[2] == pytest.approx(radius, abs=1e-15)


@pytest.mark.parametrize("mu, rolls", [(0.5, True), (0.3, True), (0.25, False), (0.0, False)])
def test_sphere_on_a_slope(O, mu, rolls):
    """A tilted box of 45 degrees: rolls with 5/7 g sin a where mu >= 2/7 tan a = 0.286, else slides."""
    mat, radius, a, n, dt = material(mu), 0.1, math.pi / 4, 100, 1e-3
    q = yade.Quaternion((0, 1, 0), a)
    O.bodies.append(utils.box((0, 0, 0), (2, 2, 0.1), orientation=q, fixed=True, material=mat))
    down = np.array([math.cos(a), 0, -math.sin(a)])
    state = O.bodies[ball(0.2 * np.array([math.sin(a), 0, math.cos(a)]), radius, mat)].state
    run(n, dt)
    pull, friction = G * math.sin(a), mu * G * math.cos(a)
    assert vector(state.vel) == pytest.approx(n * dt * (5 / 7 * pull if rolls else pull - friction) * down, abs=1e-11)
    spin = n * dt * (5 / 7 * pull / radius if rolls else 2.5 * friction / radius)
    assert vector(state.angVel) == pytest.approx((0, spin, 0), abs=1e-10)


def test_spin_about_the_vertical_stays_and_the_orientation_turns_by_it(O):
    mat = material(1)
    O.bodies.append(utils.wall(0, axis=2, material=mat))
    state = O.bodies[ball((0, 0, 0.1), 0.1, mat, spin=(0, 0, 3))].state
    run(500, 1e-3)
    assert vector(state.angVel) == pytest.approx((0, 0, 3), abs=1e-14) and vector(state.vel) == pytest.approx((0, 0, 0), abs=1e-14)
    axis, angle = state.ori.toAxisAngle()
    assert vector(angle * axis) == pytest.approx((0, 0, 1.5), abs=1e-12)


@pytest.mark.parametrize("degrees", [40, 50, 60])
def test_oblique_impact(O, degrees):
    """Chung and Ooi 4, where it slides: e_t = 1 - mu (1 + e)/tan a, spin 5 mu (1 + e) V cos a/(2 R), a from the normal."""
    e, mu, speed, radius, a = 0.98, 0.092, 3.9, 2.5e-3, math.radians(degrees)
    mat = material(mu)
    O.bodies.append(utils.wall(0, axis=2, material=mat))
    height = radius + 0.5e-5 * speed * math.cos(a)  # so that it touches in the middle of the step: friction acts at the radius
    state = O.bodies[ball((0, 0, height), radius, mat, velocity=(0, speed * math.sin(a), -speed * math.cos(a)))].state
    run(1, 1e-5, gravity=(0, 0, 0), restitution=e)
    assert state.vel[2] == pytest.approx(e * speed * math.cos(a), rel=1e-12)
    assert state.vel[1] == pytest.approx((1 - mu * (1 + e) / math.tan(a)) * speed * math.sin(a), rel=1e-12)
    assert state.angVel[0] == pytest.approx(-2.5 * mu * (1 + e) * speed * math.cos(a) / radius, rel=1e-12)


def pyramid(O, mu, radius=0.1):
    """Append a floor, three spheres that touch on it, and one that they carry. Return the ids of the floor, the three and the one."""
    O.reset()
    mat, aside = material(mu), 2 * radius / math.sqrt(3)
    floor = O.bodies.append(utils.wall(0, axis=2, material=mat))
    ids = [ball((aside * math.cos(t), aside * math.sin(t), radius), radius, mat) for t in np.arange(3) * 2 * math.pi / 3]
    return floor, ids, ball((0, 0, radius + 2 * radius * math.sqrt(2 / 3)), radius, mat)


def test_pyramid_of_four(O):
    """Three spheres that touch on a floor carry one. Its contacts, at c = sqrt(2/3) from the vertical axis, carry m g/(3 c); those of the three roll
    and slide alike, so each holds by friction what its neighbours do not: with mu above sqrt(3) - sqrt(2) = 0.318 nothing moves."""
    for mu, holds in (0.33, True), (0.31, False):
        floor, ids, top = pyramid(O, mu)
        run(50, 1e-3, tolerance=1e-10)
        weight = G * O.bodies[top].state.mass
        speed = max(vector(O.bodies[i].state.vel) @ vector(O.bodies[i].state.vel) for i in ids)**0.5
        assert (speed < 1e-9) == holds
        if not holds:
            continue
        assert O.forces.f(floor)[2] == pytest.approx(-4 * weight, rel=1e-9)
        for i in ids:
            below, above = O.interactions[floor, i], O.interactions[i, top]
            assert below.phys.normalForce[2] == pytest.approx(4 / 3 * weight, rel=1e-9)
            total = vector(above.phys.normalForce) + vector(above.phys.shearForce)  # on the top one
            assert total[2] == pytest.approx(weight / 3, rel=1e-9)
            assert vector(above.geom.normal) @ vector(above.phys.shearForce) == pytest.approx(0, abs=1e-9 * weight)


def test_a_pyramid_sleeps_and_wakes(O):
    *_, top = pyramid(O, 0.5)
    engine = run(200, 1e-3, tolerance=1e-6)
    assert engine.sleeping == engine.islands == 1 and all(x == 0 for b in O.bodies for x in (*b.state.vel, *b.state.angVel))
    O.bodies[top].state.vel = (0.1, 0, 0)
    O.run(1, True)
    assert engine.sleeping == 0 and f"body #{top}" in engine.woken


def test_spheres_in_a_tube_of_four_walls(O):
    """Without friction the floor carries all, and a sphere pushed to each wall by the one above: forces by hand. Two spheres of radius R in a square
    tube of half width w: their centres are 2 (w - R) apart along x and y."""
    mat, radius, w = material(0), 0.1, 0.15
    for axis in (0, 1):
        for side in (-w, w):
            O.bodies.append(utils.wall(side, axis=axis, material=mat))
    floor = O.bodies.append(utils.wall(0, axis=2, material=mat))
    d = w - radius
    rise = math.sqrt(4 * radius**2 - 8 * d**2)
    low = ball((-d, -d, radius), radius, mat)
    ball((d, d, radius + rise), radius, mat)
    run(20, 1e-3)
    weight = G * O.bodies[low].state.mass
    assert O.forces.f(floor)[2] == pytest.approx(-2 * weight, rel=1e-9)
    assert [abs(O.forces.f(k)[k // 2]) for k in range(4)] == pytest.approx([weight * 2 * d / rise] * 4, rel=1e-9)


@pytest.mark.parametrize("place, normal", [((0, 0, 0.3), (0, 0, 1)), ((0.3, 0.05, 0.3), (1, 0, 1)), ((-0.3, 0.3, 0.3), (-1, 1, 1))])
def test_faces_edges_and_corners_of_a_turned_box_push_along_the_nearest_way(O, place, normal):
    """A sphere that flies at a cube of side 0.4 stops where it touches it, and goes on spinning without friction."""
    mat, radius, q = material(0), 0.1, yade.Quaternion((1, 2, 3), 0.7)
    O.bodies.append(utils.box((0, 0, 0), (0.2, 0.2, 0.2), orientation=q, fixed=True, material=mat))
    n = q * yade.Vector3(*normal).normalized()
    at = vector(q * yade.Vector3(*[math.copysign(0.2, x) if k else p for p, x, k in zip(place, place, normal)])) + (radius + 0.001) * vector(n)
    state = O.bodies[ball(at, radius, mat, velocity=-2 * vector(n), spin=(1, 2, 3))].state
    run(1, 1e-3, gravity=(0, 0, 0))  # in whose middle it touches
    assert vector(state.vel) == pytest.approx((0, 0, 0), abs=1e-12) and vector(state.angVel) == pytest.approx((1, 2, 3), abs=1e-12)


def test_joints_of_boxes_are_no_steps(O):
    """A sphere rolls over a floor of boxes of equal height, given in any order, as over one: one contact a step."""
    mat, radius = material(0.5), 0.1
    for i in range(-2, 3):
        for j in range(-2, 3):
            O.bodies.append(utils.box((0.5 * i, 0.4 * j, -0.1), (0.25, 0.2, 0.1), fixed=True, material=mat))
    way = np.array([1, 0.63, 0])
    state = O.bodies[ball((-0.9, -0.7, radius), radius, mat, velocity=way, spin=np.cross((0, 0, 1), way) / radius)].state
    O.engines = cd_engine.engines(gravity=(0, 0, -G), tolerance=1e-12)
    O.dt = 1e-3
    for _ in range(100):
        O.run(15, True)
        assert O.engines[2].contacts == 1
    assert vector(state.vel) == pytest.approx(way, abs=1e-12) and state.pos[2] == pytest.approx(radius, abs=1e-12)


def cloud(count=60, seed=1, mu=0.4, speed=1.0):
    """Spheres of unequal sizes thrown at their centre."""
    r, mat = random.Random(seed), material(mu)
    for k in range(count):
        at = np.array([k % 4, k // 4 % 4, k // 16]) * 0.05 + [r.uniform(-.005, .005) for _ in range(3)]
        to = np.array([0.075, 0.075, 0.075]) - at
        ball(at, r.uniform(0.012, 0.02), mat, velocity=speed * to / np.linalg.norm(to), spin=[r.uniform(-20, 20) for _ in range(3)])


def sums(O):
    """Momentum, angular momentum, kinetic energy."""
    p, l, e = np.zeros(3), np.zeros(3), 0
    for b in O.bodies:
        s = b.state
        p += s.mass * vector(s.vel)
        l += s.mass * np.cross(s.pos, s.vel) + s.inertia[0] * vector(s.angVel)
        e += (s.mass * vector(s.vel) @ vector(s.vel) + s.inertia[0] * vector(s.angVel) @ vector(s.angVel)) / 2
    return p, l, e


@pytest.mark.parametrize("restitution", [0, 0.7])
def test_collisions_keep_both_momenta_and_account_for_the_energy(O, restitution):
    cloud()
    p, l, e = sums(O)
    engine = run(60, 1e-3, gravity=(0, 0, 0), restitution=restitution)
    after = sums(O)
    assert engine.totalIterations > 100
    assert after[0] == pytest.approx(p, abs=1e-13) and after[1] == pytest.approx(l, abs=1e-13)
    assert e - after[2] == pytest.approx(engine.dissipatedEnergy, rel=1e-10) and engine.dissipatedEnergy > 0.1 * e


def heap(O, steps, **settings):
    O.reset()
    mat = material(0.4)
    for axis, at in (2, -0.02), (0, -0.03), (0, 0.18), (1, -0.03), (1, 0.18):
        O.bodies.append(utils.wall(at, axis=axis, material=mat))
    cloud(40, speed=0.2)
    O.engines = cd_engine.engines(gravity=(0, 0, -G), **settings)
    O.dt = 1e-3
    O.run(steps, True)


def state(O):
    return [x for b in O.bodies for x in (*b.state.pos, *b.state.vel, *b.state.angVel, *b.state.ori)]


def test_threads_saving_and_publishing_leave_every_bit(O, tmp_path):
    heap(O, 200)
    assert O.engines[2].inSpace
    expected = state(O)
    for settings in dict(threads=2), dict(publish="always"):
        heap(O, 200, **settings)
        assert state(O) == expected
    heap(O, 100)
    O.save(str(tmp_path / "heap.yade.gz"))
    O.load(str(tmp_path / "heap.yade.gz"))
    O.run(100, True)
    assert state(O) == expected


def test_a_planar_scene_that_gains_a_free_sphere_goes_over_to_space(O, capfd):
    mat = material()
    O.bodies.append(utils.wall(0, axis=1, material=mat))
    disk = ball((0, 0.1, 0), 0.1, mat)
    O.bodies[disk].state.blockedDOFs = "zXY"
    O.engines = cd_engine.engines(gravity=(0, -G, 0))
    O.dt = 1e-3
    O.run(10, True)
    assert not O.engines[2].inSpace
    free = ball((0.05, 0.4, 0.03), 0.1, mat)
    O.run(400, True)
    message = capfd.readouterr().err
    assert O.engines[2].inSpace and message.count("solved in space") == 1 and f"body #{free}" in message
    assert O.bodies[free].state.pos[2] > 0.05 and O.bodies[disk].state.pos[2] == 0


@pytest.mark.parametrize("side, most", [(1, 20000), (2, 20000), (2, 2000)])
def test_spheres_that_plates_hold_on_all_sides_are_solved(O, side, most):
    """Gaps of 1e-12 m, left by errors of earlier steps, do not let all of their contacts stick at once. Sweeps alone missed four steps of five."""
    mat, radius = material(0.5), 0.1
    length = 2 * radius * side
    for place in np.ndindex(side, side, side):
        ball([radius + 2 * radius * k for k in place], radius, mat)
    plates = O.bodies.append(utils.aabbWalls([(0, 0, 0), (length,) * 3], thickness=0, material=mat))
    for axis, blocked in enumerate(("yzXYZ", "xzXYZ", "xyXYZ")):
        state = O.bodies[plates[2 * axis + 1]].state
        state.mass, state.blockedDOFs = 5, blocked
    reset, collider, engine = cd_engine.engines(tolerance=1e-8, maxIterations=most)
    O.engines = [reset, collider, cd_engine.PlateLoads(plates=plates, goals=(-1e3, -2e3, -3e3)), engine]
    O.dt = 1e-3
    O.run(200, True)
    assert engine.unconvergedSteps == 0 and engine.residual <= 1e-8
    for axis in range(3):  # each load is balanced
        assert abs(O.forces.f(plates[2 * axis + 1])[axis]) < 1e-6 * 1e3 * length**2
    assert max(b.state.vel.norm() for b in O.bodies) < 1e-9


def test_a_disk_is_freed_and_gravity_turned_at_once(O):
    mat = material()
    O.bodies.append(utils.wall(0, axis=1, material=mat))
    disks = [ball((0.3 * k, 0.1, 0), 0.1, mat) for k in range(2)]
    for disk in disks:
        O.bodies[disk].state.blockedDOFs = "zXY"
    O.engines = cd_engine.engines(gravity=(0, -G, 0))
    O.dt = 1e-3
    O.run(10, True)
    O.engines[2].gravity = (0, -G, -1)
    with pytest.raises(RuntimeError, match="points out of the x-y plane"):
        O.run(1, True)
    O.bodies[disks[0]].state.blockedDOFs = ""
    O.run(100, True)
    assert O.engines[2].inSpace and O.bodies[disks[0]].state.vel[2] == pytest.approx(-0.1 * 5 / 7, rel=1e-3)  # it rolls
    assert O.bodies[disks[1]].state.vel[2] == 0


@pytest.mark.parametrize("blocked", ["X", "xYZ", "XY", "xXZ"])
def test_spheres_with_blocked_freedoms_slide_against_coulomb_friction(O, blocked):
    """A single step of a sphere that slides: its impulse is mu m g dt against the velocity of the contact, whatever it cannot do."""
    mat, radius, dt = material(0.2), 0.1, 1e-3
    O.bodies.append(utils.wall(0, axis=2, material=mat))
    ball((5, 5, 5), radius, mat)  # so that the scene is in space
    state = O.bodies[ball((0, 0, radius), radius, mat, velocity=(0 if "x" in blocked else 1, 0.5, 0))].state
    state.blockedDOFs = blocked
    before = vector(state.vel)
    run(1, dt)
    now, spin = vector(state.vel), vector(state.angVel)
    slip = now + np.cross(spin, (0, 0, -radius))
    allowed = [letter not in blocked for letter in "xy"] + [False]
    assert now - before == pytest.approx(-0.2 * G * dt * slip / np.linalg.norm(slip) * allowed, abs=1e-12)


@pytest.mark.parametrize("blocked, keeps", [("yXYZ", 0), ("XYZ", 0), ("yXZ", 5 / 7)])
def test_spheres_with_blocked_freedoms_stick_or_roll(O, blocked, keeps):
    """Too slow to slide for a step: one that cannot turn stops, one that can rolls."""
    mat, radius = material(0.5), 0.1
    O.bodies.append(utils.wall(0, axis=2, material=mat))
    ball((5, 5, 5), radius, mat)  # so that the scene is in space
    state = O.bodies[ball((0, 0, radius), radius, mat, velocity=(1e-3, 0, 0))].state
    state.blockedDOFs = blocked
    run(3, 1e-3)
    assert vector(state.vel) == pytest.approx((keeps * 1e-3, 0, 0), abs=1e-14)


def test_a_loaded_plate_carries_what_presses_it_and_needs_no_message(O, capfd):
    """A planar scene may have a plate that moves along z, too, but here nothing is kept in a plane."""
    mat = material()
    floor, plate = O.bodies.append([utils.wall(0, axis=2, material=mat), utils.wall(0.2, axis=2, material=mat)])
    O.bodies[plate].state.mass, O.bodies[plate].state.blockedDOFs = 5, "xyXYZ"
    weight = G * O.bodies[ball((0, 0, 0.1), 0.1, mat)].state.mass
    O.forces.setPermF(plate, (0, 0, -100))
    run(10, 1e-3)
    assert O.forces.f(floor)[2] == pytest.approx(-(100 + 5 * G + weight), rel=1e-10)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("what", ["a turning box", "a clump", "a turning facet", "newton"])
def test_what_is_refused_in_space(O, what):
    mat = material()
    ball((0, 0, 1), 0.1, mat)
    settings = {"gravity": (0, 0, -G)}
    if what == "newton":
        settings["method"] = what
    elif what == "a turning box":
        O.bodies.append(utils.box((0, 0, 0), (1, 1, 0.1), material=mat))
    elif what == "a clump":
        O.bodies.appendClumped([utils.sphere((k, 0, 0), 0.6, material=mat) for k in (0, 1)])
    else:
        O.bodies.append(utils.facet(((0, 0, 0), (1, 0, 0), (0, 1, 0)), fixed=False, material=mat))
    O.engines = cd_engine.engines(**settings)
    O.dt = 1e-3
    with pytest.raises(RuntimeError, match="free to turn|clump|method 'newton' solves planar scenes only"):
        O.run(1, True)
