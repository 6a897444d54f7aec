"""Problems given by their matrix: what the error e means, that every method reduces it to the tolerance, and that what has no solution is named."""
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import sparse

from cd_engine import core


def packed(contacts, seed, mu=0.4):
    """A problem with W = H^T H + 0.3 I, where H has fewer rows than columns, as in a dense packing."""
    random = np.random.default_rng(seed)
    H = sparse.random(max(3, 3 * contacts // 2), 2 * contacts, density=min(1, 6 / contacts), random_state=seed, data_rvs=random.standard_normal)
    W = (H.T @ H + 0.3 * sparse.eye(2 * contacts)).tocsr()
    return core.Problem(W, random.standard_normal(2 * contacts) - np.tile([0.5, 0], contacts), np.full(contacts, mu))


def on_cone(mu, n, t):
    """Euclidean projection of (n, t) on |t| <= mu n as the nearest of three points: itself, the apex, the feet on the two edges."""
    if n >= 0 and abs(t) <= mu * n:
        return np.array([n, t])
    edge = [np.array([1, side * mu]) for side in (-1, 1)]
    feet = [max(0, e @ (n, t)) / (e @ e) * e for e in edge]
    return min(feet, key=lambda foot: np.hypot(*(foot - (n, t))))


def error(problem, p):
    """e from its definition, contact by contact."""
    u = problem.W.toarray() @ p + problem.q
    total = 0
    for i, mu in enumerate(problem.mu):
        own = problem.W[2 * i, 2 * i]
        n, t = p[2 * i] - (u[2 * i] + mu * abs(u[2 * i + 1])) / own, p[2 * i + 1] - u[2 * i + 1] / own
        total += np.sum((p[2 * i:2 * i + 2] - on_cone(mu, n, t)) ** 2)
    return np.sqrt(total) / np.linalg.norm(p)


NUMBER = st.floats(-10, 10).map(lambda x: round(x, 6))


MU = st.floats(0, 2).map(lambda x: round(x, 6))
POINT = arrays(float, 2, elements=NUMBER)


@given(MU, POINT, POINT)
@settings(deadline=None)
def test_projection(mu, a, b):
    """The projection the errors below are compared with: on the cone, idempotent, nonexpansive."""
    pa, pb = on_cone(mu, *a), on_cone(mu, *b)
    # 1e-13: round-off of numbers up to 10, some operations each.
    assert abs(pa[1]) <= mu * pa[0] + 1e-13
    assert np.allclose(on_cone(mu, *pa), pa, rtol=0, atol=1e-13)
    assert np.linalg.norm(pa - pb) <= np.linalg.norm(a - b) + 1e-13


@given(st.integers(1, 4), st.integers(0, 10**6), MU, st.data())
@settings(deadline=None)
def test_error_is_its_definition(contacts, seed, mu, data):
    problem = packed(contacts, seed, mu)
    p = data.draw(arrays(float, 2 * contacts, elements=NUMBER))
    if not p.any():
        return
    # 1e-12: both sum a few numbers of order 1 to 100.
    assert core.residual(problem, p) == pytest.approx(error(problem, p), rel=1e-12, abs=1e-12)


@given(MU, st.sampled_from(["open", "stick", "slide"]), st.floats(0.1, 5), st.floats(-1, 1), st.floats(0.1, 5))
@settings(deadline=None)
def test_no_error_where_the_law_holds(mu, state, pn, share, speed):
    """One contact in each state; and one if the velocity or the impulse is off it."""
    W = np.array([[2.0, 0.3], [0.3, 3.0]])
    side = 1 if share >= 0 else -1
    p = {"open": [0, 0], "stick": [pn, share * mu * pn], "slide": [pn, -side * mu * pn]}[state]
    u = {"open": [speed, share], "stick": [0, 0], "slide": [0, side * speed]}[state]
    solved = core.Problem(W, np.array(u) - W @ p, [mu])
    assert core.residual(solved, p) < 1e-13  # round-off
    off = core.residual(core.Problem(W, np.array(u) - [speed + 0.1, 0] - W @ p, [mu]), p)
    assert off > 1e-3  # closing: infinite where there is no impulse at all


@pytest.mark.parametrize("method", core.methods())
@pytest.mark.parametrize("mu", [0, 0.1, 0.8])
def test_every_method_solves(method, mu):
    problem = packed(60, 5, mu)
    report = core.solve(problem, method=method, tolerance=1e-10)
    assert report.converged and report.status == "converged" and report.iterations > 0 and report.seconds > 0
    assert report.residual <= 1e-10 and report.residual <= report.residual_max
    assert core.residual(problem, report.impulses) == report.residual
    assert error(problem, report.impulses) < 2e-10  # the definition, with its own round-off
    again = core.solve(problem, method=method, tolerance=1e-10, impulses=report.impulses)
    assert again.iterations == 0 and np.array_equal(again.impulses, report.impulses)


def test_units_do_not_matter():
    """Impulses of 1e-20 N s are solved as those of 1: the error has no scale."""
    problem = packed(30, 2)
    small = core.Problem(problem.W, problem.q * 2.0**-70, problem.mu)
    a, b = core.solve(problem), core.solve(small)
    assert a.iterations == b.iterations and np.array_equal(a.impulses * 2.0**-70, b.impulses)


def test_what_is_not_solved_says_so():
    problem = packed(60, 5)
    few = core.solve(problem, max_iterations=2, tolerance=1e-12)
    assert not few.converged and few.status == "max_iterations" and few.iterations == 2
    assert core.residual(problem, few.impulses) == few.residual


HOPELESS = [[1, 0, -1, 0], [0, 1, 0, 0], [-1, 0, 1, 0], [0, 0, 0, 1]]  # an impulse that opens one contact closes the other


@pytest.mark.parametrize("method", core.methods())
@pytest.mark.parametrize("tolerance", [1e-2, 1e-5, 1e-8, 1e-11])
def test_what_has_no_solution_is_named(method, tolerance):
    """Both contacts close at 1 m/s, and neither can open without closing the other: impulses grow for ever, so an error relative to them falls."""
    report = core.solve(core.Problem(HOPELESS, [-1, 0, -1, 0], [0, 0]), method=method, tolerance=tolerance, max_iterations=5000)
    assert not report.converged and report.status == "no_solution" and report.contact in (0, 1) and report.bodies is None
    assert report.solved_by == "none" and report.iterations <= 5000


def solutions(W, q, mu):
    """The impulses that solve a problem of few contacts exactly. All combinations of open, sticking and sliding contacts are tried."""
    n = len(mu)
    for states in itertools.product(("open", "stick", 1, -1), repeat=n):  # +-1: slides, with p_t on this side
        columns, rows = [], []
        for i, state in enumerate(states):
            if state == "open":
                continue
            normal, tangential = np.eye(2 * n)[2 * i], np.eye(2 * n)[2 * i + 1]
            columns += [normal, tangential] if state == "stick" else [normal + state * mu[i] * tangential]
            rows += [2 * i, 2 * i + 1] if state == "stick" else [2 * i]
        S = np.array(columns).reshape(-1, 2 * n).T
        p = S @ np.linalg.lstsq((W @ S)[rows], -q[rows], rcond=1e-10)[0] if rows else np.zeros(2 * n)
        u = W @ p + q
        # 1e-9: round-off of a few sums and of the least squares, which leave out singular values below 1e-10.
        speed, push = 1e-9 * (np.abs(W) @ np.abs(p) + np.abs(q)).max(), 1e-9 * np.abs(p).max()
        fits = {"open": lambda un, ut, pn, pt, m: un >= -speed,
                "stick": lambda un, ut, pn, pt, m: max(abs(un), abs(ut)) <= speed and pn >= -push and abs(pt) <= m * pn + push,
                1: lambda un, ut, pn, pt, m: abs(un) <= speed and pn >= -push and ut <= speed,
                -1: lambda un, ut, pn, pt, m: abs(un) <= speed and pn >= -push and ut >= -speed}
        if all(fits[state](*u[2 * i:2 * i + 2], *p[2 * i:2 * i + 2], mu[i]) for i, state in enumerate(states)):
            yield p


def singular(seed):
    """W = H^T H of up to three contacts, mostly of low rank: about one in ten has no solution."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 4))
    shape = int(random.integers(1, 2 * n + 1)), 2 * n
    H = random.standard_normal(shape) if random.random() < 0.5 else random.integers(-1, 2, shape).astype(float)
    H[0] += ~H.any(axis=0)  # a diagonal without zeros
    q = random.standard_normal(2 * n) if random.random() < 0.5 else random.integers(-1, 2, 2 * n).astype(float)
    return H.T @ H, q, random.choice([0, 0, 0.1, 0.3, 1.0], n)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
@pytest.mark.parametrize("method", core.methods())
def test_converged_means_solved(method, tolerance):
    """Singular problems, compared with all states of their contacts: one without a solution is never reported as solved, and mostly named."""
    named = hopeless = 0
    for seed in range(100):
        W, q, mu = singular(seed)
        report = core.solve(core.Problem(W, q, mu), method=method, tolerance=tolerance, max_iterations=10000)
        exact = next(solutions(W, q, mu), None)
        assert report.iterations <= 10000
        if exact is None:
            hopeless += 1
            named += report.status == "no_solution"
            assert not report.converged, (seed, report)
        elif report.converged:
            p, u = report.impulses, W @ report.impulses + q
            # Velocities are right to the tolerance times the impulses, and these are at most 1e4 times those a closing contact asks for.
            allowed = 3 * tolerance * np.sqrt(len(p)) * np.abs(W).max() * np.abs(p).max() + 1e-12
            assert np.all(u[::2] >= -allowed) and np.all(np.abs(p[1::2]) <= mu * p[::2] + 1e-12 * np.abs(p).max()), (seed, report)
            assert np.all(np.minimum(np.abs(u[::2]), W.diagonal()[::2] * p[::2]) <= allowed), (seed, report)
        elif not mu.any():  # with friction, impulses may grow along a self-stress although another motion solves the problem
            assert report.status != "no_solution", (seed, report)
    assert hopeless > 5 and named >= 0.7 * hopeless  # sweeps that oscillate without growing along a self-stress prove nothing


@pytest.mark.parametrize("coupling", [0.01, 0.1, 1])
def test_momentum_that_swings_leaves_plain_sweeps_their_share(coupling):
    """accelerated solves what nsgs solves, in at most three times its sweeps or 300: momentum comes first, so one bound for both cannot be had."""
    n = 8
    problem = core.Problem(np.eye(2 * n) + coupling * np.ones((2 * n, 2 * n)), -np.ones(2 * n), np.full(n, 0.3))
    for tolerance in (1e-2, 1e-4, 1e-6):
        plain = core.solve(problem, method="nsgs", tolerance=tolerance, max_iterations=10000)
        assert plain.converged
        assert core.solve(problem, method="accelerated", tolerance=tolerance, max_iterations=max(300, 3 * plain.iterations)).converged


def off_range(seed):
    """W = H^T H without friction, half of them with a self-stress; q is in the range of W except for a part of 1e-9 to 1 of it."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 9))
    H = random.normal(size=(random.integers(1, n + 2), 2 * n))
    if random.random() < 0.5:
        H[:, -2] = -H[:, :-2:2] @ random.uniform(0.1, 1, n - 1)
    q = H.T @ random.normal(size=len(H))
    q[::2] += 10.0 ** random.integers(-9, 1) * random.normal(size=n)
    return H.T @ H, q


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6, 1e-10])
@pytest.mark.parametrize("method", core.methods())
def test_converged_closes_nothing(method, tolerance):
    """If W has no solution, impulses that grow along a self-stress do not count as solved, however small the error relative to them.

    Up to a hundred times the impulses that each contact alone would need, the solvers do not check for growth along a self-stress.
    """
    for seed in range(100):
        W, q = off_range(seed)
        report = core.solve(core.Problem(W, q, np.zeros(len(q) // 2)), method=method, tolerance=tolerance, max_iterations=20000)
        if report.converged:
            W, q = W[::2, ::2], q[::2]
            root = np.sqrt(W.diagonal())  # impulses times it and velocities over it have one unit
            allowed = 100 * tolerance * np.linalg.norm(np.minimum(q, 0) / root) * np.linalg.norm(W / np.outer(root, root), 2)
            assert ((W @ report.impulses[::2] + q) / root).min() >= -allowed, (seed, report)


@pytest.mark.parametrize("method", core.methods())
def test_indefinite(method):
    """W is symmetric with a positive diagonal, but not mechanical: a result that counts as solved satisfies the law, others are often named."""
    random = np.random.default_rng(7)
    statuses = []
    for _ in range(100):
        n = int(random.integers(1, 4))
        A = random.standard_normal((2 * n, 2 * n))
        W = A + A.T
        np.fill_diagonal(W, np.abs(W.diagonal()) + 0.1)
        q, mu = random.standard_normal(2 * n), random.choice([0, 0.3, 1.0], n)
        with np.errstate(over="ignore", invalid="ignore"):
            report = core.solve(core.Problem(W, q, mu), method=method, max_iterations=5000)
            statuses.append(report.status)
            assert not report.converged or (np.abs(report.impulses).max() < 1e8 and next(solutions(W, q, mu), None) is not None), report
    assert statuses.count("indefinite") >= 3 and set(statuses) <= {"converged", "indefinite", "diverged", "stagnated", "max_iterations"}


def test_impulses_beyond_every_bound_are_no_solution():
    """Walls close in on a body whose escape is blocked except for a share of 1e-14: the only solution has impulses 1e14 times larger."""
    escape = 1e-14
    W = np.diag([1.0, 1, 1, 1])
    W[0, 2] = W[2, 0] = -1 + escape
    for method in core.methods():
        report = core.solve(core.Problem(W, [-1, 0, -1, 0], [0, 0]), method=method, max_iterations=5000)
        assert not report.converged and report.status == "no_solution"
    # As first guesses they are not used.
    problem = packed(10, 3)
    for guess in (1e200, 1e308, 1e30):
        assert np.array_equal(core.solve(problem, impulses=np.full(20, guess)).impulses, core.solve(problem).impulses)


def definite(seed):
    """Symmetric positive definite, of up to 60 contacts: all coupled alike, any spectrum up to 1e6, sparse, rows of different size."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 60))
    kind = seed % 4
    if kind == 0:
        W = np.eye(2 * n) + random.uniform(0, 0.05) * np.ones((2 * n, 2 * n))
    elif kind == 1:
        Q = np.linalg.qr(random.standard_normal((2 * n, 2 * n)))[0]
        W = Q @ np.diag(np.geomspace(1, 10**random.uniform(0, 6), 2 * n)) @ Q.T
    elif kind == 2:
        H = sparse.random(4 * n, 2 * n, density=min(1, 2 / n), random_state=seed, data_rvs=random.standard_normal).toarray()
        W = H.T @ H + 10**random.uniform(-6, 0) * np.eye(2 * n)
    else:
        H = np.abs(random.standard_normal((2 * n, 2 * n)))
        W = H.T @ H / n + 10**random.uniform(-4, 0) * np.eye(2 * n)
    q = random.standard_normal(2 * n) if random.random() < 0.5 else np.tile([-1.0, -1.0], n)
    return core.Problem((W + W.T) / 2, q, np.full(n, random.choice([0, 0.1, 0.3, 0.6, 1.0])))


@pytest.mark.parametrize("form", ["matrix", "bodies"])
def test_no_method_does_worse_than_plain_sweeps(form):
    """On positive definite W each solves what nsgs solves, in three times its sweeps and 600: 100 before plain sweeps are tried beside momentum,
    which then make a quarter to all of its number, and 500 at the start of newton. In the form of bodies momentum first has to be in vain for
    3000."""
    for seed in range(200 if form == "matrix" else 40):
        problem = definite(seed) if form == "matrix" else heap(seed)
        plain = core.solve(problem, method="nsgs", max_iterations=10000)
        assert plain.status != "no_solution"
        for method in ("accelerated", "newton", "auto"):
            report = core.solve(problem, method=method, max_iterations=100000)
            assert report.status != "no_solution"
            if plain.converged:
                most = 3 * plain.iterations + (600 if form == "matrix" else 9000)
                assert report.converged and report.iterations <= most, (seed, method, plain, report)


def heap(seed):
    """A tree of bodies in contact, each held by the one before: W is positive definite."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 40))
    angle = random.uniform(0, np.pi, n)
    masses = 10**random.uniform(-1, 1, n + 1)
    return core.BodyProblem(np.outer(np.where(np.arange(n + 1), 1 / masses, 0), [1, 1, 2]),
                            np.where(np.arange(n + 1)[:, None], random.standard_normal((n + 1, 3)), 0),
                            np.stack([[int(random.integers(0, i + 1)) for i in range(n)], np.arange(1, n + 1)], axis=1),
                            np.stack([np.cos(angle), np.sin(angle)], axis=1), np.tile([0, 1, 0, -1.0], (n, 1)), random.uniform(-0.1, 0.1, n),
                            np.full(n, random.choice([0, 0.3, 1.0])))


def test_all_contacts_coupled_alike():
    """With momentum for each contact separately the sweeps would oscillate for ever here; plain sweeps need some 250."""
    n = 500
    W = np.eye(2 * n) + 0.04
    for q in (-np.ones(2 * n), np.tile([-1.0, 0.0], n)):
        problem = core.Problem(W, q, np.full(n, 0.3))
        plain = core.solve(problem, method="nsgs")
        for method in ("accelerated", "auto"):
            report = core.solve(problem, method=method)
            assert report.converged and report.iterations <= 2 * plain.iterations + 400
            assert core.residual(problem, report.impulses) <= 1e-8


@pytest.mark.parametrize("method", core.methods())
def test_no_more_than_max_iterations(method):
    for most in (1, 2, 3, 5, 17, 50, 101, 600):
        for problem in (packed(60, 5), core.Problem(HOPELESS, [-1, 0, -1, 0], [0, 0])):
            assert core.solve(problem, method=method, tolerance=1e-15, max_iterations=most).iterations <= most


def pressed(seed):
    """A frictionless problem without a solution: impulses d >= 0 whose velocities W d vanish, and d . q < 0."""
    r = np.random.default_rng(seed)
    n = r.integers(3, 30)
    normal, tangential = r.normal(size=(2, n, 3 * n // 4 + 1))
    d = np.zeros(n)
    d[r.choice(n, r.integers(2, n + 1), replace=False)] = 1
    d *= r.random(n) + 0.1
    last, q = np.flatnonzero(d)[-1], r.normal(size=n)
    normal[last] = -(d @ normal - d[last] * normal[last]) / d[last]
    q[last] -= (d @ q + np.linalg.norm(d)) / d[last]
    H = np.stack([normal, tangential], axis=1).reshape(2 * n, -1)
    return core.Problem(H @ H.T, np.stack([q, 0 * q], axis=1).ravel(), np.zeros(n))


@pytest.mark.parametrize("method", ["nsgs", "accelerated", "newton", "auto"])
@pytest.mark.parametrize("tolerance", [3e-2, 1e-2, 1e-3, 1e-4])
def test_what_has_no_solution_does_not_count_as_solved_at_loose_tolerances_either(method, tolerance):
    """e is small long before the impulses have grown enough to show that no solution exists; 8 of 15 such problems once counted as solved at 1e-2."""
    for seed in range(15):
        report = core.solve(pressed(seed), method=method, tolerance=tolerance, max_iterations=5000)
        assert not report.converged


def test_fixed_iterations_that_only_press_are_not_converged():
    """A disk lies between the floor and one 1e8 times as heavy. In 20 000 sweeps e falls as the impulses grow, but the weight is not carried yet."""
    W = np.kron([[1, -1], [-1, 1 + 1e-8]], np.eye(2))
    report = core.solve(core.Problem(W, [-1, 0, 0, 0], [0, 0]), tolerance=1e-3, fixed_iterations=20000)
    assert report.residual < 1e-4 and report.status == "fixed_iterations" and not report.converged


@pytest.mark.parametrize("method", core.methods())
def test_a_trace_tells_how_the_error_falls(method):
    """Its last row is the result, its rows before it are the errors of as many sweeps, and it changes nothing."""
    problem = packed(200, 3)
    report, without = core.solve(problem, method, 1e-9, trace=True), core.solve(problem, method, 1e-9)
    assert without.trace is None and (without.impulses == report.impulses).all()
    made, errors = report.trace.T
    assert (np.diff(made) >= 0).all() and made[0] == 0 and made[-1] == report.iterations and len(made) > 3
    assert (errors[:-1] > 1e-9).all() and errors[-1] <= 1e-9 and errors[-1] >= report.residual
    if method == "nsgs":
        own = problem.W.diagonal()[::2]
        weighted = np.sqrt(own.max() / own.min())  # by this the error weighted by W_nn may be larger
        for sweeps, found in report.trace[1:]:
            e = core.solve(problem, fixed_iterations=int(sweeps)).residual
            assert e * (1 - 1e-9) <= found <= weighted * e


def test_fixed_iterations_and_seed():
    problem = packed(60, 5)
    a, b = (core.solve(problem, method=method, fixed_iterations=9, seed=4) for method in ("nsgs", "accelerated"))
    assert a.iterations == 9 and a.status == "fixed_iterations" and np.array_equal(a.impulses, b.impulses)
    assert not np.array_equal(a.impulses, core.solve(problem, fixed_iterations=9, seed=5).impulses)


def test_nothing_given_is_changed_and_none_is_needed():
    problem = packed(20, 1)
    first = np.ones(40)
    before = problem.W.copy(), problem.q.copy()
    core.solve(problem, impulses=first)
    assert np.all(first == 1) and (problem.W != before[0]).nnz == 0 and np.array_equal(problem.q, before[1])
    none = core.Problem(sparse.csr_matrix((0, 0)), [], [])
    assert core.solve(none).converged and core.residual(none, []) == 0


def test_no_yade_is_needed(root):
    """Tested in a fresh interpreter without YADE."""
    import subprocess
    code = "import sys; sys.path.insert(0, sys.argv[1]); from cd_engine import core; core.methods(); assert 'yade' not in sys.modules"
    subprocess.run(["/usr/bin/python3", "-I", "-c", code, str(root)], check=True)


def test_who_solved_it():
    """solved_by is the method of sweeps if they suffice. The factorizations of Newton's method count among the iterations."""
    problem = packed(60, 5)
    a, b, c = (core.solve(problem, method=method) for method in ("accelerated", "auto", "newton"))
    assert np.array_equal(a.impulses, b.impulses) and b.solved_by == a.solved_by == "accelerated" and b.factorizations == 0
    assert c.solved_by == "newton" and 0 < c.factorizations <= c.iterations and core.residual(problem, c.impulses) == c.residual
    assert core.solve(problem, max_iterations=2, tolerance=1e-12).solved_by == "none"
