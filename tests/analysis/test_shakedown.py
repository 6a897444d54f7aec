"""The limits of load cycles against samples solved by hand, and against the same limits found in another way."""
import math

import numpy as np
import pytest
from scipy import optimize

from analysis import __main__ as command
from tests.analysis import conftest
from tests.analysis.test_statics import DEPTH, P0, RADIUS, diagonal_pair
from yade_scripts.results import schema
from yade_scripts.errors import ResultError
from yade_scripts.theory import shakedown, statics

PATHS = "constant", "mean"


def corner_pair(mu, wall_mu):
    """Two disks along the diagonal of their box, at rest under P0 without friction forces."""
    packing = diagonal_pair(math.pi / 4, mu, wall_mu)
    push = P0 * DEPTH * packing["box"][1]
    return packing | {"force_normal": push * np.array([1, 1, 1, 1, math.sqrt(2)]), "force_tangential": np.zeros(5)}


def single_disk(mu, turned=0.0):
    """A disk between four rough walls under P0, which turn it to and fro by T = +-turned R."""
    push = P0 * DEPTH * 2 * RADIUS
    return {"position": np.full((1, 2), RADIUS), "radius": np.full(1, RADIUS), "body_ids": np.array([6]),
            "contact_ids": np.array([[0, 6], [2, 6], [1, 6], [3, 6]]), "contact_normal": np.array([[1., 0], [0, 1], [-1, 0], [0, -1]]),
            "contact_point": RADIUS * np.array([[0., 1], [1, 0], [2, 1], [1, 2]]), "contact_friction": np.full(4, mu),
            "box": 2 * RADIUS * np.array([0., 1, 0, 1]), "force_normal": np.full(4, push),
            "force_tangential": push * turned * np.array([-1, 1, -1, 1])}


def lattice(mu=0.3, wall_mu=0.2):
    """Rows of three and two disks on a triangular lattice, pressed by P0 with little friction. It has more contacts than balance needs."""
    rows, height = 5, math.sqrt(3) * RADIUS
    centres = np.array([[RADIUS * (1 + 2 * k + row % 2), RADIUS + row * height] for row in range(rows) for k in range(3 - row % 2)])
    box = np.array([0, 6 * RADIUS, 0, 2 * RADIUS + (rows - 1) * height])
    pairs, normals, points, friction = [], [], [], []
    for k, place in enumerate(centres):
        for wall, (axis, face, sign) in enumerate(((0, 0, 1), (0, 1, -1), (1, 2, 1), (1, 3, -1))):
            if abs(abs(place[axis] - box[face]) - RADIUS) < 1e-9:
                normal = np.eye(2)[axis] * sign
                pairs, normals = pairs + [(wall, 6 + k)], normals + [normal]
                points, friction = points + [place - RADIUS * normal], friction + [wall_mu]
        for other in range(k + 1, len(centres)):
            if np.linalg.norm(centres[other] - place) < 2.001 * RADIUS:
                pairs, normals = pairs + [(6 + k, 6 + other)], normals + [(centres[other] - place) / (2 * RADIUS)]
                points, friction = points + [(centres[other] + place) / 2], friction + [mu]
    packing = {"position": centres, "radius": np.full(len(centres), RADIUS), "body_ids": 6 + np.arange(len(centres)), "box": box, "contact_ids":
               np.array(pairs), "contact_normal": np.array(normals), "contact_point": np.array(points), "contact_friction": np.array(friction)}
    pressed = shakedown.elastic_change(packing, statics.wall_loads(packing, (P0, P0), DEPTH), 0.01)
    return packing | dict(zip(("force_normal", "force_tangential"), np.split(pressed, 2)))


def all_of(packing, kt_over_kn=0.5, path="constant", pressure=P0):
    found = shakedown.limits(packing, pressure, DEPTH, kt_over_kn, path)
    return np.array([found.first_slip, found.alternating, found.shakedown, found.ratchet, found.opening, found.static])


@pytest.mark.parametrize("mu, kt_over_kn", [(0.1, 0.5), (0.2, 0.5), (0.2, 1.0)])
@pytest.mark.parametrize("turned", [0.0, 0.03])
def test_a_contact_that_slips_to_and_fro(mu, kt_over_kn, turned):
    """As sigma2 rises and sigma1 falls by P0 dSigma, the two x walls brake the disk by b dSigma each, b = k/(1 + 2 k), k = k_t/k_n.

    For the springs k_n of the floor and k_t of the two walls share that rise. The movable x wall slips where |T| = mu (1 - dSigma): first at
    b dSigma + turned, which slip can replace by the best, b dSigma - mu. Without springs all holds until that wall is unloaded.
    """
    brake = kt_over_kn / (1 + 2 * kt_over_kn)
    exact = [(mu - turned) / (brake + mu), *[2 * mu / (brake + mu)] * 3, 1, 1]
    assert all_of(single_disk(mu, turned), kt_over_kn, "mean") == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("packing", [lattice(), lattice(0.1, 0.0), corner_pair(0.3, 0.2)], ids=["rough walls", "smooth walls", "pair"])
def test_limits_are_ordered_and_have_no_units(packing, path):
    first, alternating, shaken, ratchet, opening, static = limits = all_of(packing, path=path)
    assert 0 < first <= min(alternating, shaken * (1 + 1e-6)) and shaken <= min(ratchet, opening) * (1 + 1e-6)
    assert max(ratchet, opening) <= static * (1 + 1e-6)
    forces = {name: 7 * packing[name] for name in ("force_normal", "force_tangential")}
    assert all_of(packing | forces, path=path, pressure=7 * P0) == pytest.approx(limits, rel=1e-6)
    lengths = {name: 3 * packing[name] for name in ("position", "radius", "contact_point", "box")}
    assert all_of(packing | lengths, path=path, pressure=P0 / 3) == pytest.approx(limits, rel=1e-6)


def faces_by_hand(packing, kt_over_kn, path):
    """Return slack and rate of +-T - mu R of every contact, and A, C as dense matrices; all contacts with friction."""
    mu, load = packing["contact_friction"], statics.rising_load(packing, P0, DEPTH, path)
    balance, count = statics.balance_matrix(packing).toarray(), len(mu)
    springs = np.diag(np.repeat([1, kt_over_kn], count))
    change = -springs @ balance.T @ np.linalg.solve(balance @ springs @ balance.T, load)
    cone = np.block([[-np.diag(mu), np.eye(count)], [-np.diag(mu), -np.eye(count)]])
    forces = np.concatenate([packing["force_normal"], packing["force_tangential"]])
    return cone, -cone @ forces, cone @ change, balance, springs


@pytest.mark.parametrize("path", PATHS)
def test_shakedown_found_by_the_slips_themselves(path):
    """The unknowns are the slips; their springs and the stiffness matrix give the residual forces; both ends of the cycle are written out."""
    packing = lattice()
    cone, slack, rate, balance, springs = faces_by_hand(packing, 0.5, path)
    count = len(packing["contact_friction"])
    left = (springs - springs @ balance.T @ np.linalg.solve(balance @ springs @ balance.T, balance @ springs))[:, count:]
    unknowns = np.block([[cone @ left, np.zeros((2 * count, 1))], [cone @ left, rate[:, None]]])
    result = optimize.linprog(np.append(np.zeros(count), -1), unknowns, np.concatenate([slack, slack]), bounds=(None, None))
    limits = all_of(packing, path=path)
    assert limits[2] == pytest.approx(-result.fun, rel=1e-6) and limits[2] < 0.99 * limits[3]


@pytest.mark.parametrize("path", PATHS)
def test_ratchet_limit_is_koiters(path):
    """The least work of friction over that of the loads, among slips y >= 0 at both ends whose sum over the cycle is a motion v of the grains."""
    packing = lattice()
    cone, slack, rate, balance, _ = faces_by_hand(packing, 0.5, path)
    faces, motions = len(cone), len(balance)
    equations = np.block([[cone.T, cone.T, balance.T], [np.zeros(faces), rate, np.zeros(motions)]])
    result = optimize.linprog(np.concatenate([slack, slack, np.zeros(motions)]), None, None, equations, np.append(np.zeros(cone.shape[1]), 1),
                              [(0, None)] * (2 * faces) + [(None, None)] * motions)
    assert all_of(packing, path=path)[3] == pytest.approx(result.fun, rel=1e-6)
    opened = balance.T @ result.x[2 * faces:]
    slipped = result.x[:faces] + result.x[faces:2 * faces]
    assert opened[:faces // 2] == pytest.approx(packing["contact_friction"] * (slipped[:faces // 2] + slipped[faces // 2:]), abs=1e-6 * slipped.max())


def test_a_packing_is_rigid_if_its_normal_springs_leave_only_spins():
    assert shakedown.is_rigid(lattice())
    assert not shakedown.is_rigid(corner_pair(0.3, 0.2))  # five contacts, six freedoms


def test_a_contact_that_carries_nothing_slips_nowhere():
    packing = lattice()
    more = {name: np.concatenate([packing[name], packing[name][:1]]) for name in packing if name.startswith(("contact_", "force_"))}
    more["force_normal"][-1] = more["force_tangential"][-1] = 0
    assert all_of(packing | more)[:5] == pytest.approx(all_of(packing)[:5], rel=1e-6)


def test_forces_that_do_not_balance_are_refused():
    packing = lattice()
    packing["force_normal"][0] *= 2
    with pytest.raises(ResultError, match="do not balance P0"):
        all_of(packing)


def test_the_pair_of_smooth_walls_carries_no_change():
    with pytest.raises(ResultError, match="cannot carry a change"):
        all_of(corner_pair(0.5, 0.0))


def write(folder, packing, method="MD", more={}, **row):
    packing = {"angle": np.zeros(len(packing["position"]))} | packing
    return str(conftest.write_row(folder, {"method": method, **row}, snapshots={0.0: packing}, pressure=P0, depth=DEPTH, **more))


@pytest.mark.parametrize("path", PATHS)
def test_the_command_prints_the_limits(tmp_path, capsys, path):
    assert command.main(["limits", write(tmp_path, lattice(), stress_path=path)]) == 0
    first, alternating, shaken, ratchet, opening, static = (f"{limit:.4g}" for limit in all_of(lattice(), path=path))
    assert capsys.readouterr().out.splitlines() == [f"static limit {static}", f"opening limit {opening}", f"ratchet limit {ratchet}",
                                                    f"shakedown limit {shaken}", f"alternating slip {alternating}", f"first slip {first}"]


def test_the_command_tells_what_does_not_apply(tmp_path, capsys):
    assert command.main(["limits", write(tmp_path, lattice(), "CD")]) == 0
    assert "Rigid grains have the static limit only" in capsys.readouterr().out
    columns = conftest.history("MD") | {name: np.full(201, np.nan) for name in schema.OF_A_BOX}
    for seed, (packing, reason, more) in enumerate([(lattice() | {"box": np.full(4, np.nan)}, "no walls are loaded", {"columns": columns}),
                                                    (lattice() | {"force_normal": np.full(36, 1.0)}, "do not balance P0", {}),
                                                    (single_disk(0.3), "no limit", {})]):
        file = write(tmp_path, packing, more=more, seed=seed)
        assert command.main(["limits", file]) == 2
        said = capsys.readouterr().err
        assert said.startswith(f"analysis: {file}: ") and reason in said and said.count("\n") == 1
