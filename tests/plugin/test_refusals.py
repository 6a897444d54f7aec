"""The engine refuses at the first step what it cannot do, names the body and the remedy, and leaves the scene unchanged."""
import math

import pytest
import yade
from yade import utils, wrapper

import cd_engine

from . import plane


def step(O, **settings):
    O.engines = cd_engine.engines(**settings)
    if O.dt == 1e-8 or O.dt is None:
        O.dt = 1e-3
    O.step()


@pytest.fixture
def pair(O):
    """Two disks in reach of each other; their material."""
    mat = plane.material()
    O.dt = 1e-3
    plane.disk((0, 0), 0.1, mat=mat)
    plane.disk((0.2, 0), 0.1, mat=mat)
    return mat


def change(attribute, value, body=1):
    def apply(O, mat):
        setattr(O.bodies[body].state, attribute, value)
    return apply


def append(make):
    def apply(O, mat):
        O.bodies.append(make(mat))
    return apply


def tilted_box(mat):
    return utils.box((1, 1, 0), (.1, .1, .5), orientation=yade.Quaternion((1, 0, 0), 0.5), fixed=True, material=mat)


def clump(O, mat):
    O.bodies.appendClumped([utils.sphere((1, 1, 0), 0.1, material=mat), utils.sphere((1, 1.1, 0), 0.1, material=mat)])


def flat_clump(O, mat):
    O.bodies.appendClumped([utils.sphere((1, y, 0), 0.1, material=mat) for y in (1, 1.1)])
    for body in O.bodies:
        body.state.blockedDOFs = "zXY"


def periodic(O, mat):
    """With a boundary that lies outside the cell, at which YADE's collider would end the program."""
    O.periodic = True
    O.cell.setBox(2, 2, 2)
    plane.box((0, -0.01), (1, 0.01), mat=mat)


def bad_dt(value):
    def apply(O, mat):
        O.dt = value
    return apply


def force(value):
    def apply(O, mat):
        O.forces.setPermF(1, value)
    return apply


NAN = float("nan")


def turning_wall(attribute, value):
    def apply(O, mat):
        wall = O.bodies[O.bodies.append(utils.wall(1, axis=0, material=mat))]
        wall.state.mass, wall.state.inertia = 1, (1, 1, 1)
        setattr(wall.state, attribute, value)
    return apply


@pytest.mark.parametrize("spoil, words", [
    (change("vel", (NAN, 0, 0)), ["#1", "velocity", "not a number"]),
    (change("angVel", (0, 0, NAN)), ["#1", "has an angular velocity", "not a number"]),
    (change("pos", (0, math.inf, 0)), ["#1", "position", "not a number"]),
    (change("vel", (0, 0, 1)), ["#1", "out of the x-y plane"]),
    (change("angVel", (0, 1, 0)), ["#1", "out of the x-y plane"]),
    (change("mass", 0), ["#1", "mass 0", "state.mass"]),
    (change("mass", -1), ["#1", "mass -1"]),
    (change("mass", NAN), ["#1", "mass"]),
    (change("inertia", (0, 0, 0)), ["#1", "moment of inertia 0", "state.inertia"]),
    (change("pos", (0.2, 0, 0.05)), ["#1", "z = 0.05", "one plane"]),
    (force((NAN, 0, 0)), ["#1", "force", "not a number"]),
    (append(lambda m: utils.facet([(0, 0, 0), (1, 0, 0), (0, 1, 0)], material=m, fixed=False)), ["#2", "Facet", "free to turn"]),
    (append(tilted_box), ["#2", "turned out of the plane"]),
    (append(lambda m: utils.wall(1, axis=0, material="elastic")), ["#2", "friction angle", "FrictMat"]),
    (turning_wall("angVel", (0, 0, 2)), ["#2", "wall with the angular velocity 2 rad/s", "O.bodies[2].state.angVel"]),
    (turning_wall("blockedDOFs", "yzXY"), ["#2", "wall that is free to turn", "O.bodies[2].state.blockedDOFs"]),
    (clump, ["#2", "belongs to a clump", "append its disks one by one"]),
    (flat_clump, ["#4", "is a clump"]),
    (periodic, ["periodic"]),
    (bad_dt(0), ["O.dt", "0 s"]),
    (bad_dt(NAN), ["O.dt"]),
])
def test_refused_at_the_first_step(O, pair, spoil, words):
    O.materials.append(wrapper.ElastMat(label="elastic"))
    spoil(O, pair)
    before = tuple(O.bodies[0].state.pos), tuple(O.bodies[0].state.vel)
    with pytest.raises(RuntimeError) as caught:
        step(O, gravity=(0, -1, 0))
    for word in words + ["ContactDynamics"]:
        assert word in str(caught.value)
    assert (tuple(O.bodies[0].state.pos), tuple(O.bodies[0].state.vel)) == before


def test_fixed_and_frictionless_bodies_need_no_mass(O, pair):
    """Only what is free must have a mass."""
    wall = O.bodies.append(utils.wall(-0.1, axis=1, material=pair))
    O.bodies[wall].state.mass = 0
    step(O, gravity=(0, -1, 0))
    assert O.bodies[0].state.vel[1] == 0


def test_company_that_comes_later_is_refused_when_it_comes(O, pair):
    step(O)
    O.engines = O.engines + [wrapper.NewtonIntegrator(dead=True)]
    O.run(3, True)
    O.engines[-1].dead = False
    with pytest.raises(RuntimeError, match="second time"):
        O.step()


@pytest.mark.parametrize("order", [(2, 1, 0), (1, 2, 0), (2, 0, 1), (1, 2)])
def test_a_resetter_must_come_first(O, pair, order):
    engines = cd_engine.engines()
    O.engines = [engines[k] for k in order]
    with pytest.raises(RuntimeError, match="no ForceResetter before it"):
        O.step()


def test_a_resetter_that_dies_is_noticed(O, pair):
    step(O)
    O.engines[0].dead = True
    with pytest.raises(RuntimeError, match="ForceResetter"):
        O.step()


@pytest.mark.parametrize("distance", [0, 0.1])
def test_overlaps_that_springs_cannot_have_left_are_refused(O, distance):
    O.dt = 1e-3
    plane.disk((0, 0), 0.1)
    plane.disk((distance, 0), 0.1)
    with pytest.raises(RuntimeError, match="#0 and #1 overlap"):
        step(O)


def test_the_error_of_a_run_that_has_ended_is_told_to_who_waits(O, pair):
    """YADE itself says nothing if the run has ended before somebody waits."""
    O.engines = cd_engine.engines()
    O.bodies[1].state.vel = (NAN, 0, 0)
    O.run(5)
    while O.running:
        pass
    with pytest.raises(RuntimeError, match="not a number"):
        O.wait()
    O.wait()
    with pytest.raises(RuntimeError, match="not a number"):
        O.step()
    O.wait()
