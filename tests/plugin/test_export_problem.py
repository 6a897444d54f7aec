"""exportProblem: the file holds the problem that the next step solves, nothing changes by writing it, and Siconos solves it too."""
import random

import h5py
import numpy as np
import pytest
from yade import utils

from cd_engine import core
from tests import needs

from . import plane

GRAVITY = (0, -9.81, 0)


def heap(O, rows=6, **settings):
    """A heap of unequal disks between a floor and two walls, one of which can move and is pushed; at rest on the way."""
    draw, r, mat = random.Random(3), 0.1, plane.material(0.4)
    plane.floor(mat)
    O.bodies.append(utils.wall(-r, axis=0, material=mat))
    pushed = plane.box((2 * rows * r + 0.05, 1), (0.05, 2), blocked="yzXYZ", mass=10, mat=mat)
    for j in range(rows):
        for i in range(rows):
            plane.disk(((2 * i + 0.5 * (j % 2)) * r, r + 2 * j * r), r * (1 - 0.2 * draw.random()), mass=1 + draw.random(), mat=mat)
    O.forces.setPermF(pushed, (-200, 0, 0))
    return plane.run(320, 2e-3, gravity=GRAVITY, tolerance=1e-10, **settings)


def state(O):
    """Everything the scene and the engine hold."""
    return plane.digest(), len(O.interactions), repr(plane.everything_in(O.engines[-1]))


def ids(path):
    with h5py.File(path) as file:
        return file["contact_ids"][()]


def impulses(O, path):
    """Of the last step, in the order of the file, from the forces that stand in the scene."""
    p = []
    for a, b in ids(path).tolist():
        if not O.interactions.has(a, b, True):
            p += [0, 0]
            continue
        contact = O.interactions[a, b]
        n, f, s = contact.geom.normal, contact.phys.normalForce, contact.phys.shearForce
        assert (contact.id1, contact.id2) == (a, b)
        p += [O.dt * n.dot(f), O.dt * (n[0] * s[1] - n[1] * s[0])]
    return np.array(p)


@pytest.mark.parametrize("restitution", [0, 0.3])
def test_it_is_the_problem_of_the_next_step(O, tmp_path, restitution):
    path = tmp_path / "step.hdf5"
    cd = heap(O, restitution=restitution)
    cd.exportProblem(str(path))
    problem = core.read_problem(path)
    O.run(1, True)
    assert cd.converged and problem.contacts == cd.contacts > 60
    # The engine's own solution, put into W p + q: the same error, up to the round-off of dt times force and back.
    e = core.residual(problem, impulses(O, path))
    assert e <= 2e-10
    assert core.solve(problem, tolerance=1e-10).converged
    assert abs(problem.W - problem.W.T).max() == 0


def test_bodies(O, tmp_path):
    """The same problem by its bodies, with the impulses of the last step as its first guess."""
    cd = heap(O, 5)  # whose contacts all hang together: the engine solves those that are alone by themselves
    O.bodies[-1].state.vel, cd.tolerance = (1, -1, 0), 1e-3  # so that the first guess does not solve it, and few sweeps do
    cd.exportProblem(str(tmp_path / "matrix"))
    cd.exportProblem(str(tmp_path / "bodies"), bodies=True)
    matrix, bodies = (core.read_problem(tmp_path / name) for name in ("matrix", "bodies"))
    assert np.array_equal(bodies.pairs, ids(tmp_path / "matrix"))
    assert abs(matrix.W - bodies.delassus().W).max() == 0
    assert np.array_equal(matrix.q, bodies.delassus().q) and np.array_equal(matrix.mu, bodies.mu)
    assert np.allclose(bodies.impulses, impulses(O, tmp_path / "matrix"), rtol=1e-12, atol=1e-14)
    O.run(1, True)
    # The engine and plain Python go through the same sweeps, from first guesses that differ by round-off (1e-16); what is left of the error, 1e-5,
    # may differ by ten times that: 1e-10 of itself.
    report = core.solve(bodies, cd.method, cd.tolerance, impulses=bodies.impulses)
    assert cd.islands == 1
    assert report.iterations == cd.iterations > 0 and report.residual == pytest.approx(cd.residual, rel=1e-9)


def test_nothing_changes(O, tmp_path):
    cd = heap(O)
    before = state(O)
    cd.exportProblem(str(tmp_path / "a"))
    assert state(O) == before
    O.run(20, True)
    there = state(O)[0]
    O.reset()
    heap(O)
    O.run(20, True)
    assert state(O)[0] == there


def test_before_the_first_step(O, tmp_path):
    """The problem of a scene in which nothing has run yet."""
    plane.floor()
    plane.disk((0, 0.1), 0.1, mass=2)
    plane.engine(gravity=GRAVITY)
    O.engines[-1].exportProblem(str(tmp_path / "a"))
    assert core.read_problem(tmp_path / "a").q == pytest.approx([-1e-3 * 9.81, 0]) and len(O.interactions.all(False)) == 0


def test_the_mask_of_the_collider_counts_before_the_step_too(O, tmp_path):
    for x in (0, 0.2):
        plane.disk((x, 0), 0.1)
    plane.engine()
    for mask, contacts in ((1, 0), (0, 1), (1, 0)):
        O.engines[1].avoidSelfInteractionMask = mask
        O.engines[-1].exportProblem(str(tmp_path / "a"))
        assert core.read_problem(tmp_path / "a").contacts == contacts
        O.step()
        assert O.engines[-1].contacts == contacts


@pytest.mark.parametrize("name, bodies", [("a.npz", False), ("a.hdf5", True), ("A.H5", True)])
def test_a_name_of_the_other_format_is_refused(O, tmp_path, name, bodies):
    cd = heap(O)
    with pytest.raises(ValueError, match=f"{name} would hold .* bodies={not bodies}"):
        cd.exportProblem(str(tmp_path / name), bodies)
    assert not list(tmp_path.iterdir())


def test_lasting_forces_of_some_bodies_only(O, tmp_path):
    """Bodies that came after the one with a lasting force have none."""
    plane.floor()
    plane.disk((0, 0.1), 0.1)
    O.forces.setPermF(1, (0, -5, 0))
    plane.disk((1, 0.1), 0.1, mass=2)
    cd = plane.run(1, 1e-3, gravity=GRAVITY)
    cd.exportProblem(str(tmp_path / "a"))
    q = dict(zip(map(tuple, ids(tmp_path / "a").tolist()), core.read_problem(tmp_path / "a").q[::2]))
    # 1e-12: at rest after the first step but for round-off.
    assert q == pytest.approx({(0, 1): -1e-3 * (9.81 + 5), (0, 2): -1e-3 * 9.81}, rel=1e-12)


def test_one_disk_by_hand(O, tmp_path):
    """A disk of 2 kg resting on a floor, pushed sideways: W = diag(1/m, 1/m + r^2/I) = diag(1/2, 3/2), q = (-g h, -h F/m)."""
    plane.floor(plane.material(0.25))
    disk = plane.disk((0, 0.5), 0.5, mass=2.0, mat=0)
    cd = plane.run(1, 1e-2, gravity=GRAVITY)
    O.bodies[disk].state.vel = (0, 0, 0)
    O.bodies[disk].state.angVel = (0, 0, 0)
    O.forces.setPermF(disk, (3.0, 0, 0))
    cd.exportProblem(str(tmp_path / "a"))
    problem = core.read_problem(tmp_path / "a")
    assert ids(tmp_path / "a").tolist() == [[0, 1]]
    # 1e-12: the disk may have sunk by round-off, which changes its arm.
    assert np.allclose(problem.W.toarray(), np.diag([0.5, 1.5]), rtol=1e-12, atol=1e-15)
    # t is n = (0, 1) turned by +90 degrees: (-1, 0).
    assert np.allclose(problem.q, [-9.81e-2, -1.5e-2], rtol=1e-12) and problem.mu == pytest.approx([0.25], rel=1e-14)


def test_siconos_agrees(O, tmp_path):
    """Siconos's own Gauss-Seidel solves what is exported, by our error too. The impulses of a packing with friction need not be determined, so
    they are compared by the error (here they differ by 2 %); the relative velocities are determined here, to what the tolerance allows."""
    numerics = needs.siconos()
    # Coulomb's law can have several solutions, with different velocities. The heap that sweeps alone lead to has one that both find.
    heap(O, method="accelerated").exportProblem(str(tmp_path / "a"))
    problem = core.read_problem(tmp_path / "a")
    theirs = numerics.FrictionContactProblem(2, problem.contacts, problem.W.toarray(), problem.q, problem.mu)
    options = numerics.SolverOptions(numerics.SICONOS_FRICTION_2D_NSGS)
    options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = 20000
    # A tenth of what is asked below; it stops gaining at 2e-10. The velocities' difference follows it: 3e-9 m/s here, 3e-8 at 1e-8.
    options.dparam[numerics.SICONOS_DPARAM_TOL] = 1e-9
    p, u = np.zeros(2 * problem.contacts), np.zeros(2 * problem.contacts)
    assert numerics.fc2d_driver(theirs, p, u, options) == 0
    # Their error is relative to q, ours to p and taken contact by contact in units of 1/W_nn: of one order, and ours smaller here.
    assert core.residual(problem, p) < 1e-8
    ours = core.solve(problem, tolerance=1e-10)
    assert ours.converged
    # Velocities: those of their solution and of ours, on the scale of what gravity gives in a step.
    assert np.abs(problem.velocities(p) - problem.velocities(ours.impulses)).max() < 1e-6 * 9.81 * O.dt


def test_in_space(O, tmp_path):
    """Spheres in a box of walls and on a facet that turns: matrix and bodies hold one problem, and the engine's next step solves it."""
    draw, mat = random.Random(5), plane.material(0.4)
    for axis, at in (2, 0), (0, 0), (1, 0), (0, 0.8), (1, 0.8):
        O.bodies.append(utils.wall(at, axis=axis, material=mat))
    disc = utils.facet(((-2, -2, 0.001), (2, -2, 0.001), (0, 3, 0.001)), material=mat)
    disc.state.angVel = (0, 0, 1)
    O.bodies.append(disc)
    for k in range(60):
        at = [0.13 + 0.17 * (k // 4**j % 4) + draw.uniform(-0.01, 0.01) for j in range(3)]
        O.bodies.append(utils.sphere(at, draw.uniform(0.06, 0.08), material=mat))
    cd = plane.run(300, 2e-3, gravity=(0, 0, -9.81), tolerance=1e-6)
    assert cd.inSpace
    cd.exportProblem(str(tmp_path / "matrix"))
    cd.exportProblem(str(tmp_path / "bodies"), bodies=True)
    matrix, bodies = (core.read_problem(tmp_path / name) for name in ("matrix", "bodies"))
    assert abs(matrix.W - bodies.delassus().W).max() == 0 and np.array_equal(matrix.q, bodies.delassus().q)
    assert np.abs(bodies.free_velocities[len(O.bodies):, :3]).max() > 0.1  # points of the facet
    O.run(1, True)
    assert cd.converged and matrix.contacts == cd.contacts > 100
    report = core.solve(bodies, cd.method, cd.tolerance, impulses=bodies.impulses)
    assert report.converged and core.residual(matrix, report.impulses) <= 1.001e-6
