"""A scene in x-z or y-z is told by the blocked freedoms and moves as its twin in x-y, to the last bit."""
import math
import random

import pytest
import yade
from yade import Quaternion, Vector3, utils, wrapper as w

import cd_engine

from . import plane

# Of each plane: the axes of space that take the place of x, y and z, and the sign of the rotation from the first to the second.
PLANES = {"x-y": (0, 1, 2, 1), "x-z": (0, 2, 1, -1), "y-z": (1, 2, 0, 1)}


def in_space(vector, name):
    """Return a vector of the scene in x-y as it stands in another plane."""
    found = [0, 0, 0]
    for axis, value in zip(PLANES[name], vector):
        found[axis] = value
    return Vector3(found)


def in_plane(vector, name):
    """Return (along x, along y, out of the plane) of a vector in the plane of this name."""
    return [vector[axis] for axis in PLANES[name][:3]]


def turned(q, name):
    """Return a rotation of the scene in x-y as it is in another plane."""
    sign = PLANES[name][3]
    return Quaternion(q[3], *(sign * x for x in in_space((q[0], q[1], q[2]), name)))


def move_to(O, name):
    """Bring the scene in x-y, as it was built, to another plane."""
    *axes, sign = PLANES[name]
    for body in O.bodies:
        state, shape = body.state, body.shape
        state.blockedDOFs = "".join(letter for letter in "xyzXYZ" if any(
            letter == ("xyz"[axis] if old.islower() else "XYZ"[axis]) for old in state.blockedDOFs for axis in [axes["xyz".index(old.lower())]]))
        state.pos, state.vel, state.inertia = (in_space(v, name) for v in (state.pos, state.vel, state.inertia))
        state.angVel, state.ori = sign * in_space(state.angVel, name), turned(state.ori, name)
        if isinstance(shape, w.Box):
            shape.extents = in_space(shape.extents, name)
        if isinstance(shape, w.Wall):
            shape.axis = axes[shape.axis]


def motion(O, name):
    """Return all that a step leaves, as seen in the plane."""
    sign, found = PLANES[name][3], []
    for b in O.bodies:
        found += in_plane(b.state.pos, name) + in_plane(b.state.vel, name) + [sign * x for x in in_plane(b.state.angVel, name)]
        found += [sign * x for x in in_plane([b.state.ori[k] for k in range(3)], name)] + [b.state.ori[3]]
        found += in_plane(O.forces.f(b.id), name) + [sign * x for x in in_plane(O.forces.t(b.id), name)]
    for i in sorted((i for i in O.interactions if i.isReal), key=lambda i: (i.id1, i.id2)):
        found += [i.id1, i.id2, i.geom.penetrationDepth]
        found += sum((in_plane(v, name) for v in (i.geom.normal, i.geom.contactPoint, i.phys.normalForce, i.phys.shearForce)), [])
    return found


def mill(O):
    """Disks of mixed sizes between a wall, a slope, a turning box and a lid that follows its weight; one disk has an orientation in space."""
    mat = plane.material(0.4)
    O.bodies.append(utils.wall(0, axis=1, sense=1, material=mat))
    plane.box((-0.12, 0.2), (0.01, 0.3), angle=0.1, mat=mat)
    plane.box((0.14, 0.2), (0.02, 0.25), mat=mat)
    O.bodies[plane.box((0.02, 0.03), (0.03, 0.01), angle=0.3, mat=mat)].state.angVel = (0, 0, 2)
    lid = plane.box((0, 0.5), (0.5, 0.01), blocked="xzXYZ", mass=3, mat=mat)
    draw = random.Random(2).uniform
    for k in range(40):
        plane.disk((-0.08 + 0.035 * (k % 6) + draw(-2e-3, 2e-3), 0.09 + 0.035 * (k // 6)), draw(0.01, 0.016), spin=draw(-9, 9), mat=mat,
                   velocity=(draw(-1, 1), 0))
    O.bodies[-1].state.ori = Quaternion((1, 2, 3), 1.1)
    return lid


@pytest.mark.parametrize("settings", [{}, {"restitution": 0.5}, {"gapCorrection": 0.1, "publish": "always"}])
def test_the_same_bits_in_every_plane(O, settings):
    found = {}
    for name in PLANES:
        O.reset()
        lid = mill(O)
        move_to(O, name)
        cd = plane.engine(5e-4, gravity=in_space((0.3, -9.81, 0), name), **settings)
        O.trackEnergy = True
        O.forces.setPermF(lid, in_space((0, -4, 0), name))
        O.run(400, True)
        found[name] = motion(O, name) + [O.energy["kinetic"], O.energy["gravWork"], O.energy["plastDissip"], cd.dissipatedEnergy, cd.contacts]
    assert found["x-z"] == found["x-y"] and found["y-z"] == found["x-y"]
    assert cd.contacts > 20


@pytest.mark.parametrize("name", PLANES)
def test_a_slope_under_gravity_along_z(O, name):
    """A disk rolls down a slope along the first axis with 2/3 g sin(a), so it turns from the second axis to the first."""
    mat, angle, g = plane.material(0.5), 0.3, 9.81
    plane.box((0, -0.01), (2, 0.01), angle=-angle, mat=mat)
    up = (math.sin(angle), math.cos(angle))
    plane.disk((0.11 * up[0], 0.11 * up[1] - 0.01), 0.1, mat=mat)
    move_to(O, name)
    plane.engine(1e-3, gravity=in_space((0, -g, 0), name))
    O.run(500, True)
    speed, (_, _, spin) = O.bodies[1].state.vel.norm(), in_plane(O.bodies[1].state.angVel, name)
    assert speed == pytest.approx(2 / 3 * g * math.sin(angle) * 0.5, rel=1e-6)
    assert PLANES[name][3] * spin == pytest.approx(-speed / 0.1, rel=1e-6) and in_plane(O.bodies[1].state.vel, name)[0] > 0


@pytest.mark.parametrize("name", PLANES)
def test_springs_and_back(O, name):
    """Path-independent springs in each plane, then rigid grains that take over, then springs again: the same bits as in x-y."""
    found = {}
    for each in ("x-y", name):
        O.reset()
        mat = plane.material(0.4)
        O.materials[mat].young = 1e8
        plane.box((0, -0.01), (0.2, 0.01), mat=mat)
        plane.column(disks=3, mat=mat, spin=4.0)
        plane.column(x=0.01999, disks=3, y=0.0099, mat=mat)
        move_to(O, each)
        gravity = in_space((0, -9.81, 0), each)

        def springs():
            shear = cd_engine.PathIndependentShear()
            O.engines = [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb()]),
                         w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(), w.Ig2_Box_Sphere_ScGeom()], [w.Ip2_FrictMat_FrictMat_FrictPhys()],
                                           [w.Law2_ScGeom_FrictPhys_CundallStrack()]), shear, w.NewtonIntegrator(damping=0.3, gravity=gravity)]
            O.dt = 2e-5
            O.run(300, True)
            return shear
        shear = springs()
        found[each] = motion(O, each) + [shear.frictionDissipation, shear.contacts]
        assert shear.contacts > 2
        plane.run(50, 1e-3, gravity=gravity)
        found[each] += motion(O, each)
        cd_engine.release()
        springs()
        found[each] += motion(O, each)
    assert found[name] == found["x-y"]


def test_pictures_films_and_the_watch(O, tmp_path):
    for name in ("x-z", "y-z"):
        O.reset()
        mill(O)
        move_to(O, name)
        plane.engine(5e-4, gravity=in_space((0, -9.81, 0), name))
        O.engines = O.engines + [cd_engine.film(str(tmp_path / f"{name}.gif"), every=0.02), cd_engine.watch()]
        O.dt = cd_engine.timeStep()
        O.run(100, True)
        cd_engine.picture(str(tmp_path / f"{name}.png"))
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000 and (tmp_path / f"{name}.gif").stat().st_size > 10_000


def spoil_place(O):
    O.bodies[-1].state.pos += Vector3(0, 0.1, 0)


def spoil_spin(O):
    O.bodies[-1].state.angVel = (1, 0, 0)


def spoil_box(O):
    O.bodies[1].state.ori = Quaternion((0, 0, 1), 0.2)


@pytest.mark.parametrize("spoil, words", [
    (spoil_place, "body #44 has y = 0.1 m but body #5 has y = 0 m"), (spoil_spin, "body #44 moves out of the x-z plane.*x and z angular velocities"),
    (spoil_box, "body #1 is a box turned out of the plane.*about y only")])
def test_what_contradicts_the_plane_is_refused(O, spoil, words):
    mill(O)
    move_to(O, "x-z")
    spoil(O)
    plane.engine(gravity=(0, 0, -9.81))
    with pytest.raises(RuntimeError, match=words):
        O.step()


def test_gravity_out_of_the_plane_is_refused(O):
    plane.disk((0, 0), 0.01)
    plane.engine(gravity=(0, 0, -9.81))
    with pytest.raises(RuntimeError, match=r"gravity = \(0, 0, -9.81\) m/s\^2 points out of the x-y plane.*'yXZ' in x-z"):
        O.step()


def test_a_scene_may_move_to_another_plane(O):
    """Between two steps, all of it: what was known of the other plane is forgotten."""
    plane.disk((0, 0), 0.01, velocity=(0, 1))
    cd = plane.engine()
    O.run(10, True)
    move_to(O, "x-z")
    O.run(10, True)
    assert [*O.bodies[0].state.pos] == pytest.approx([0, 0, 0.02]) and cd.steps == 20


def test_an_undecided_lid_leaves_the_choice_to_the_disks(O):
    """What moves along z only may be part of x-z or of y-z; fixed bodies fit everywhere."""
    mat = plane.ground()
    plane.box((0, 0.03), (0.1, 0.01), blocked="xzXYZ", mat=mat)
    plane.disk((0, 0.01), 0.01, mat=mat)
    move_to(O, "y-z")
    cd = plane.engine(gravity=(0, 0, -9.81))
    O.run(10, True)
    assert cd.contacts == 2 and yade.utils.unbalancedForce() < 1e-6
