"""YADE's own tools read what the engine leaves behind."""
import numpy as np
import pytest
from yade import export, utils

from . import plane, programs
from .test_exact_solutions import loaded_box


def test_stress_of_a_loaded_box(O):
    """utils.getStress against the Love-Weber sum over the contacts, for disks whose total load is known."""
    right, top, side = loaded_box(O, n=6, mu=0)
    plane.run(20, 1e-4, tolerance=1e-11, maxIterations=100000)
    # How a rigid wall shares its load among the rows is indeterminate; each of the 7 columns of contacts (and rows) carries all of it.
    assert sum(i.phys.normalForce.norm() for i in O.interactions if i.isReal) == pytest.approx(2 * 7 * 1200.0 * side, rel=1e-8)
    stress = utils.getStress(side * side * 1.0)
    by_hand = np.zeros((3, 3))
    for i in O.interactions:
        if i.isReal:
            branch = O.bodies[i.id1].state.pos - O.bodies[i.id2].state.pos
            total = i.phys.normalForce + i.phys.shearForce
            by_hand += np.outer(list(total), list(branch)) / side**2
    assert np.array([[stress[a, b] for b in range(3)] for a in range(3)]) == pytest.approx(by_hand, rel=1e-9, abs=1e-6)
    assert stress[0, 0] < 0 and stress[1, 1] < 0  # compression, YADE's sign


def test_unbalanced_force_is_that_of_the_resultants(O):
    """At rest under gravity nothing is left over; a falling disk keeps its weight."""
    plane.columns(0, disks=1)
    plane.run(5, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-12)
    assert utils.unbalancedForce() < 1e-12
    falling = plane.disk((1, 1), 0.01, mass=2.0)
    O.run(2, True)
    assert O.forces.f(falling)[1] == pytest.approx(-2 * 9.81)
    assert utils.unbalancedForce(useMaxForce=True) == pytest.approx(2.0)


def test_forces_follow_yade_s_signs(O):
    """normalForce + shearForce act on the second body; the boundary comes first; torque balances."""
    ball = plane.disk((0, 0.1), 0.1)  # id 0, so YADE would name it first
    plane.floor()
    O.forces.setPermF(ball, (1.0, 0, 0))
    plane.run(3, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-13)
    contact, = [i for i in O.interactions if i.isReal]
    assert (contact.id1, contact.id2) == (1, 0)
    assert tuple(contact.geom.normal) == (0, 1, 0)
    assert contact.phys.normalForce[1] == pytest.approx(9.81)
    # Rolling under a force F through the centre: friction F/3 against it, for I = m r^2/2.
    assert contact.phys.shearForce[0] == pytest.approx(-1 / 3)
    assert O.forces.f(ball)[0] == pytest.approx(2 / 3)
    assert O.forces.t(ball)[2] == pytest.approx(-0.1 / 3)
    assert O.forces.f(1)[1] == pytest.approx(-9.81)


def test_only_loaded_contacts_are_real(O):
    plane.disk((0, 0), 0.1)
    plane.disk((0.2, 0), 0.1)
    cd = plane.run(2, 1e-3)
    assert O.interactions.countReal() == 0 and cd.contacts == 1 and cd.loadedContacts == 0
    O.bodies[1].state.vel = (-1, 0, 0)
    O.step()
    assert O.interactions.countReal() == 1 and cd.loadedContacts == 1
    O.run(3, True)  # e = 0: they move on together, nothing presses beyond the round-off of the velocities
    assert all(i.phys.normalForce.norm() < 1e-12 for i in O.interactions if i.isReal)


def test_vtk_export_writes_disks_and_forces(O, tmp_path):
    """By YADE's exporter in Python: VTKRecorder, built with MPI, uses an uninitialized number of processes and crashes some runs, with springs
    too."""
    loaded_box(O, n=3)
    plane.run(5, 1e-4, tolerance=1e-10)
    written = export.VTKExporter(str(tmp_path / "vtk"))
    written.exportSpheres(what={"speed": "b.state.vel.norm()"})
    written.exportInteractions(what={"force": "i.phys.normalForce.norm()"})
    forces = (tmp_path / "vtk-intrs-00000000.vtk").read_text().split("LOOKUP_TABLE default\n")[1].split()
    assert sorted(map(float, forces)) == pytest.approx(sorted(i.phys.normalForce.norm() for i in O.interactions if i.isReal), rel=1e-5)
    assert "SCALARS radius" in (tmp_path / "vtk-spheres-00000000.vtk").read_text()


def test_fixed_iterations_makes_exactly_so_many(O):
    loaded_box(O, n=4)
    cd = plane.run(3, 1e-4, fixedIterations=7, tolerance=1e-12)
    assert cd.iterations == 7 and cd.status == "fixed_iterations" and not cd.converged
    assert cd.residual > 1e-12 and cd.unconvergedSteps == 0


def test_warm_start_saves_sweeps_and_changes_no_result(O):
    sweeps = {}
    for warm in (True, False):
        O.reset()
        loaded_box(O, n=6, mu=0)
        plane.run(5, 1e-4, tolerance=1e-9, warmStart=warm, maxIterations=100000)
        sweeps[warm] = O.engines[-1].iterations
        assert sum(i.phys.normalForce.norm() for i in O.interactions if i.isReal) == pytest.approx(2 * 7 * 1200.0 * 0.12, rel=1e-6)
    assert sweeps[True] == 0 and sweeps[False] > 50


SILENT = """
import yade
from tests.plugin import plane
from tests.plugin.test_exact_solutions import loaded_box
loaded_box(yade.O, n=6)
cd = plane.run(30, 1e-4, maxIterations=2, tolerance=1e-12, warmStart=False)
print("counted", cd.unconvergedSteps, cd.steps, cd.status, cd.converged)
"""


def test_non_convergence_is_counted_and_told_once(tmp_path):
    done = programs.in_yade(tmp_path, SILENT)
    assert "counted 30 30 max_iterations False" in done.stdout
    lines = [line for line in done.stderr.splitlines() if "ContactDynamics" in line]
    assert len(lines) == 2 and "not solved" in lines[0] and "30 of 30 steps" in lines[1]


@pytest.mark.parametrize("order", [1, -1])
def test_erasing_and_adding_bodies_in_mid_run(O, order):
    """Ids change and the layer's first disk is erased; the engine follows."""
    ids = [plane.disk((0.3 * i, 0.1), 0.1) for i in range(3)]
    plane.floor()
    plane.run(3, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-12)
    O.bodies.erase(ids[::order][0])
    O.run(2, True)
    new = plane.disk((5, 0.1), 0.1, mass=3.0)
    O.run(5, True)
    assert O.interactions[3, new].phys.normalForce[1] == pytest.approx(3 * 9.81)
    assert len([i for i in O.interactions if i.isReal]) == 3
