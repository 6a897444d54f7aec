"""What DashpotWork sums, against the kinetic energy that an impact loses."""
import math

import pytest
from yade import wrapper as w

import cd_engine

from . import plane


@pytest.mark.parametrize("speed, damping", [(0.1, 0.0), (0.1, 0.1), (0.1, 0.5), (2.0, 0.1), (2.0, 0.5)])
def test_an_impact_loses_what_the_dashpot_takes(O, speed, damping):
    """Two free disks of mass m meet head-on: 1 - e^2 of m v^2/4 goes, e = exp(-pi beta/sqrt(1 - beta^2)) for the half period of eq. 5.

    At 2 m/s they overlap by a twentieth of their diameter, and YADE's dashpot is stronger than eq. 5's.
    """
    radius, stiffness = 0.01, 1e6
    plane.disk((0, 0), radius)
    plane.disk((2.0001 * radius, 0), radius)
    O.bodies[1].state.vel = (-speed, 0, 0)
    mass = O.bodies[0].state.mass
    O.engines = plane.viscous_springs(stiffness, 0.5, damping, 0.0) + [cd_engine.DashpotWork(label="dashpots"), w.NewtonIntegrator(damping=0)]
    contact = math.pi * math.sqrt(mass / 2 / stiffness / (1 - damping**2))
    O.dt = contact / 2000
    O.run(int(2e-6 / speed / O.dt) + 2300, True)
    before, after = mass * speed**2 / 2, sum(mass * body.state.vel[0]**2 / 2 for body in O.bodies)
    assert O.engines[3].work == pytest.approx(before - after, abs=2e-3 * before)  # steps of 1/2000 of the impact; half a step's speed at its start
    if not damping:
        assert O.engines[3].work == 0 and after == pytest.approx(before)
    restitution = math.exp(-math.pi * damping / math.sqrt(1 - damping**2))
    # YADE ends the contact where the spring is unloaded, not where the force is: the half period of the oscillator.
    if speed < 1:
        assert before - after == pytest.approx((1 - restitution**2) * before / 2, abs=5e-3 * before)


def test_it_survives_saving(O, tmp_path):
    O.engines = [cd_engine.DashpotWork(work=0.25)]
    O.save(str(tmp_path / "scene.yade.gz"))
    O.reset()
    O.load(str(tmp_path / "scene.yade.gz"))
    assert O.engines[0].work == 0.25


@pytest.mark.parametrize("change, words", [
    (lambda all, dashpots: [dashpots] + all, "no InteractionLoop before it.*right behind InteractionLoop"),
    (lambda all, dashpots: all + [dashpots], "NewtonIntegrator before it"),
    (lambda all, dashpots: all[:3] + [cd_engine.DashpotWork(), dashpots] + all[3:], "another one before it"),
    (lambda all, dashpots: all[:2] + [w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom()], [w.Ip2_FrictMat_FrictMat_MindlinPhys(en=0.3)],
                                                        [w.Law2_ScGeom_MindlinPhys_Mindlin()]), dashpots] + all[3:],
     "#0 and #1 has MindlinPhys"),
], ids=["no loop", "behind the integrator", "two of them", "other dashpots"])
@pytest.mark.parametrize("wait", [False, True])
def test_refused(O, change, words, wait):
    """By O.step() and, each time, by O.run(n, True), after which YADE itself sometimes loses the error."""
    plane.disk((0, 0), 0.01)
    plane.disk((0.0199, 0), 0.01)
    O.engines = change([w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb()], verletDist=1e-3),
                        w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom()], [w.Ip2_FrictMat_FrictMat_FrictPhys()],
                                          [w.Law2_ScGeom_FrictPhys_CundallStrack()]), w.NewtonIntegrator()], cd_engine.DashpotWork())
    O.dt = 1e-6
    for _ in range(20 if wait else 1):
        with pytest.raises(RuntimeError, match=words):
            O.run(1000, True) if wait else O.step()
