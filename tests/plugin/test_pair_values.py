"""Restitution and friction by pair of materials, as YADE's MatchMaker states them."""
import copy
import math

import pytest
from yade import Vector3, utils, wrapper as w

import cd_engine

from . import plane


def materials(O, count, mu=0.5):
    return [plane.material(mu) for _ in range(count)]


def drops(O, mats, floor):
    """Append a floor of one material and a disk of each other, 1 m apart, that falls at 2 m/s without gravity."""
    O.bodies.append(utils.wall(0, axis=1, material=floor))
    return [plane.disk((k, 0.1004), 0.1, velocity=(0, -2), mat=mat) for k, mat in enumerate(mats)]


def speeds_after(O, ids):
    O.run(10, True)
    return [O.bodies[i].state.vel[1] for i in ids]


def test_two_bounces_with_different_pairs_in_one_scene(O):
    """The third disk matches nothing and has the engine's restitution, the fourth a value of 0."""
    floor, *others = materials(O, 5)
    disks = drops(O, others, floor)
    plane.engine(restitution=0.5, en=w.MatchMaker(matches=((floor, others[0], 0.8), (others[1], floor, 0.3), (others[3], floor, 0))))
    assert speeds_after(O, disks) == pytest.approx([1.6, 0.6, 1.0, 0], abs=1e-9)


@pytest.mark.parametrize("en, speed", [(0.4, 0.8), (w.MatchMaker(algo="val", val=0.25), 0.5), (w.MatchMaker(algo="zero"), 0.0), (None, 1.8)])
def test_a_value_for_all_pairs(O, en, speed):
    floor, mat = materials(O, 2)
    disks = drops(O, [mat], floor)
    plane.engine(restitution=0.9, en=en)
    assert speeds_after(O, disks) == pytest.approx([speed], abs=1e-9)


@pytest.mark.parametrize("method", ["MD", "CD"])
@pytest.mark.parametrize("maker", [
    None, 0.1, w.MatchMaker(algo="max"), w.MatchMaker(algo="avg"), w.MatchMaker(algo="harmAvg"), w.MatchMaker(algo="min", matches=((0, 2, 0.05),)),
    w.MatchMaker(algo="val", val=0.3, matches=((2, 0, 0.0), (1, 2, 0.15)))])
def test_friction_is_that_of_yades_functor(O, method, maker):
    """Two disks pressed on a box, of three materials: the coefficient of each contact is what Ip2_FrictMat_FrictMat_FrictPhys gives."""
    mats = [O.materials.append(w.FrictMat(frictionAngle=angle, young=1e7)) for angle in (0.2, 0.4, 0.6)]
    plane.box((0, -0.01), (1, 0.01), mat=mats[2])
    for k in (0, 1):
        plane.disk((0.5 * k, 0.0999999), 0.1, mat=mats[k], velocity=(0, -1e-3))
    if method == "CD":
        plane.run(1, 1e-3, frictAngle=maker, gravity=(0, -9.81, 0))
    else:
        O.engines = [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb()], verletDist=0),
                     w.InteractionLoop([w.Ig2_Box_Sphere_ScGeom()], [w.Ip2_FrictMat_FrictMat_FrictPhys(frictAngle=maker)],
                                       [w.Law2_ScGeom_FrictPhys_CundallStrack()])]
        O.dt = 1e-6
        O.step()
    angles = (0.2, 0.4, 0.6)
    maker = w.MatchMaker(algo="val", val=maker) if isinstance(maker, float) else maker
    for k in (0, 1):
        angle = maker(mats[k], mats[2], angles[k], angles[2]) if maker else min(angles[k], angles[2])
        assert O.interactions[0, k + 1].phys.tangensOfFrictionAngle == pytest.approx(math.tan(angle), rel=1e-14)


def test_two_blocks_on_one_slope(O):
    """Disks that cannot turn slide with g (sin a - mu cos a), each with the mu of its pair; changed in mid-run and with another material."""
    floor, *others = materials(O, 3, mu=1)
    O.bodies.append(utils.wall(0, axis=1, material=floor))
    disks = [plane.disk((k, 0.1), 0.1, mat=mat, blocked="zXYZ") for k, mat in enumerate(others)]
    a, g, dt = 0.5, 9.81, 1e-3
    cd = plane.engine(dt, gravity=(g * math.sin(a), -g * math.cos(a), 0), frictAngle=w.MatchMaker(
        matches=((floor, others[0], math.atan(0.2)), (floor, others[1], math.atan(0.6)))))
    O.run(100, True)
    assert [O.bodies[i].state.vel[0] for i in disks] == pytest.approx([0.1 * g * (math.sin(a) - 0.2 * math.cos(a)), 0], abs=1e-6)
    O.run(200, True)  # the second one sleeps
    O.bodies[disks[1]].material = O.materials[others[0]]
    O.run(100, True)
    assert O.bodies[disks[1]].state.vel[0] == pytest.approx(0.1 * g * (math.sin(a) - 0.2 * math.cos(a)), abs=1e-6)
    cd.frictAngle = math.atan(0.9)
    O.run(400, True)
    assert [O.bodies[i].state.vel[0] for i in disks] == pytest.approx([0, 0], abs=1e-6)


def test_it_is_kept_and_shown(O, tmp_path):
    maker = w.MatchMaker(matches=((0, 1, 0.5),), algo="avg")
    cd = cd_engine.ContactDynamics(en=maker)
    for engine in (cd, copy.copy(cd)):
        assert engine.en.matches == [Vector3(0, 1, 0.5)] and engine.en.algo == "avg" and engine.frictAngle is None
    plane.engine(en=maker)
    plane.disk((0, 0), 0.1)
    O.save(str(tmp_path / "scene.yade.gz"))
    O.load(str(tmp_path / "scene.yade.gz"))
    assert O.engines[-1].en.matches == [Vector3(0, 1, 0.5)] and O.engines[-1].frictAngle is None
    O.engines[-1].en = None
    assert O.engines[-1].en is None


@pytest.mark.parametrize("settings, words", [
    (dict(en=1.5), "en has the value 1.5"), (dict(frictAngle=w.MatchMaker(matches=((0, 1, 2),))), "frictAngle has the value 2 rad")])
def test_values_out_of_range_are_refused(O, settings, words):
    plane.disk((0, 0), 0.1)
    plane.engine(**settings)
    with pytest.raises(RuntimeError, match=words):
        O.step()
    with pytest.raises(TypeError, match="ContactDynamics.en must be a MatchMaker, a number or None"):
        cd_engine.ContactDynamics(en="bouncy")
