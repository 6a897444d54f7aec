"""Runs in space as users make them: turning meshes, boxes of facets, loaded plates, springs before and after, bodies that come and go, saving; and
what is refused, by name and with what to do."""
import math

import numpy as np
import pytest
import yade
from yade import geom, utils, wrapper as w

import cd_engine

from .test_space import G, ball, material, run, state, vector


def drum(mat, radius=0.15, segments=10):
    """Append a closed cylinder of facets about y, and spheres in it. Return the ids of the facets and the engine that turns them."""
    ids = yade.O.bodies.append(geom.facetCylinder((0, 0, 0), radius, 0.2, orientation=yade.Quaternion((1, 0, 0), math.pi / 2),
                                                  segmentsNumber=segments, material=mat))
    for k in range(24):
        ball((0.045 * (k % 4 - 1.5), 0.045 * (k // 4 % 3 - 1), 0.045 * (k // 12) - 0.03), 0.015 + 0.0002 * k, mat)
    return ids, w.RotationEngine(ids=ids, rotationAxis=(0, 1, 0), angularVelocity=2, rotateAroundZero=True, zeroPoint=(0, 0, 0), label="turns")


def turning(O, **settings):
    """Set a drum that turns. Return the ids of its facets and of the spheres."""
    ids, engine = drum(material(0.4))
    reset, collider, cd = cd_engine.engines(**{"gravity": (0, 0, -G), "tolerance": 1e-8, "gapCorrection": 0.1} | settings)
    O.engines, O.dt = [reset, collider, engine, cd], 1e-3
    return ids, [b.id for b in O.bodies if type(b.shape).__name__ == "Sphere"]


def test_spheres_in_a_turning_drum_stay_inside_and_account_for_its_work(O):
    """What the drum does by its forces is gained, by motion and height, or lost. The forces act at the middles of steps, about the facets' centres
    there; with gapCorrection=0, since that moves spheres without a force."""
    ids, spheres = turning(O, gapCorrection=0, tolerance=1e-10)
    O.trackEnergy = True
    at = O.bodies[ids[0]].state.pos
    angle, steps, work = math.atan2(at[2], at[0]), 400, 0.0
    for _ in range(steps):
        O.run(1, True)
        for i in ids:
            s = O.bodies[i].state
            work += O.dt * (O.forces.f(i).dot(s.vel) + O.forces.t(i).dot(s.angVel))
    assert O.engines[3].unconvergedSteps == 0
    lost = sum(value for _, value in O.energy.items())
    assert -work == pytest.approx(lost, rel=1e-6) and lost > 0.1 * O.energy["plastDissip"]
    turned = math.atan2(O.bodies[ids[0]].state.pos[2], O.bodies[ids[0]].state.pos[0]) - angle
    assert abs(turned) == pytest.approx(2 * steps * 1e-3, abs=1e-12)


def test_spheres_in_a_turning_drum_stay_inside(O):
    """With gapCorrection overlaps are a hundredth of a radius at most."""
    ids, spheres = turning(O)
    O.run(1500, True)
    for i in spheres:
        x, y, z = O.bodies[i].state.pos
        r = O.bodies[i].shape.radius
        assert math.hypot(x, z) + r < 0.15 + 0.01 * r and abs(y) + r < 0.1 + 0.01 * r
    assert O.engines[3].maxPenetration < 0.01 * 0.015 and O.engines[3].contacts > 20


def test_a_drum_goes_on_after_a_save_to_the_last_bit(O, tmp_path):
    turning(O)
    O.run(200, True)
    expected = state(O)
    O.reset()
    turning(O)
    O.run(90, True)
    O.save(str(tmp_path / "drum.yade.gz"))
    O.reset()
    O.load(str(tmp_path / "drum.yade.gz"))
    O.run(110, True)
    assert state(O) == expected


def test_a_sphere_in_the_corner_of_a_box_of_facets(O):
    """Without friction each face carries its part of the weight, as one force, however the box is triangulated."""
    mat, pull = material(0), np.array([-2.0, -3, -5])
    O.bodies.append(geom.facetBox((0.5, 0.5, 0.5), (0.5, 0.5, 0.5), wallMask=63, material=mat))
    s = O.bodies[ball((0.1, 0.1, 0.1), 0.1, mat)].state
    engine = run(10, 1e-3, gravity=tuple(pull))
    loaded = [i for i in O.interactions if i.isReal]
    assert engine.loadedContacts == len(loaded) == 3 and vector(s.vel) == pytest.approx((0, 0, 0), abs=1e-12)
    forces = sorted((tuple(np.round(np.abs(vector(i.geom.normal)), 12)), i.phys.normalForce.norm()) for i in loaded)
    assert [force for _, force in forces] == pytest.approx([5 * s.mass, 3 * s.mass, 2 * s.mass], rel=1e-9)  # normals z, y, x in this order
    assert [normal for normal, _ in forces] == [(0, 0, 1), (0, 1, 0), (1, 0, 0)]


@pytest.mark.parametrize("thickness", [0, 0.02])
def test_plates_load_spheres_on_three_axes(O, thickness):
    """Eight spheres in a cube: each of four columns along an axis carries a quarter of the stress over the area of the plate."""
    mat, radius, goals = material(0), 0.05, (-1000.0, -2000.0, -3000.0)
    O.bodies.append(utils.aabbWalls([(0, 0, 0), (0.2, 0.2, 0.2)], thickness=thickness, oversizeFactor=1, material=mat))
    for k in range(8):
        ball((0.05 + 0.1 * (k % 2), 0.05 + 0.1 * (k // 2 % 2), 0.05 + 0.1 * (k // 4)), radius, mat)
    for axis in range(3):
        plate = O.bodies[2 * axis + 1].state
        plate.mass, plate.blockedDOFs = 1, "xyzXYZ".replace("xyz"[axis], "")
    reset, collider, cd = cd_engine.engines(tolerance=1e-12)
    loads = cd_engine.PlateLoads(plates=list(range(6)), stressMask=7, goals=goals)
    O.engines, O.dt = [reset, collider, loads, cd], 1e-3
    O.run(20, True)
    assert cd.unconvergedSteps == 0 and cd.inSpace and vector(loads.strain) == pytest.approx((0, 0, 0), abs=1e-9)
    for k in range(6):
        pushes = [i.phys.normalForce.norm() for i in O.bodies[k].intrs() if i.isReal]
        assert len(pushes) == 4 and sum(pushes) == pytest.approx(-goals[k // 2] * 0.2**2, rel=1e-9)


def springs(O, damping=0.7):
    O.engines = [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Facet_Aabb(), w.Bo1_Wall_Aabb(), w.Bo1_Box_Aabb()]),
                 w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(), w.Ig2_Facet_Sphere_ScGeom(), w.Ig2_Wall_Sphere_ScGeom(), w.Ig2_Box_Sphere_ScGeom()],
                                   [w.Ip2_FrictMat_FrictMat_FrictPhys()],
                                   [w.Law2_ScGeom_FrictPhys_CundallStrack()]), w.NewtonIntegrator(gravity=(0, 0, -G), damping=damping)]
    O.dt = 0.3 * utils.PWaveTimeStep()


def test_springs_then_rigid_grains_then_springs(O):
    """A pyramid of four on facets stays so: rigid grains carry the weight that the springs carried, and push no overlap out. Springs then find the
    contacts without their tangential forces of before: the pyramid spreads until they have them again, k_t = 0.3 k_n, so by some overlaps."""
    mat, radius = material(0.5), 0.1
    O.materials[mat].young = 1e6
    O.bodies.append(geom.facetBox((0, 0, 0.5), (0.5, 0.5, 0.5), wallMask=16, material=mat))
    aside = 2 * radius / math.sqrt(3)
    ids = [ball((aside * math.cos(t), aside * math.sin(t), radius), radius, mat) for t in np.arange(3) * 2 * math.pi / 3]
    ids.append(ball((0, 0, radius + 2 * radius * math.sqrt(2 / 3)), radius, mat))
    springs(O)
    O.run(5000, True)
    places = [vector(O.bodies[i].state.pos) for i in ids]
    weight = G * sum(O.bodies[i].state.mass for i in ids)
    deepest = max(i.geom.penetrationDepth for i in O.interactions if i.isReal)
    assert utils.unbalancedForce() < 1e-3 and deepest > 1e-5

    def on_the_floor():
        return -sum(O.forces.f(b.id)[2] for b in O.bodies if type(b.shape).__name__ == "Facet")

    def moved():
        return max(np.linalg.norm(vector(O.bodies[i].state.pos) - place) for i, place in zip(ids, places))

    O.engines, O.dt = cd_engine.engines(gravity=(0, 0, -G), tolerance=1e-10), 1e-3
    O.run(300, True)
    assert O.engines[2].unconvergedSteps == 0 and on_the_floor() == pytest.approx(weight, rel=1e-8) and moved() < 1e-3 * deepest
    cd_engine.release()
    springs(O)
    O.run(5000, True)
    assert utils.unbalancedForce() < 1e-3 and on_the_floor() == pytest.approx(weight, rel=1e-3) and moved() < 10 * deepest


@pytest.mark.parametrize("floor", [lambda mat: utils.facet([(-5, -5, 0), (5, -5, 0), (0, 5, 0)], material=mat),
                                   lambda mat: utils.wall(0, axis=2, material=mat),
                                   lambda mat: utils.box((0, 0, -0.1), (1, 1, 0.1), fixed=True, material=mat)], ids=["facet", "wall", "box"])
def test_every_boundary_has_the_stiffness_of_yades_springs(O, floor):
    """YADE's functors give a Facet twice the sphere's radius, other boundaries the same. At rest neither force nor place then changes: YADE's own
    step moves the sphere by less than 1e-12 m, the first one of the engine by the error of its solver."""
    mat = O.materials.append(utils.FrictMat(frictionAngle=0.5, density=1000, young=1e6, poisson=0.3))
    O.bodies.append(floor(mat))
    sphere = O.bodies[ball((0, 0, 0.0997), 0.1, mat)]
    springs(O)
    O.run(5000, True)
    contact = O.interactions[0, 1]
    height, stiffness, force = sphere.state.pos[2], (contact.phys.kn, contact.phys.ks), contact.phys.normalForce[2]
    O.engines, O.dt = cd_engine.engines(gravity=(0, 0, -G), materialStiffness=True), 1e-4
    O.run(100, True)
    contact = O.interactions[0, 1]
    assert (contact.phys.kn, contact.phys.ks) == pytest.approx(stiffness, rel=1e-12)
    assert contact.phys.normalForce[2] == pytest.approx(force, rel=1e-6) and abs(sphere.state.pos[2] - height) < 1e-9


def test_springs_that_overlap_much_are_too_soft_also_at_the_first_step(O, capfd):
    """Springs of Contact Dynamics take over deep overlaps of YADE's: nobody has put the bodies there."""
    mat, radius = material(), 0.1
    O.materials[mat].young = 1e5
    O.bodies.append(geom.facetBox((0, 0, 0.5), (0.5, 0.5, 0.5), wallMask=16, material=mat))
    sphere = ball((0.1, -0.3, radius), radius, mat)
    O.forces.setPermF(sphere, (0, 0, -400))
    springs(O)
    O.run(3000, True)
    assert max(i.geom.penetrationDepth for i in O.interactions if i.isReal) > 0.25 * radius
    capfd.readouterr()
    O.engines, O.dt = cd_engine.engines(gravity=(0, 0, -G), materialStiffness=True), 1e-3
    O.run(2, True)
    assert "The springs are too soft for what presses on them" in capfd.readouterr().err


def test_bodies_come_and_go_in_a_run(O):
    """A PyRunner erases a sphere and a facet and puts a new sphere in; the floor then carries what is there."""
    mat = material(0.5)
    floor = O.bodies.append(geom.facetBox((0, 0, 0.5), (1, 1, 0.5), wallMask=16, material=mat))
    first = [ball((0.3 * k - 0.3, 0.1, 0.1), 0.1, mat) for k in range(3)]
    O.engines = cd_engine.engines(gravity=(0, 0, -G), tolerance=1e-12)
    O.dt = 1e-3
    O.run(20, True)
    O.bodies.erase(first[1])
    new = ball((0.05, -0.4, 0.15), 0.15, mat)
    O.run(20, True)

    def carried():
        return -sum(O.forces.f(i)[2] for i in floor if O.bodies[i])

    assert carried() == pytest.approx(G * sum(O.bodies[i].state.mass for i in (first[0], first[2], new)), rel=1e-9)
    gone = next(i.id1 for i in O.bodies[new].intrs() if i.isReal)
    O.bodies.erase(gone)  # the facet under the new sphere, which falls, and others with it or not
    O.run(20, True)
    assert O.bodies[new].state.vel[2] == pytest.approx(-G * 0.02, rel=1e-9)


def polyhedron(mat):
    if not hasattr(w, "Polyhedra"):
        pytest.skip("this YADE was built without polyhedra, as that of Debian 13")
    body = w.Body()
    body.shape, body.material = w.Polyhedra(v=((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))), w.PolyhedraMat()
    body.state.mass, body.state.inertia = 1, (1, 1, 1)
    return body


def shaped(shape):
    def make(mat):
        body = utils.sphere((0, 0, 5), 0.1, material=mat)
        body.shape = shape()
        return body
    return make


def rolling(mat):
    index = yade.O.materials.append(w.CohFrictMat(momentRotationLaw=True, etaRoll=0.1, frictionAngle=0.5))
    return utils.sphere((0, 0, 5), 0.1, material=index)


NO_SHAPE = "Cylinder", "ChainedCylinder", "GridNode", "GridConnection", "PFacet"


@pytest.mark.parametrize("make, words", [
    (polyhedron, "has the shape Polyhedra. .* or erase it"),
    *[(shaped(lambda name=name: getattr(w, name)(radius=0.1)), f"has the shape {name}. .* Replace it, a fixed one by Facets") for name in NO_SHAPE],
    (rolling, "rolling resistance of a CohFrictMat is known in the plane only. Set its momentRotationLaw to")])
def test_bodies_that_are_refused_by_name(O, make, words):
    mat = material()
    ball((0, 0, 1), 0.1, mat)
    O.bodies.append(make(mat))
    O.engines, O.dt = cd_engine.engines(gravity=(0, 0, -G)), 1e-3
    with pytest.raises(RuntimeError, match=words):
        O.run(1, True)


@pytest.mark.parametrize("engine", ["Law2_ScGeom_CapillaryPhys_Capillarity", "TriaxialStressController", "InteractionLoop",
                                    "GlobalStiffnessTimeStepper"])
def test_engines_that_are_refused_by_name(O, engine):
    ball((0, 0, 1), 0.1, material())
    reset, collider, cd = cd_engine.engines(gravity=(0, 0, -G))
    O.engines, O.dt = [reset, collider, getattr(w, engine)(), cd], 1e-3
    with pytest.raises(RuntimeError, match=f"{engine}.* Remove it"):
        O.run(1, True)


def test_a_planar_scene_that_gains_a_facet_goes_over_to_space(O, capfd):
    """A disk kept in the plane then rests on the facet as it did on the wall, one message says why, and it stays in its plane."""
    mat = material(0.5)
    wall = O.bodies.append(utils.wall(0, axis=1, material=mat))
    disk = ball((0, 0.1, 0), 0.1, mat)
    O.bodies[disk].state.blockedDOFs = "zXY"
    O.engines, O.dt = cd_engine.engines(gravity=(0, -G, 0)), 1e-3
    O.run(10, True)
    assert not O.engines[2].inSpace
    facet = O.bodies.append(utils.facet([(-1, 0, -1), (1, 0, -1), (0, 0, 2)], material=mat))
    O.bodies.erase(wall)
    O.run(50, True)
    message = capfd.readouterr().err
    assert O.engines[2].inSpace and message.count("solved in space") == 1 and f"body #{facet}" in message
    assert vector(O.bodies[disk].state.pos) == pytest.approx((0, 0.1, 0), abs=1e-9)
    assert O.forces.f(facet)[1] == pytest.approx(-G * O.bodies[disk].state.mass, rel=1e-6)


@pytest.mark.parametrize("flat", [True, False])
def test_a_packing_with_a_restitution_comes_to_rest(O, flat):
    """A column of 25 layers that fell: steps take few sweeps, as without a restitution, and nearly all bodies are slower than their weight makes them
    in a step; some rattle in their cages. If all contacts rebounded, however slowly, a step would take 185 in space for ever."""
    mat, r, dt = material(0.3), 0.01, 1e-3
    O.bodies.append(geom.facetBox((0, 0, 1), (0.05, 0.05, 1), wallMask=31, material=mat) if not flat else [
        utils.box((x, 0, z), (a, r, b), fixed=True, material=mat) for x, z, a, b in ((0, -r, 0.05, r), (-0.06, 1, r, 1), (0.06, 1, r, 1))])
    for k in range(100 if flat else 400):
        i, j, layer = k % 4, 0 if flat else k // 4 % 4, k // (4 if flat else 16)
        i = ball(((i - 1.5) * 2.2 * r + 1e-4 * (k % 7), 0 if flat else (j - 1.5) * 2.2 * r - 1e-4 * (k % 5), r * (1.1 + 2.05 * layer)), r, mat)
        if flat:
            O.bodies[i].state.blockedDOFs = "yXZ"
    O.engines, O.dt = cd_engine.engines(gravity=(0, 0, -G), tolerance=1e-3, restitution=0.5), dt
    O.run(1000, True)
    cd, before = O.engines[-1], O.engines[-1].totalIterations
    O.run(50, True)
    assert cd.inSpace != flat and cd.contacts > 100
    assert np.quantile([b.state.vel.norm() for b in O.bodies], 0.98) < G * dt
    assert (cd.totalIterations - before) / 50 < 10


@pytest.mark.parametrize("apart, normal", [((1, 0, 0), "along a floor"), ((0, 0, 1), "in free fall")])
@pytest.mark.parametrize("speed", [1e-3, 5e-3])
def test_slow_impacts_of_bodies_that_nothing_holds_rebound(O, apart, normal, speed):
    """Slower than g dt: two equal spheres swap their velocities, whatever gravity does to both."""
    mat, r, fall, apart = material(0), 0.02, normal == "in free fall", np.array(apart)
    if not fall:
        O.bodies.append(utils.wall(0, axis=2, material=mat))
    first, second = (O.bodies[ball((0, 0, r) + (2 * r + 2.5e-6) * k * apart, r, mat, velocity=(1 - k) * speed * apart)].state for k in (0, 1))
    run(20, 1e-3, restitution=1)
    assert (vector(second.vel) - vector(first.vel)) @ apart == pytest.approx(speed, rel=1e-9)


def test_a_grain_rebounds_from_a_plate_that_a_large_force_presses(O):
    """In a step the force alone would make the light plate faster than the grain."""
    mat, r = material(0), 0.05
    floor = [ball((x, y, 0), r, mat) for x in (-0.2, 0.2) for y in (-0.2, 0.2)]
    for k in floor:
        O.bodies[k].state.blockedDOFs = "xyzXYZ"
    plate = O.bodies[O.bodies.append(utils.box((0, 0, r + 0.02), (0.4, 0.4, 0.02), material=mat))]
    plate.state.mass, plate.state.blockedDOFs = 1, "xyXYZ"
    grain = O.bodies[ball((0.05, 0.1, 2 * r + 0.04 + 0.0105), r, mat, velocity=(0, 0, -0.3))].state
    O.forces.setPermF(plate.id, (0, 0, -400))
    O.engines, O.dt = cd_engine.engines(gravity=(0, 0, 0), tolerance=1e-10, restitution=0.8), 1e-3
    O.run(100, True)
    assert grain.vel[2] == pytest.approx(0.8 * 0.3, rel=1e-6)
