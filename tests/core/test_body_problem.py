"""Problems given by their bodies: equal to those given by their matrix, unchanged by writing and reading, and what is refused."""
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cd_engine import core

from .test_problem import error


def drawn(seed=1, bodies=12, contacts=20, mu=0.4):
    """Random contacts of disks and other bodies. Body 0 cannot move freely but has a velocity; body 1 moves along x alone."""
    draw = np.random.default_rng(seed)
    masses = draw.uniform(0.5, 2, (bodies, 3))
    masses[2:, 1] = masses[2:, 0]
    masses[0] = masses[1, 1:] = 0
    pairs = np.array([draw.choice(np.arange(1, bodies), 2, replace=False) for _ in range(contacts)])
    pairs[::7, 0] = 0
    angle = draw.uniform(0, 2 * np.pi, contacts)
    arms = draw.uniform(-1, 1, (contacts, 4))
    arms[::2, [0, 2]] = 0  # disks: no arm of the normal
    arms[::2, [1, 3]] = draw.uniform(0.3, 1, (len(arms[::2]), 2)) * (1, -1)
    return core.BodyProblem(masses, draw.uniform(-1, 1, (bodies, 3)), pairs, np.stack([np.cos(angle), np.sin(angle)], axis=1), arms,
                            draw.uniform(-0.2, 0.1, contacts), np.full(contacts, mu), draw.uniform(-1, 1, 2 * contacts))


def test_by_hand():
    """A disk of 1 kg, radius 1 m and 1/I = 2, pressed at 1 m/s on a roller that turns at 2 rad/s whatever happens: W = diag(1, 1 + 2), the rim
    passes at 2 m/s, and both stick after the impulses 1 and 2/3 N s, which are within the cone."""
    roller = core.BodyProblem([[0, 0, 0], [1, 1, 2]], [[0, 0, 2], [0, -1, 0]], [[0, 1]], [[0, 1]], [[0, 1, 0, -1]], [0], [0.8])
    assert np.allclose(roller.delassus().W.toarray(), np.diag([1, 3])) and np.allclose(roller.delassus().q, [-1, -2])
    for method in core.methods():
        report = core.solve(roller, method=method)
        assert report.converged and np.allclose(report.impulses, [1, 2 / 3], rtol=0, atol=1e-14)
    # t is n turned by +90 degrees, here -x: the disk goes along with the rim, and turns against it.
    assert np.allclose(roller.body_velocities(report.impulses), [[0, 0, 2], [-2 / 3, 0, -4 / 3]], atol=1e-14)


@given(st.integers(0, 10**6), st.integers(1, 30))
@settings(deadline=None, max_examples=30)
def test_both_forms_are_one_problem(seed, contacts):
    """The compiled error of either form and the one from its definition; 1e-12: sums of at most 60 numbers of order 1."""
    problem = drawn(seed, contacts=contacts)
    matrix, p = problem.delassus(), problem.impulses
    assert abs(matrix.W - matrix.W.T).max() == 0
    assert np.allclose(problem.velocities(p), matrix.velocities(p), rtol=0, atol=1e-12)
    expected = error(matrix, p)
    assert core.residual(problem, p) == pytest.approx(expected, rel=1e-12) and core.residual(matrix, p) == pytest.approx(expected, rel=1e-12)
    assert core.residual_max(problem, p) == pytest.approx(core.residual_max(matrix, p), rel=1e-12)


@pytest.mark.parametrize("method", core.methods())
def test_either_solves_the_other(method):
    problem = drawn(5)
    a, b = core.solve(problem, method, 1e-10), core.solve(problem.delassus(), method, 1e-10)
    assert a.converged and b.converged and a.iterations > 0
    # 1e-14: the engine's own error has its sums in the order of the sweep, and both are known to round-off only.
    assert core.residual(problem, a.impulses) == pytest.approx(a.residual, abs=1e-14)
    assert core.residual_max(problem, a.impulses) == pytest.approx(a.residual_max, abs=1e-13)
    # 2e-10: the other form sums in another order.
    assert core.residual(problem.delassus(), a.impulses) < 2e-10 and core.residual(problem, b.impulses) < 2e-10
    again = core.solve(problem, method, 1e-10, impulses=a.impulses)
    assert again.iterations == 0 and np.array_equal(again.impulses, a.impulses)


def test_the_first_guess_is_taken_only_if_asked_for():
    problem = drawn(5)
    blank = drawn(5)
    blank.impulses[:] = 0
    assert np.array_equal(core.solve(problem).impulses, core.solve(blank).impulses)


def test_instruction_sets_give_the_same_bits():
    problem, found = drawn(3), []
    for name in core.instruction_sets():
        core.use_instruction_set(name)
        found.append(core.solve(problem).impulses)
    core.use_instruction_set(core.instruction_sets()[0])
    assert all(np.array_equal(p, found[0]) for p in found)
    with pytest.raises(ValueError, match="abacus"):
        core.use_instruction_set("abacus")


@pytest.mark.parametrize("contacts", [0, 20])
def test_there_and_back(tmp_path, contacts):
    problem, path = drawn(contacts=20), tmp_path / "problem.npz"
    if contacts == 0:
        empty = np.zeros(0)
        problem = core.BodyProblem(problem.inverse_masses, problem.free_velocities, [], empty.reshape(0, 2), empty.reshape(0, 4), empty, empty)
        assert core.solve(problem).converged and core.residual(problem, empty) == 0 and problem.delassus().contacts == 0
    core.write_problem(path, problem)
    back = core.read_problem(path)
    for name in ("inverse_masses", "free_velocities", "pairs", "normals", "arms", "bias", "mu", "impulses"):
        assert np.array_equal(getattr(back, name), getattr(problem, name))
    assert list(tmp_path.iterdir()) == [path]


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 255), st.booleans())
def test_damaged_files(tmp_path_factory, where, value, cut):
    """With any byte changed, or the end missing, the file gives the same problem (if the byte has no meaning) or a ValueError with the path."""
    path = tmp_path_factory.mktemp("damaged") / "problem.npz"
    core.write_problem(path, drawn())
    content = bytearray(path.read_bytes())
    where = 4 + where % (len(content) - 4)  # a file that does not begin as a zip archive is read as text, and refused as such
    if cut:
        del content[where:]
    else:
        content[where] = value
    path.write_bytes(content)
    try:
        assert np.array_equal(core.read_problem(path).arms, drawn().arms)
    except ValueError as raised:
        assert str(path) in str(raised)


def changed(**fields):
    def make():
        problem = drawn()
        return {name: getattr(problem, name) for name in problem.__dataclass_fields__} | fields
    return make


BODIES, CONTACTS = 12, 20


@pytest.mark.parametrize("fields, words", [
    (changed(inverse_masses=np.ones((BODIES, 2))), r"inverse_masses has the shape \(12, 2\)"),
    (changed(inverse_masses=None), "inverse_masses is not an array"),
    (changed(inverse_masses=-np.ones((BODIES, 3))), r"inverse_masses\[0, 0\] = -1 is negative"),
    (changed(inverse_masses=np.zeros((BODIES, 3))), "contact 0: neither of its bodies"),
    (changed(free_velocities=np.full((BODIES, 3), np.nan)), r"free_velocities\[0, 0\] is nan"),
    (changed(free_velocities=np.zeros((BODIES - 1, 3))), "free_velocities has the shape"),
    (changed(pairs=np.zeros((CONTACTS, 2))), "whole numbers"),
    (changed(pairs=np.ones((CONTACTS, 3), int)), "pairs has the shape"),
    (changed(pairs=np.full((CONTACTS, 2), [1, BODIES])), r"pairs\[0, 1\] = 12; the bodies are 0 to 11"),
    (changed(pairs=np.full((CONTACTS, 2), [-1, 2])), r"pairs\[0, 0\] = -1"),
    (changed(pairs=np.full((CONTACTS, 2), 3)), r"pairs\[0\]: body 3 touches itself"),
    (changed(normals=np.ones((CONTACTS, 2))), r"normals\[0\] has the length 1.414"),
    (changed(arms=np.zeros((CONTACTS, 2))), "arms has the shape"),
    (changed(bias=np.full(CONTACTS, np.inf)), r"bias\[0\] is inf"),
    (changed(bias=["a"] * CONTACTS), "bias is not an array of numbers"),
    (changed(mu=np.full(CONTACTS, -0.5)), r"mu\[0\] = -0.5 is negative"),
    (changed(mu=[]), "pairs has the shape"),
    (changed(impulses=np.zeros(3)), "impulses has the shape"),
])
def test_refused(tmp_path, fields, words):
    with pytest.raises(ValueError, match=words):
        core.BodyProblem(**fields())
    if all(isinstance(value, np.ndarray) for value in fields().values()):
        path = tmp_path / "problem.npz"
        np.savez(path, **fields())
        with pytest.raises(ValueError, match=f"{path}: .*{words}"):
            core.read_problem(path)


def test_other_archives_are_refused(tmp_path):
    path = tmp_path / "problem.npz"
    np.savez(path, mu=np.zeros(3))
    with pytest.raises(ValueError, match="inverse_masses: is missing"):
        core.read_problem(path)
    np.savez(path, **(changed()() | {"arms": np.array([{}])}))  # a pickle, which might do anything
    with pytest.raises(ValueError, match="arms: cannot be read"):
        core.read_problem(path)


def test_a_problem_spoilt_later_is_refused_too():
    problem = drawn()
    problem.pairs[3, 0] = 99
    with pytest.raises(ValueError, match=r"pairs\[3, 0\] = 99"):
        core.solve(problem)
    with pytest.raises(ValueError, match="title"):
        core.write_problem("nowhere", drawn(), title="bodies")


@pytest.mark.parametrize("normal", [(1, np.cos(np.pi / 2)), (np.sin(np.pi), -1), (np.cos(np.pi / 2), 1)])
def test_freedom_by_round_off_is_none(normal):
    """A body can move along one axis alone and is pushed along the other by a rotated normal. The product of this normal and the axis is only
    round-off, 6e-17 or 1e-16, and impulses of 1e32 N s would solve it."""
    free = [0, 1, 0] if abs(normal[1]) < 0.5 else [1, 0, 0]
    with pytest.raises(ValueError, match="contact 0: neither of its bodies 0 and 1 can move along its normal"):
        core.BodyProblem([[0, 0, 0], free], [[0, 0, 0], [-1, -1, 0]], [[0, 1]], [normal], [[0, 1, 0, -1]], [0], [0.3])
    # A slope of 1e-10 is a real freedom.
    slope = (1e-10, 1) if free[0] else (1, 1e-10)
    assert core.solve(core.BodyProblem([[0, 0, 0], free], [[0, 0, 0], [-1, -1, 0]], [[0, 1]], [slope], [[0, 1, 0, -1]], [0], [0])).converged


@pytest.mark.parametrize("method", core.methods())
def test_bodies_of_what_has_no_solution_are_named(method):
    """Two disks between walls that close in at 1 m/s: bodies 0 and 3."""
    problem = core.BodyProblem([[0, 0, 0], [1, 1, 2], [1, 1, 2], [0, 0, 0]], [[1, 0, 0], [0, 0, 0], [0, 0, 0], [-1, 0, 0]], [[0, 1], [1, 2], [2, 3]],
                               [[1, 0]] * 3, [[0, 1, 0, -1]] * 3, [0] * 3, [0.3] * 3)
    for tolerance in (1e-2, 1e-8):
        report = core.solve(problem, method, tolerance)
        assert not report.converged and report.status == "no_solution" and report.bodies == tuple(problem.pairs[report.contact])
    apart = core.BodyProblem(problem.inverse_masses, np.abs(problem.free_velocities), problem.pairs, problem.normals, problem.arms, problem.bias,
                             problem.mu)
    report = core.solve(apart, method)
    assert report.converged and report.contact is None and report.bodies is None
