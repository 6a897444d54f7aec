"""O.energy, if O.trackEnergy is set."""
import math

import pytest
from yade import utils

from . import plane

G = 9.81


def drop(O, track, steps=400):
    """Let disks fall on a floor. Return the potential energy that they have lost [J]."""
    mat = plane.ground(0.3)
    disks = [plane.disk((0.0195 * (k % 4) + 0.004 * (k // 4), 0.05 + 0.03 * (k // 4)), 0.0095, mat=mat, spin=3) for k in range(12)]
    plane.engine(gravity=(0, -G, 0), tolerance=1e-8, restitution=0.3)
    O.trackEnergy = track
    height = lambda: sum(O.bodies[i].state.pos[1] for i in disks)
    before = height()
    O.run(steps, True)
    return G * (before - height())


def test_energies_go_where_yade_keeps_them(O):
    """They have YADE's names, their sum is constant, and the kinetic one equals YADE's own."""
    fallen = drop(O, True)
    energy = dict(O.energy.items())
    assert set(energy) == {"kinetic", "gravWork", "plastDissip"}
    assert energy["kinetic"] == pytest.approx(utils.kineticEnergy(), abs=1e-12)
    assert energy["gravWork"] == pytest.approx(-fallen, rel=1e-9)
    assert energy["plastDissip"] == pytest.approx(O.engines[-1].dissipatedEnergy, rel=1e-9) and energy["plastDissip"] > 0.1
    at_first = 12 * 0.5 * (0.0095**2 / 2) * 3**2  # of their spin
    assert O.energy.total() == pytest.approx(at_first, abs=1e-6 * fallen)


def test_nothing_is_kept_unless_it_is_asked_for(O):
    drop(O, False, 10)
    assert not O.energy.keys()


def test_it_may_be_asked_for_at_rest(O):
    """Steps in which nothing moves write their energies, too."""
    plane.columns(0, disks=1)
    plane.run(200, 1e-3, gravity=(0, -G, 0))
    O.trackEnergy = True
    O.run(2, True)
    assert O.energy["kinetic"] < 1e-20 and O.energy["plastDissip"] == pytest.approx(0, abs=1e-12)


def test_it_changes_no_motion(O):
    found = []
    for track in (True, False):
        O.reset()
        drop(O, track, 200)
        found.append(plane.digest())
    assert found[0] == found[1]


@pytest.mark.parametrize("faces, mu, velocity, spin, restitution, tolerance", [((165, 75), 1.0, (0, 0.3), 0, 0.9, 1e-6),
                                                                               ((90, 225, 210), 0.5, (-0.202, 0.101), 0.487, 1.0, 1e-8)])
def test_an_impact_that_is_not_solved_adds_no_energy(O, faces, mu, velocity, spin, restitution, tolerance):
    """A disk that hits two or three faces at once, where no iterations are left: it must not keep rebounds that would add 4 and 32 %. Another
    disk, far away, keeps its rebound."""
    mat = plane.material(mu)
    disk = plane.disk((0, 0), 0.1, velocity=velocity, spin=spin, mat=mat)
    for degrees in faces:
        angle = math.radians(degrees)
        plane.box((0.12 * math.cos(angle), 0.12 * math.sin(angle)), (0.02, 0.02), angle=angle, mat=mat)
    before = utils.kineticEnergy()
    plane.box((5, -0.02), (0.5, 0.02), mat=mat)
    other = plane.disk((5, 0.1), 0.1, velocity=(0, -0.2), mat=mat)
    engine = plane.run(1, 1e-5, restitution=restitution, tolerance=tolerance, handover=False)
    assert not engine.converged, "choose a harder impact"
    state = O.bodies[disk].state
    assert 0.5 * state.vel.squaredNorm() + 0.5 * state.inertia[2] * state.angVel[2]**2 <= (1 + 1e-9) * before
    assert O.bodies[other].state.vel[1] == pytest.approx(0.2 * restitution, rel=1e-5)
    assert O.bodies[disk].state.pos.norm() < 1e-4
