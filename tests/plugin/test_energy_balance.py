"""What each method counts as dissipated is what the kinetic and potential energy have lost, on every shape."""

import pytest
from yade import wrapper as w

import cd_engine

from . import plane

G, KN, KS = 9.81, 1e6, 5e5  # m/s^2, N/m
RADIUS, MASS = 0.01, 1.0
SHAPES = ("wall", "box", "disk")


def slide(O, shape, spins, mu=0.3, overlap=0.0):
    """A disk of 1 kg at 2.05 m/s on something fixed, whose top is at y = 0. Return its id."""
    mat = plane.material(mu)
    if shape == "wall":
        plane.floor(mat)
    elif shape == "box":
        plane.box((0, -0.05), (5, 0.05), mat=mat)
    else:
        plane.disk((0, -2), 2, blocked="xyzXYZ", mat=mat)
    return plane.disk((0, RADIUS - overlap), RADIUS, blocked="zXY" if spins else "zXYZ", velocity=(2.05, 0), mat=mat)


def mechanical(O, disk):
    """Its kinetic and potential energy [J]."""
    state = O.bodies[disk].state
    return 0.5 * MASS * state.vel.squaredNorm() + 0.5 * state.inertia[2] * state.angVel[2]**2 + MASS * G * state.pos[1]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("spins", [False, True], ids=["slides", "slides, then rolls"])
def test_contact_dynamics(O, shape, spins):
    """To round-off: the impulses work on the mean of the velocities before and after, and the motion is that mean."""
    disk = slide(O, shape, spins)
    before = mechanical(O, disk)
    engine = plane.run(400, 1e-3, gravity=(0, -G, 0), tolerance=1e-10)
    assert engine.dissipatedEnergy == pytest.approx(before - mechanical(O, disk), rel=1e-9) and engine.dissipatedEnergy > 0.3


@pytest.mark.parametrize("damping", [0.0, 0.2], ids=["springs", "springs and dashpots"])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("spins", [False, True], ids=["slides", "slides, then rolls"])
def test_springs(O, shape, spins, damping):
    """To first order of the step: slip and dashpots together with what the springs of the contact hold."""
    disk = slide(O, shape, spins, overlap=0.5 * MASS * G / KN)  # it swings
    O.engines = plane.viscous_springs(KN, KS / KN, damping, 0.3) + [
        cd_engine.PathIndependentShear(), cd_engine.DashpotWork(), w.NewtonIntegrator(damping=0, gravity=(0, -G, 0))]
    O.dt = 1e-5
    O.run(1, True)
    def total():
        i = next((i for i in O.interactions if i.isReal), None)
        held = i.geom.penetrationDepth**2 * KN / 2 + i.phys.shearForce.squaredNorm() / (2 * KS) if i else 0
        return mechanical(O, disk) + held + O.engines[3].frictionDissipation + O.engines[4].work
    before = total()
    O.run(40000, True)
    assert O.engines[3].frictionDissipation > 0.3
    assert (O.engines[4].work > 0) == (damping > 0)
    assert total() == pytest.approx(before, abs=2e-3 * O.engines[3].frictionDissipation)
