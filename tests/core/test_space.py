"""Contact problems in space: files, the error, the law of one contact, and solutions of random scenes, all against formulas of their own."""
import ctypes
from dataclasses import replace

import h5py
import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import linprog

from cd_engine import core
from cd_engine.core.files.space_bodies import tangents
from tests import needs
from yade_scripts.measuring.benchmark import space_scenes


def error_of(problem, impulses):
    """e by its definition."""
    p, u = (x.reshape(-1, 3) for x in (impulses, problem.W @ impulses + problem.q))
    wnn, mu = problem.W.diagonal()[::3, None], problem.mu
    z = p - u / wnn
    z[:, 0] -= mu * np.hypot(u[:, 1], u[:, 2]) / wnn[:, 0]
    length = np.hypot(z[:, 1], z[:, 2])
    along = (z[:, 0] + mu * length) / (1 + mu**2)
    nearest = np.column_stack([along, z[:, 1:] * (mu * along / np.maximum(length, 1e-300))[:, None]])
    nearest[mu * length <= -z[:, 0]] = 0
    inside = length <= mu * z[:, 0]
    nearest[inside] = z[inside]
    return np.linalg.norm(p - nearest) / np.linalg.norm(p)


def alone(W, q, mu):
    """Return the impulses of one contact that a single sweep finds."""
    return core.solve(core.Problem(W, q, [mu], 3), "nsgs", fixed_iterations=1).impulses


def all_solutions(W, q, mu):
    """All solutions of one contact that closes: sticking, and the roots of a quartic found by NumPy. The last one slides fastest for its friction."""
    found = []
    stuck = -np.linalg.solve(W, q)
    if stuck[0] >= 0 and np.hypot(*stuck[1:]) <= mu * stuck[0]:
        found.append(stuck)
    # p (s) = -adj(W + s T) q / det(W + s T), each entry a polynomial in s, from its values at five points.
    s = np.linspace(0, 4, 5) * W.max()
    T = np.diag([0.0, 1, 1])
    values = [-np.linalg.det(W + x * T) * np.linalg.solve(W + x * T + 0 * T, q) for x in s]
    n, t1, t2 = (np.polynomial.Polynomial.fit(s, np.array(values)[:, k], 2) for k in range(3))
    roots = (t1**2 + t2**2 - mu**2 * n**2).roots()
    for x in sorted(roots[np.abs(roots.imag) < 1e-7 * np.abs(roots)].real):
        if x > 0 and (p := -np.linalg.solve(W + x * T, q))[0] > 0:
            found.append(p)
    return found


def random_block(draw, coupling):
    A = draw.normal(0, 1, (3, 3)) * [1, coupling, coupling]
    W = A @ A.T + 0.05 * np.eye(3)
    return W + 0.02 * draw.normal(0, 1, (3, 3)) * (draw.uniform() < 0.3)


@pytest.mark.parametrize("coupling", [1, 3, 10])
def test_one_contact_against_enumeration(coupling):
    draw = np.random.default_rng(coupling)
    several = 0
    for _ in range(300):
        W, q, mu = random_block(draw, coupling), draw.normal(0, 1, 3), draw.choice([0.1, 0.5, 1.0, 3.0])
        q[0] = -abs(q[0])
        if np.linalg.eigvalsh(W + W.T)[0] <= 1e-3:
            continue
        p = alone(W, q, mu)
        known = all_solutions(W, q, mu)
        several += len(known) > 1
        stuck = bool(known) and np.allclose(W @ known[0] + q, 0, atol=1e-9)
        assert np.allclose(p, known[0 if stuck else -1], rtol=1e-6, atol=1e-8 * np.abs(known).max()), (W, q, mu, p, known)
    assert several > 0 or coupling == 1


def test_one_contact_by_bisection():
    """Spheres: the closed form is that of sliding with a factor s on the friction."""
    W, mu, q = np.diag([2.0, 7, 7]), 0.4, np.array([-1.0, 3, -4])
    low, high = 0.0, 1e3
    for _ in range(100):
        s = 0.5 * (low + high)
        p = -np.linalg.solve(W + s * np.diag([0, 1, 1]), q)
        low, high = (s, high) if np.hypot(*p[1:]) > mu * p[0] else (low, s)
    assert np.allclose(alone(W, q, mu), p, rtol=1e-12)


def test_open_frictionless_and_stuck():
    W = np.array([[2, 0.3, 0.1], [0.3, 3, 0.2], [0.1, 0.2, 4]])
    assert np.array_equal(alone(W, [0.1, 5, 5], 0.5), [0, 0, 0])
    assert np.array_equal(alone(W, [-1, 5, 5], 0), [0.5, 0, 0])
    assert np.allclose(W @ alone(W, [-1, 0.1, 0.1], 0.5), [1, -0.1, -0.1])


def test_residual_is_its_definition():
    draw = np.random.default_rng(1)
    problem = space_scenes.scene("boxes", 10, 0.5, 1).delassus()
    problem.mu[::3] = 0
    for _ in range(5):
        p = draw.normal(0, 1, len(problem.q))
        p[:30] = 0
        assert core.residual(problem, p) == pytest.approx(error_of(problem, p), rel=1e-9)
    open_ = core.Problem(problem.W, np.ones(len(problem.q)), problem.mu)
    assert core.residual(open_, np.zeros(len(problem.q))) == 0
    assert core.residual(problem, np.zeros(len(problem.q))) == np.inf


@pytest.mark.parametrize("kind, bodies, mu, ratio, skew", [
    *((kind, bodies, mu, 1, 0) for kind in space_scenes.POINTS for bodies in (5, 40) for mu in (0, 0.1, 0.5)),
    *(("spheres", 40, mu, ratio, 0) for mu in (0.3, 0.8, 1.5) for ratio in (1e3, 1e6)),
    *((kind, 20, mu, 1e3, 1e-3) for kind in ("capsules", "boxes") for mu in (0.1, 0.5))])
def test_random_scenes(kind, bodies, mu, ratio, skew):
    problem = space_scenes.scene(kind, bodies, mu, bodies, ratio).delassus()
    if skew:
        problem = space_scenes.skewed(problem, skew, 1)
    report = core.solve(problem)
    assert report.converged and error_of(problem, report.impulses) <= 1.001e-8


@pytest.mark.parametrize("method", ["nsgs", "accelerated"])
def test_spheres_are_swept_over_their_bodies(method):
    """With one thread or several and every instruction set the same bits, whose error is that of the matrix."""
    bodies = space_scenes.scene("spheres", 900, 0.4, 1)
    assert bodies.contacts > 2000 and bodies.spheres() is not None
    problem, found = bodies.delassus(), set()
    try:
        for name in core.instruction_sets():
            core.use_instruction_set(name)
            for threads in (1, 2, 3):
                report = core.solve(bodies, method, 1e-6, threads=threads)
                assert report.converged and error_of(problem, report.impulses) <= 1.001e-6
                found.add(report.impulses.tobytes())
    finally:
        core.use_instruction_set(core.instruction_sets()[0])
    assert len(found) == 1


def test_bodies_and_rows_have_one_solution():
    """Spheres in a row, and a loaded wall that moves along its normal only."""
    n, draw = 6, np.random.default_rng(2)
    free = draw.normal(0, 1, (n, 6))
    free[0], free[-1] = 0, [0, 0, -3, 0, 0, 0]
    inverse = np.vstack([[0, 0, 0], draw.uniform(1, 3, (n - 2, 1)) * [1, 1, 1], [0, 0, 0.5]])
    pairs = np.stack([np.arange(n - 1), np.arange(1, n)], axis=1)
    arms = np.array([[0, 0, 1, 0, 0, -1]] * (n - 1)) * np.repeat((pairs > 0) & (pairs < n - 1), 3, axis=1)
    bodies = core.SpaceBodyProblem(inverse, 2.5 * inverse[:, 0], free, pairs, [[0, 0, 1]] * (n - 1), arms, np.full(n - 1, 0.1), np.full(n - 1, 0.3))
    assert bodies.spheres() is not None
    ours, rows = (core.solve(p, "nsgs", 1e-13).impulses for p in (bodies, bodies.delassus()))
    assert np.allclose(ours, rows, rtol=1e-9, atol=1e-11)
    assert core.solve(bodies, impulses=ours, tolerance=1e-9).iterations == 0


@pytest.mark.parametrize("change", [
    dict(arms=lambda x: x + 0.1), dict(inverse_inertias=lambda x: x * np.array([1, 1, 1.1])[:, None] * np.eye(3)), dict(bias=lambda x: x - 2),
    dict(compliances=lambda x: x + [0, 1]), dict(inverse_masses=lambda x: x * [1, 1, 1.1])])
def test_what_is_not_for_sweeps_over_spheres(change):
    right = space_scenes.scene("spheres", 5, 0.5, 1)
    fields = vars(right) | {name: change(vars(right)[name]) for name, change in change.items()}
    assert right.spheres() is not None and core.SpaceBodyProblem(**fields).spheres() is None


def test_bodies_and_their_matrix_agree():
    bodies = space_scenes.scene("capsules", 8, 0.3, 2)
    bodies.compliances[:, 0], bodies.compliances[:, 1] = 0.1, 0.2
    problem, p = bodies.delassus(), np.random.default_rng(1).normal(0, 1, 3 * bodies.contacts)
    assert np.allclose(bodies.velocities(p), problem.velocities(p), rtol=1e-12)
    assert abs(problem.W - problem.W.T).max() == 0 and np.linalg.eigvalsh(problem.W.toarray())[0] > 0.09
    report = core.solve(bodies)
    assert report.converged and error_of(problem, report.impulses) < 1e-8


def sprung(problem, kh2):
    """The problem with springs at all contacts: k h^2 times W_nn is `kh2`, of both springs; their forces before the step differ."""
    C = np.repeat(problem._own()[:, :1] / kh2, 2, axis=1)
    draw = np.random.default_rng(1)
    return replace(problem, compliances=C, slip_bias=draw.normal(0, 0.1, C.shape), bias=problem.bias - draw.uniform(0, 0.2, len(C)))


@pytest.mark.parametrize("kind, mu", [("spheres", 0.3), ("boxes", 0.8), ("capsules", 1.5)])
@pytest.mark.parametrize("kh2", [0.1, 1.0, 100.0])
def test_springs_at_contacts(kind, mu, kh2):
    """Sweeps over spheres and over rows find the same impulses, since W + C has one solution where the springs are soft."""
    problem = sprung(space_scenes.scene(kind, 40, mu, 2, 1e3), kh2)
    assert (problem.spheres() is not None) == (kind == "spheres")
    over_bodies, over_rows = core.solve(problem), core.solve(problem.delassus())
    for report in (over_bodies, over_rows):
        assert report.converged and error_of(problem.delassus(), report.impulses) <= 1.001e-8
    if kh2 <= 1:
        assert np.allclose(over_bodies.impulses, over_rows.impulses, atol=1e-6 * np.abs(over_rows.impulses).max())


def test_a_sphere_on_a_spring():
    """Pressed into a floor and pushed aside, by hand: p = -h k (g + h u_n) and the friction of its spring, or mu p."""
    h, k, kt, m, g, push, before = 1e-2, 3e4, 2e4, 2.0, -1e-3, 4.0, 5.0
    for mu, slides in ((10.0, False), (0.05, True)):
        normal = np.array([0.36, 0.48, 0.8])
        t = tangents(normal[None])[0][0]
        problem = core.SpaceBodyProblem([[0, 0, 0], [1 / m] * 3], [0, 0], [[0] * 6, [*(push * h / m * t), 0, 0, 0]], [[0, 1]], [normal], [[0] * 6],
                                        [g / h], [mu], [[1 / (k * h * h), 1 / (kt * h * h)]], [[before / (kt * h), 0]])
        p = core.solve(problem, tolerance=1e-13).impulses
        u = np.array([p[0] / m, push * h / m + p[1] / m, p[2] / m])
        assert p[0] == pytest.approx(-h * k * (g + h * u[0]), rel=1e-12)
        assert p[1] == pytest.approx(-mu * p[0] if slides else -h * before - kt * h * h * u[1], rel=1e-12) and abs(p[2]) < 1e-12


@pytest.mark.parametrize("wrong, words", [
    (dict(normals=lambda x: 2 * x), r"normals\[0\] has the length 2"),
    (dict(inverse_inertias=lambda x: x + np.triu(np.ones((3, 3)), 1)), "not symmetric"),
    (dict(inverse_inertias=lambda x: -x - np.eye(3)), "negative eigenvalue"),
    (dict(arms=lambda x: x[:, :4]), r"arms has the shape"),
    (dict(inverse_masses=lambda x: 0 * x, inverse_inertias=lambda x: 0 * x), "neither of its bodies"),
    (dict(compliances=lambda x: x - 1), "compliances.*negative")])
def test_wrong_bodies_are_refused(wrong, words):
    right = space_scenes.scene("boxes", 5, 0.5, 1)
    fields = vars(right) | {name: change(vars(right)[name].copy()) for name, change in wrong.items()}
    with pytest.raises(ValueError, match=words):
        core.SpaceBodyProblem(**fields)


def test_what_cannot_be_solved_is_proven():
    """A sphere between two plates that close in on it."""
    free = np.zeros((3, 6))
    free[0, 2], free[2, 2] = 1, -1
    problem = core.SpaceBodyProblem([[0, 0, 0], [1, 1, 1], [0, 0, 0]], [0, 2.5, 0], free, [[0, 1], [1, 2]], [[0, 0, 1]] * 2,
                                    [[0, 0, 0, 0, 0, -1], [0, 0, 1, 0, 0, 0]], [0, 0], [0.5, 0.5])
    report = core.solve(problem)
    assert report.status == "no_solution" and report.bodies in ((0, 1), (1, 2))


@pytest.mark.parametrize("kind", ["spheres", "boxes"])
def test_no_solution_is_said_where_linear_programming_says_so(kind):
    """Heaps whose floor rises into lids that stand still. Contacts can stop closing if some u = W p + q has no negative normal part."""
    draw, known = np.random.default_rng(4), []
    for seed in range(12):
        heap = space_scenes.scene(kind, 6, draw.choice([0, 0.3, 0.8]), seed)
        above = heap.pairs[(heap.pairs[:, 0] == len(heap.inverse_masses) - 1) & (heap.normals[:, 2] > 0.9), 1]
        lids = draw.choice(above if seed % 4 == 1 and len(above) else np.unique(heap.pairs)[:-1], 1 + seed % 3)
        free = np.vstack([heap.free_velocities, np.zeros((1, 6))])
        free[-2, 2] = 0.3 * (seed % 2)
        problem = core.SpaceBodyProblem(
            np.vstack([heap.inverse_masses, np.zeros((1, 3))]), np.concatenate([heap.inverse_inertias, np.zeros((1, 3, 3))]), free,
            np.vstack([heap.pairs, [[body, len(free) - 1] for body in lids]]), np.vstack([heap.normals, [[0, 0, 1]] * len(lids)]),
            np.vstack([heap.arms, [[0, 0, 1, 0, 0, 0]] * len(lids)]), np.concatenate([heap.bias, np.zeros(len(lids))]),
            np.concatenate([heap.mu, np.full(len(lids), 0.3)])).delassus()
        W, q = problem.W.toarray(), problem.q
        # The least closing that velocities can have.
        best = linprog(np.append(np.zeros(len(q)), 1), np.column_stack([-W[::3], -np.ones(problem.contacts)]), q[::3],
                       bounds=[(None, None)] * len(q) + [(0, None)])
        possible = best.x[-1] < 1e-9
        report = core.solve(problem, tolerance=1e-8, max_iterations=20000)
        assert report.status != "no_solution" if possible else not report.converged
        known.append((possible, report.status))
    assert (False, "no_solution") in known and (True, "converged") in known
    assert all(status == "no_solution" for possible, status in known if not possible)


@pytest.fixture
def problem():
    return space_scenes.skewed(space_scenes.scene("capsules", 5, 0.4, 3).delassus(), 1e-3, 1)


def same(a, b):
    return abs(a.W - b.W).max() <= 1e-14 * abs(a.W).max() and np.array_equal(a.q, b.q) and np.array_equal(a.mu, b.mu) and a.dimension == b.dimension


def test_fclib_there_and_back(tmp_path, problem):
    core.write_problem(tmp_path / "a.hdf5", problem)
    assert same(core.read_problem(tmp_path / "a.hdf5"), problem)


def blocks_text(problem):
    n, W = problem.contacts, problem.W.tobsr((3, 3))
    W.sort_indices()
    ends, count = range(3, 3 * n + 1, 3), len(W.indices)
    lines = [[3], [n], [1], [3 * n], [3 * n], [count], [n], [n], ends, ends, [n + 1], [count], W.indptr, W.indices]
    blocks = [line for k, block in enumerate(W.data) for line in ([k], block.T.ravel())]
    return "\n".join(" ".join(f"{x:.17g}" if isinstance(x, float) else str(x) for x in line) for line in [*lines, *blocks, problem.q, problem.mu])


def test_siconos_text_in_blocks(tmp_path, problem):
    path = tmp_path / "a.dat"
    path.write_text(blocks_text(problem))
    assert same(core.read_problem(path), problem)
    numerics = pytest.importorskip("siconos.numerics")
    theirs = numerics.frictionContact_new_from_filename(str(path))
    assert theirs.numberOfContacts == problem.contacts and np.allclose(theirs.q, problem.q) and np.allclose(theirs.mu, problem.mu)
    r, u = np.ones(len(problem.q)), np.zeros(len(problem.q))
    options = numerics.SolverOptions(numerics.SICONOS_FRICTION_3D_NSGS)
    options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = 1
    numerics.fc3d_driver(theirs, r, u, options)
    assert np.allclose(u, problem.velocities(r))


class FclibSolution(ctypes.Structure):
    """struct fclib_solution."""
    _fields_ = [(name, ctypes.POINTER(ctypes.c_double)) for name in "vurl"]


def test_libfclib_s_own_error_of_a_solution(tmp_path, problem):
    """It reads the unsymmetric W that was written, and finds that the impulses solve the problem; those of the transpose do not."""
    library = needs.libfclib()
    library.fclib_read_local.restype = ctypes.c_void_p
    library.fclib_merit_local.restype = ctypes.c_double
    core.write_problem(tmp_path / "a.hdf5", problem)
    theirs = ctypes.c_void_p(library.fclib_read_local(str(tmp_path / "a.hdf5").encode()))

    def error(p):
        arrays = [(ctypes.c_double * len(p))(*x) for x in (0 * p, problem.velocities(p), p, 0 * p)]
        return library.fclib_merit_local(theirs, 0, ctypes.byref(FclibSolution(*(ctypes.cast(x, ctypes.POINTER(ctypes.c_double)) for x in arrays))))
    p, transposed = (core.solve(core.Problem(W, problem.q, problem.mu, 3), tolerance=1e-11).impulses for W in (problem.W, problem.W.T))
    assert error(p) < 1e-9 and error(transposed) > 1e-5


def write_global(path, M, H, f, w, mu, nz, order="siconos"):
    with h5py.File(path, "w") as file:
        group = file.create_group("fclib_global")
        group["spacedim"] = [3]
        for name, A in (("M", M), ("H", H)):
            A = sparse.coo_matrix(A) if nz >= 0 else sparse.csc_matrix(A) if nz == -1 else sparse.csr_matrix(A)
            i, p = (A.row, A.col) if nz >= 0 else (A.indices, A.indptr)
            for key, value in (("m", [A.shape[0]]), ("n", [A.shape[1]]), ("nzmax", [A.nnz]), ("nz", [A.nnz if nz >= 0 else nz]), ("i", i), ("p", p)):
                group[f"{name}/{key}"] = np.asarray(value, np.int32)
            group[f"{name}/x"] = A.data
        for name, value in (("f", f), ("w", w), ("mu", mu)):
            group[f"vectors/{name}"] = value


@pytest.mark.parametrize("nz", [0, -1, -2])
def test_global_problems_are_condensed(tmp_path, nz):
    draw = np.random.default_rng(3)
    bodies, contacts = 4, 5
    A = draw.normal(0, 1, (6 * bodies, 6 * bodies))
    M = A @ A.T + np.eye(6 * bodies)
    H, f, w = (draw.normal(0, 1, size) for size in ((6 * bodies, 3 * contacts), 6 * bodies, 3 * contacts))
    mu = np.full(contacts, 0.3)
    write_global(tmp_path / "a.hdf5", M, H, f, w, mu, nz)
    problem = core.read_problem(tmp_path / "a.hdf5")
    assert np.allclose(problem.W.toarray(), H.T @ np.linalg.solve(M, H)) and np.allclose(problem.q, H.T @ np.linalg.solve(M, f) + w)
    assert problem.dimension == 3


@pytest.mark.parametrize("damage, words", [
    (lambda g: g.__delitem__("H"), "H/m: is missing"),
    (lambda g: g["M/x"].__setitem__(slice(None), 0), "M: cannot be inverted"),
    (lambda g: g["H/m"].__setitem__(0, 7), "H"),
    (lambda g: g["H/i"].__setitem__(0, 999), "H: points outside|H/i: points outside"),
    (lambda g: g.create_group("G"), "bilateral"),
    (lambda g: g["vectors/w"].__setitem__(0, np.nan), r"q\[0\]")])
def test_damaged_global_files(tmp_path, damage, words):
    path = tmp_path / "a.hdf5"
    write_global(path, np.eye(6), np.eye(6)[:, :3], np.ones(6), np.ones(3), [0.5], -1)
    with h5py.File(path, "a") as file:
        damage(file["fclib_global"])
    with pytest.raises(ValueError, match=words) as raised:
        core.read_problem(path)
    assert str(path) in str(raised.value) and "\n" not in str(raised.value)


def test_problems_of_bodies_are_written_and_read(tmp_path):
    bodies = space_scenes.scene("boxes", 5, 0.5, 1)
    core.write_problem(tmp_path / "a.npz", bodies)
    back = core.read_problem(tmp_path / "a.npz")
    assert all(np.array_equal(value, vars(back)[name]) for name, value in vars(bodies).items())


