"""Contacts with a stiffness: what YADE's own springs have, and the way from springs to implicit springs and back."""
import math

import numpy as np
import pytest
import yade
from yade import utils, wrapper as w

from cd_engine import core

from . import plane

G = (0, -9.81, 0)


def contacts():
    return {(i.id1, i.id2): i for i in yade.O.interactions if i.isReal}


def springs_of(found):
    """kn, ks, overlap, and the components of the force, of each contact."""
    return {pair: (i.phys.kn, i.phys.ks, i.geom.penetrationDepth, *i.phys.normalForce, *i.phys.shearForce) for pair, i in found.items()}


def heap(O, steps=6000):
    """Disks of two materials on a floor and between walls, at rest on YADE's springs. Return what their springs hold."""
    mats = [O.materials.append(w.FrictMat(young=young, poisson=poisson, frictionAngle=0.4)) for young, poisson in ((1e6, 0.3), (3e6, 0.2))]
    plane.floor(mats[1])
    for x in (-0.0105, 0.0905):
        O.bodies.append(utils.wall(x, axis=0, material=mats[0]))
    for k in range(20):
        plane.disk((0.02 * (k % 5) + 0.002 * (k // 5 % 2), 0.0099 + 0.019 * (k // 5)), 0.0098 + 2e-5 * (k % 7), mass=0.1, mat=mats[k % 2])
    O.engines, O.dt = plane.springs(damping=0.4), 1e-5
    O.run(20000 + steps, True)
    O.engines[-1].damping = 0.9
    O.run(20000, True)
    return springs_of(contacts())


def close(a, b, relative, of=slice(None)):
    assert a.keys() == b.keys()
    x, y = (np.array([values[of] for _, values in sorted(found.items())]) for found in (a, b))
    assert np.abs(x - y).max() <= relative * np.abs(y).max()


def test_hand_over_and_back(O):
    before = heap(O)
    for body in O.bodies:
        body.state.vel = body.state.angVel = (0, 0, 0)
    O.dt = 1e-9
    O.run(1, True)  # so that overlaps and forces belong together to the last digits
    before = springs_of(contacts())
    integrator = O.engines
    plane.engine(1e-9, gravity=G, materialStiffness=True)
    O.run(1, True)
    after = springs_of(contacts())
    close(after, before, 1e-15, slice(0, 2))
    close(after, before, 1e-10, slice(2, 3))
    close(after, before, 1e-9, slice(3, None))
    O.dt = 1e-3
    O.run(200, True)
    cd = O.engines[-1]
    assert cd.converged and cd.unconvergedSteps == 0
    held = springs_of(contacts())
    for body in O.bodies:
        body.state.vel = body.state.angVel = (0, 0, 0)
    O.engines, O.dt = integrator, 1e-9
    O.run(1, True)
    back = springs_of(contacts())
    close(back, held, 1e-9)


def test_rigid_steps_between_steps_of_springs(O):
    """The overlaps that rigid contacts count as touching belong to the springs again, and those of implicit springs count as touching, too."""
    before = heap(O)
    overlap = max(values[2] for values in before.values())
    cd = plane.run(50, 1e-3, gravity=G, tolerance=1e-8)
    assert cd.handoverOverlap == pytest.approx(overlap, rel=1e-3) and cd.storedEnergy == 0
    cd.materialStiffness, cd.tolerance = True, 0.1
    O.run(1, True)
    after = springs_of(contacts())
    close(after, before, 0.05, slice(2, 3))  # friction of rigid contacts is not unique, so that this step moves the disks a little
    assert cd.storedEnergy > 0
    for kn, _, depth, *force in after.values():
        assert np.hypot(*force[:2]) == pytest.approx(kn * depth, rel=1e-3, abs=1e-3)
    O.run(200, True)
    held = springs_of(contacts())
    cd.materialStiffness, cd.tolerance, cd.gapCorrection = False, 1e-8, 0.2
    O.run(50, True)
    assert cd.handoverOverlap == pytest.approx(max(values[2] for values in held.values()), rel=1e-3)
    assert cd.maxPenetration < 1e-3 * overlap and cd.unconvergedSteps == 0
    close(springs_of(contacts()), held, 1e-3, slice(2, 3))


def test_free_flight_is_backward_euler_whatever_is_near(O):
    steps, h = 50, 1e-3
    for margin in (0.1, 10):
        O.reset()
        plane.ground()
        disk = plane.disk((0, 0.05), 0.01)
        plane.run(steps, h, gravity=G, stiffness=1e5, tangentialStiffness=1e5, searchMargin=margin)
        assert O.bodies[disk].state.pos[1] == pytest.approx(0.05 - 9.81 * h**2 * steps * (steps + 1) / 2, rel=1e-12)


def test_a_heavy_disk_at_rest_on_a_light_one(O):
    """The tolerance stays above the round-off of the impulses, which is an error of the light disk: masses 1 and 1e6."""
    cd = plane.two_on_a_floor(1e6, 1000, stiffness=1e11, tangentialStiffness=1e11, dampingRatio=0.2)
    assert cd.sleeping == 1 and cd.unconvergedSteps == 0
    assert contacts()[0, 1].phys.normalForce[1] == pytest.approx(9.81 * (1e6 + 1), rel=1e-6)
    cd.tolerance = 1e-3  # what sleeps has been proven to another one
    O.run(10, True)
    assert cd.sleeping == 1 and cd.unconvergedSteps == 0


def test_energies(O):
    mat = plane.ground(0.3)
    for k in range(12):
        plane.disk((0.0195 * (k % 4) + 0.004 * (k // 4), 0.05 + 0.03 * (k // 4)), 0.0095, mat=mat, spin=3)
    cd = plane.engine(gravity=G, stiffness=1e5, tangentialStiffness=5e4, dampingRatio=0.1)
    O.trackEnergy = True
    begin = plane.kinetic_energy()
    O.run(400, True)
    energy = dict(O.energy.items())
    assert set(energy) == {"kinetic", "gravWork", "plastDissip", "elastPotential", "viscDissip", "numDissip"}
    assert all(energy[name] > 0 for name in ("plastDissip", "elastPotential", "viscDissip", "numDissip"))
    assert energy["elastPotential"] == pytest.approx(cd.storedEnergy)
    assert O.energy.total() == pytest.approx(begin, abs=1e-6 * abs(energy["gravWork"]))


def test_the_damping_of_the_scheme_falls_with_the_step(O):
    """Its sum takes what no other energy accounts for, so an error of theirs would stay in it."""
    damped = []
    for h in (1e-4, 1e-5):
        O.reset()
        mat = plane.ground(0.5)
        for x in (0, 0.2):
            O.bodies.append(utils.wall(x, axis=0, material=mat))
        for k in range(8):
            plane.disk((0.03 + 0.045 * (k % 4), 0.03 + 0.04 * (k // 4)), 0.013, velocity=((-1)**k, k % 3 - 1), spin=7 * k, mat=mat)
        cd = plane.run(round(0.2 / h), h, gravity=G, stiffness=1e4, tangentialStiffness=5e3, tolerance=1e-3)
        damped.append(cd.dampedEnergy)
        assert cd.dissipatedEnergy > 0.1
    assert 0 < damped[1] < 0.02 * cd.dissipatedEnergy + 0.01 and 7 < damped[0] / damped[1] < 14


def test_a_pile_sleeps_with_its_energy_and_goes_on_after_a_save(O, tmp_path):
    plane.columns(0, 0.05, disks=3)
    cd = plane.run(3000, 1e-3, gravity=G, stiffness=1e6, tangentialStiffness=5e5)
    plane.goes_on(tmp_path / "a.xml", 50)
    cd = O.engines[-1]
    O.run(3000, True)
    cd = O.engines[-1]
    weights = [9.81 * k for k in (3, 2, 1)]
    assert cd.sleeping == cd.islands == 2 and cd.unconvergedSteps == 0
    assert cd.storedEnergy == pytest.approx(2 * sum(f**2 for f in weights) / 2e6, rel=1e-6)


def test_exported_problem_has_the_compliance(O, tmp_path):
    mat = plane.ground(0.4)
    plane.hollows(4, 5, mat)
    for x in (0, 0.1):
        O.bodies.append(utils.wall(x, axis=0, material=mat))
    cd = plane.run(30, 1e-3, gravity=G, stiffness=2e5, tangentialStiffness=1e5, tolerance=1e-6)
    path, bodies = tmp_path / "step.hdf5", tmp_path / "step.npz"
    cd.exportProblem(str(path))
    cd.exportProblem(str(bodies), bodies=True)
    problem = core.read_problem(path)
    O.run(1, True)
    forces = contacts()
    for given in (problem, core.read_problem(bodies)):
        report = core.solve(given, tolerance=1e-12)
        assert report.converged
        for k, pair in enumerate(core.read_problem(bodies).pairs.tolist()):
            force = forces[tuple(pair)].phys.normalForce.norm() if tuple(pair) in forces else 0
            assert report.impulses[2 * k] / 1e-3 == pytest.approx(force, rel=1e-5, abs=1e-5)


def test_a_press_that_rigid_grains_cannot_solve(O):
    mat = plane.ground(0.5)
    plane.hollows(5, 6, mat)
    for x in (0, 0.12):
        O.bodies.append(utils.wall(x, axis=0, material=mat))
    lid = O.bodies.append(utils.wall(0.01 * (2 + 4 * math.sqrt(3)), axis=1, material=mat))
    O.bodies[lid].state.vel = (0, -1e-3, 0)
    cd = plane.run(100, 1e-3, stiffness=2e6, tangentialStiffness=1e6)
    assert cd.unconvergedSteps == 0 and cd.status == "converged" and cd.totalIterations < 100 * 100
    assert O.forces.f(lid)[1] > 1e2


@pytest.mark.parametrize("settings, says", [
    (dict(tangentialStiffness=1e3), "needs a stiffness"), (dict(dampingRatio=0.1), "needs a stiffness"),
    (dict(stiffness=1e4, restitution=0.5), "dampingRatio"), (dict(stiffness=1e4, gapCorrection=0.1), "gapCorrection"),
    (dict(stiffness=1e4, materialStiffness=True), "materialStiffness"), (dict(materialStiffness=True), "young"),
    (dict(stiffness=1e-320), "k_n = "), (dict(stiffness=1e4, tangentialStiffness=1e-320), "k_t = ")])
def test_refused(O, settings, says):
    plane.disk_on_a_floor(**settings)
    if says == "young":
        O.bodies[1].mat = w.FrictMat(young=0, frictionAngle=0.1)
    with pytest.raises(RuntimeError, match=says):
        O.step()
    with pytest.raises(ValueError):
        O.engines[-1].stiffness = 0


def test_the_bits_of_rigid_contacts_do_not_depend_on_a_stiffness_before(O):
    def run(stiffness):
        O.reset()
        plane.columns(0, 0.05, disks=3)
        cd = plane.engine(gravity=G, stiffness=stiffness, tolerance=1e-6)
        cd.stiffness = math.inf
        O.run(30, True)
        return plane.digest()

    assert run(1e4) == run(math.inf)
