"""Rolling resistance: etaRoll of CohFrictMat bounds the moment of a contact by min(eta_1 R_1, eta_2 R_2) p_n, as in YADE's moment law."""
import math

import pytest
from yade import utils, wrapper as w

from . import plane

G = 9.81


def material(O, eta, mu=0.9, young=1e8, law=True, **other):
    return O.materials.append(w.CohFrictMat(young=young, poisson=0.5, density=1000, frictionAngle=math.atan(mu), etaRoll=eta, momentRotationLaw=law,
                                            **other))


def wheel(O, eta, floor="wall", radius=0.1, velocity=0., mass=2., **other):
    """A disk on a floor, rolling at a velocity. Return its id."""
    mat = material(O, eta, **other)
    if floor == "wall":
        plane.floor(mat)
    elif floor == "box":
        plane.box((0, -0.05), (10, 0.05), mat=mat)
    return plane.disk((0, radius), radius, mass=mass, velocity=(velocity, 0), spin=-velocity / radius, mat=mat)


def moments(O):
    return [tuple(i.phys.moment_bending) for i in sorted((i for i in O.interactions if i.isReal), key=lambda i: (i.id1, i.id2))]


def digest():
    import yade
    return plane.digest(), moments(yade.O)


@pytest.mark.parametrize("settings", [
    dict(), dict(method="nsgs", reduce=False), dict(seed=2), dict(stiffness=1e7, tangentialStiffness=5e6), dict(materialStiffness=True)], ids=str)
@pytest.mark.parametrize("floor", ["wall", "box"])
def test_a_disk_rolls_down_a_slope_that_is_steeper_than_eta(O, floor, settings):
    """tan a = eta: below it rests, above it rolls with g (sin a - eta cos a)/(1 + I/(m R^2)), with I = m R^2/2."""
    eta = 0.1
    for slope in (0.095, 0.105):
        O.reset()
        a = math.atan(slope)
        disk = wheel(O, eta, floor)
        rigid = "iff" not in str(settings)
        cd = plane.run(400, 1e-3, gravity=(G * math.sin(a), -G * math.cos(a), 0), **{"tolerance": 1e-10 if rigid else 1e-3} | settings)
        v, spin = O.bodies[disk].state.vel[0], O.bodies[disk].state.angVel[2]
        assert cd.unconvergedSteps == 0
        if slope < eta:
            assert abs(v) < 1e-6
        else:
            assert v == pytest.approx(0.4 * G * (math.sin(a) - eta * math.cos(a)) / 1.5, rel=1e-8 if rigid else 0.02)  # springs turn a little first
            assert v == pytest.approx(-spin * 0.1, abs=1e-9 if rigid else 1e-4)


@pytest.mark.parametrize("dt", [1e-3, 2.7e-3])
def test_a_wheel_comes_to_rest_after_its_distance(O, dt):
    """Deceleration eta g/(1 + I/(m R^2)): v^2 (1 + I/(m R^2))/(2 eta g), but for the last step, and the energy is dissipated."""
    v, eta = 0.5, 0.05
    disk = wheel(O, eta, velocity=v)
    cd = plane.run(math.ceil(2 / dt), dt, gravity=(0, -G, 0), tolerance=1e-12)
    decelerates = eta * G / 1.5
    assert O.bodies[disk].state.pos[0] == pytest.approx(v**2 / (2 * decelerates), abs=decelerates * dt**2)
    assert tuple(O.bodies[disk].state.vel) == (0, 0, 0) and O.bodies[disk].state.angVel[2] == 0
    assert cd.dissipatedEnergy == pytest.approx(0.5 * 2 * v**2 * 1.5, rel=1e-9)
    assert cd.sleeping == 1


def test_yade_s_own_law_stops_it_at_the_same_place(O):
    """Springs with Law2_ScGeom6D_CohFrictPhys_CohesionMoment, of unequal etaRoll."""
    places = []
    for springs in (False, True):
        O.reset()
        mat, other = material(O, 0.05, young=1e7), material(O, 0.2, young=1e7)
        plane.box((0, -0.05), (10, 0.05), mat=other)
        disk = plane.disk((0, 0.1), 0.1, velocity=(0.5, 0), spin=-5, mat=mat)
        if springs:
            O.engines = [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb()]), w.InteractionLoop(
                [w.Ig2_Sphere_Sphere_ScGeom6D(), w.Ig2_Box_Sphere_ScGeom6D()], [w.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys()],
                [w.Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True, useIncrementalForm=True)]),
                w.NewtonIntegrator(gravity=(0, -G, 0), damping=0)]
            O.dt = 1e-4
            O.run(16000, True)
        else:
            plane.run(1600, 1e-3, gravity=(0, -G, 0))
        places.append(O.bodies[disk].state.pos[0])
    assert places[0] == pytest.approx(0.25 * 1.5 / (2 * 0.05 * G), rel=1e-5) and places[1] == pytest.approx(places[0], rel=0.01)


def test_the_smaller_bound_of_two_disks_holds(O):
    """A disk that spins beside a fixed one, pressed on it without friction: I dw/dt = -min(0.3 0.1, 0.1 0.2) N."""
    plane.disk((0, 0), 0.1, blocked="xyzXYZ", mat=material(O, 0.3, mu=0))
    disk = plane.disk((0.3, 0), 0.2, mass=4, blocked="yzXY", spin=50, mat=material(O, 0.1, mu=0))
    O.forces.setPermF(disk, (-7, 0, 0))
    plane.run(100, 1e-3)
    inertia = 4 * 0.2**2 / 2
    assert O.bodies[disk].state.angVel[2] == pytest.approx(50 - 0.02 * 7 / inertia * 0.1, rel=1e-12)
    assert moments(O)[0] == pytest.approx((0, 0, -0.02 * 7), rel=1e-9) and O.forces.t(0)[2] == pytest.approx(0.02 * 7, rel=1e-9)
    assert O.forces.t(disk)[2] == pytest.approx(-0.02 * 7, rel=1e-9)


@pytest.mark.parametrize("eta, law", [(0.1, False), (0, True), (-1, True)])
def test_without_law_or_bound_there_is_no_moment(O, eta, law, capfd):
    disk = wheel(O, eta, velocity=0.5, law=law)
    plane.run(300, 1e-3, gravity=(0, -G, 0), tolerance=1e-12)
    assert O.bodies[disk].state.vel[0] == pytest.approx(0.5, abs=1e-12)
    said = capfd.readouterr().err
    assert "etaRoll" in said and ("negative etaRoll" in said) == (eta < 0)


def test_the_moment_at_rest_and_its_sign_in_each_plane(O):
    """A disk at rest on a slope: the moment m g sin(a) R holds it, about the axis that turns x to y."""
    a = math.atan(0.08)
    for axes in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
        O.reset()
        mat = material(O, 0.1)
        O.bodies.append(utils.wall(0, axis=axes[1], material=mat))
        place, gravity = [0, 0, 0], [0, 0, 0]
        place[axes[1]] = 0.1
        gravity[axes[0]], gravity[axes[1]] = G * math.sin(a), -G * math.cos(a)
        body = utils.sphere(place, 0.1, material=mat)
        body.state.mass, body.state.inertia, body.state.blockedDOFs = 2, (0.01, ) * 3, {2: "zXY", 1: "yXZ", 0: "xYZ"}[axes[2]]
        O.bodies.append(body)
        plane.run(50, 1e-3, gravity=gravity, tolerance=1e-10)
        turn = -1 if axes[2] == 1 else 1
        expected = [0, 0, 0]
        expected[axes[2]] = turn * 2 * G * math.sin(a) * 0.1  # a wheel that rolled down would turn the other way
        assert moments(O)[0] == pytest.approx(expected, rel=1e-8)
        i = next(i for i in O.interactions if i.isReal)
        assert i.phys.maxRollPl == pytest.approx(0.01) and i.phys.momentRotationLaw
        assert tuple(O.bodies[1].state.vel) == pytest.approx((0, 0, 0), abs=1e-9)


def heap(O, eta):
    """Thirty disks of unequal size fall on a floor between walls."""
    plane.heap(0.5)
    mat = material(O, eta, mu=0.5)
    for b in O.bodies:
        b.mat = O.materials[mat]


@pytest.mark.parametrize("settings", [
    dict(), dict(restitution=0.5), dict(stiffness=1e6, tangentialStiffness=5e5, dampingRatio=0.1)], ids=str)
def test_the_energy_balance_is_closed(O, settings):
    heap(O, 0.2)
    O.trackEnergy = True
    plane.engine(1e-3, gravity=(0, -G, 0), **settings)
    O.run(1, True)
    before = O.energy.total()
    O.run(600, True)
    assert O.energy.total() == pytest.approx(before, abs=1e-9 * O.energy["plastDissip"])
    assert O.energy["plastDissip"] > 1


def test_a_run_goes_on_from_a_file_and_with_any_publishing_to_the_last_bit(O, tmp_path):
    heap(O, 0.2)
    plane.engine(1e-3, gravity=(0, -G, 0))
    O.run(300, True)
    assert max(abs(m[2]) for m in moments(O)) > 1e-3
    plane.goes_on(tmp_path / "a.yade.gz", 200, digest)
    O.load(str(tmp_path / "a.yade.gz"))
    O.engines[2].publish = "always"
    O.run(200, True)
    always = digest()
    O.load(str(tmp_path / "a.yade.gz"))
    O.run(200, True)
    assert digest() == always


def test_a_heap_with_rolling_resistance_comes_to_rest_and_sleeps(O):
    """Without it some disks roll on and on."""
    heap(O, 0.2)
    cd = plane.run(4000, 1e-3, gravity=(0, -G, 0))
    assert cd.sleeping == cd.islands > 0 and cd.unconvergedSteps == 0


def test_what_does_not_know_moments_says_so(O, tmp_path):
    wheel(O, 0.1)
    cd = plane.engine(1e-3, gravity=(0, -G, 0))
    with pytest.raises(Exception, match="cannot hold the rolling resistance"):
        cd.exportProblem(str(tmp_path / "step.hdf5"))
    cd.method = "newton"
    with pytest.raises(RuntimeError, match="method='auto'"):
        O.run(1, True)


def test_moments_of_springs_are_taken_over(O):
    """A disk that YADE's law holds on a slope stays at rest when implicit springs go on, with the same moment."""
    a = math.atan(0.08)
    mat = material(O, 0.1)
    plane.box((0, -0.05), (10, 0.05), mat=mat)
    disk = plane.disk((0, 0.1), 0.1, mass=2, mat=mat)
    gravity = (G * math.sin(a), -G * math.cos(a), 0)
    O.engines = [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb()]), w.InteractionLoop(
        [w.Ig2_Sphere_Sphere_ScGeom6D(), w.Ig2_Box_Sphere_ScGeom6D()], [w.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys()],
        [w.Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True, useIncrementalForm=True)]),
        w.NewtonIntegrator(gravity=gravity, damping=0.5)]
    O.dt = 5e-5
    O.run(8000, True)
    before, place, kr = moments(O)[0][2], O.bodies[disk].state.pos[0], next(i for i in O.interactions if i.isReal).phys.kr
    assert before == pytest.approx(2 * G * math.sin(a) * 0.1, rel=1e-2)
    cd = plane.run(100, 1e-3, gravity=gravity, materialStiffness=True)
    i = next(i for i in O.interactions if i.isReal)
    assert cd.unconvergedSteps == 0 and moments(O)[0][2] == pytest.approx(2 * G * math.sin(a) * 0.1, rel=1e-3)
    assert i.phys.kr == pytest.approx(kr, rel=1e-12) and O.bodies[disk].state.pos[0] == pytest.approx(place, abs=1e-6)


@pytest.mark.parametrize("settings, eta", [(dict(), 0.1), (dict(mask=2), 0)])
def test_space_knows_neither_moments_nor_belts_and_says_so(O, settings, eta):
    plane.floor(material(O, eta))
    O.bodies.append(utils.sphere((0, 0.1, 0), 0.1, material=material(O, eta)))
    plane.engine(1e-3, gravity=(0, -G, 0), **settings)
    with pytest.raises(RuntimeError, match="in the plane only"):
        O.run(1, True)
