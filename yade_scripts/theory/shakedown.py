"""The loads at which cycles of sigma2 between P0 and P0 (1 + dSigma) set slip going in a packing of springs, and keep it going. Needs no YADE.

Each contact has the springs k_n and k_t and Coulomb's cone |T| <= mu R. While the contacts stay closed and their places change little, the forces
are f(t) = f0 + dSigma(t) e + r(t): f0 those of the packing at rest, e the elastic response to the rising load, and r what slip has left behind.
Slips s of the contacts leave the forces in balance that their springs can produce,

    r = C (s - A^T q),    A r = 0,    so  r_n = -k_n (A^T q)_n  for some motion q of disks and walls, and r_t is free where there is friction

(C = diag(k_n, k_t), A the matrix of statics.balance_matrix, A^T q the relative displacements of the contacts). Only k_t/k_n matters.
All is linear in dSigma, so a cone holds for the whole cycle if it holds at both ends, and each limit is a linear programme:

first slip   The elastic forces f0 + dSigma e reach a cone. Below it nothing slips.
alternating  Some contact, with the R that it has at rest, needs more than the width 2 mu R of its cone for the change of T: it slips to and fro in
             every cycle. An estimate, since slip elsewhere changes R; where it leaves R alone it is an upper bound of the shakedown limit.
shakedown    Melan (1938): the largest dSigma with one r, constant in time and such as slip can make, that keeps all forces in their cones. If slip
             ever stops while contacts stay closed, the r that it leaves is one of these. Above the limit slip therefore goes on in every cycle,
             from whatever it started.
ratchet      Koiter (1960): the same with any r in balance (A r = 0). The dual programme seeks slips that add up over a cycle to a motion of the
             grains, A^T q, on which the loads do more work than friction dissipates; each slip opens its contact by mu times its length. Such slips
             cannot cancel each other, since all open. Contacts with this associated flow rule must therefore ratchet above the limit.
opening      The largest dSigma whose peak has any forces that slip can make, whatever r is elsewhere in the cycle. Beyond it some contact must be
             open at every peak.
static       statics.limit_loads: forces that balance, without springs.

    first slip <= shakedown <= ratchet <= static,    shakedown <= opening <= static,    first slip <= alternating

What holds for Coulomb's friction, whose slip does not open contacts (it is not associated):
- Radenkovic (C. R. Acad. Sci. 252, 4103 (1961)): every load that is carried is statically admissible, so the static limit bounds the true one from
  above. His bound from below, with contacts of zero dilation, is the static limit of smooth disks: dSigma of 0.06 to 0.14 in the dense
  packings of seeds 1 to 5; loose packings without friction do not even carry P0.
- "Slip goes on above the shakedown limit" is a necessary condition of rest and needs no flow rule. The converse, Melan's theorem proper, fails where
  slip changes the normal forces (Klarbring, Ciavarella and Barber, Int. J. Solids Struct. 44, 8355 (2007); uncoupled contacts are the exception):
  below the limit slip may stop or go on, as the initial forces decide. In packings of 100 disks MD slips on from about `alternating`, far below
  `shakedown`: residual forces that press a weak contact enough exist, but slip does not lead to them.
- Above `ratchet` slip goes on whatever residual forces there are, such as contacts that opened for a time may leave. That a mechanism progresses
  is proved for the associated rule only: by Coulomb's a contact may slip to and fro for ever without any net motion. `is_rigid` tells whether net
  strain is possible at all while contacts stay closed.
- Contacts that open: forces R = 0 at an opened contact without slip at its return are not among those that are admitted here, so a cycle in which
  contacts open can be free of slip above the shakedown limit. A contact of small R often sets that limit alone.
"""
from dataclasses import dataclass

import numpy as np
from scipy import optimize, sparse
from scipy.sparse import linalg

from yade_scripts.errors import ResultError
from yade_scripts.theory import statics

SOFT = 1e-15  # springs, over the stiffest, that hold what no contact holds
AT_REST = 1e-2  # largest of statics.violations for forces that count as those of a packing at rest


@dataclass(frozen=True)
class Limits:
    """The limits above, each as dSigma = sigma2/P0 - 1 of one stress path."""
    first_slip: float
    alternating: float
    shakedown: float
    ratchet: float
    opening: float
    static: float


def limits(snapshot, pressure, depth, kt_over_kn, stress_path="constant"):
    """Return the Limits of a packing at rest under P0 [Pa], with the forces of the snapshot (schema.SNAPSHOT) as f0. 400 disks: 3 s.

    Raise ResultError if no wall is loaded or the forces are not those of rest under P0.
    """
    static = statics.limit_loads(snapshot, pressure, depth, stress_path)[1] - 1
    packing = _loaded(snapshot)
    balance, forces = statics.balance_matrix(packing), np.concatenate([packing["force_normal"], packing["force_tangential"]])
    scale = packing["force_normal"].mean()
    wrong = statics.violations(packing, *np.split(forces, 2), statics.wall_loads(packing, (pressure, pressure), depth)).max()
    if not wrong <= AT_REST:
        raise ResultError("a snapshot", f"its forces do not balance P0 on all walls within Coulomb's cones: they are off by {wrong:.1g} mean contact "
                          "forces", "take a run that starts from a packing at rest under P0")
    change = elastic_change(packing, statics.rising_load(packing, pressure, depth, stress_path), kt_over_kn)
    faces = _faces(packing["contact_friction"])
    slack, outward = np.maximum(-faces @ forces, 0) / scale, faces @ change / scale
    made, any_balanced = _made_by_slip(packing, balance), _with_friction(packing)
    both_ends, rough = np.maximum(outward, 0), np.count_nonzero(packing["contact_friction"])

    def width(values):
        """Return the sum of the two faces of each cone."""
        return values[:rough] + values[rough:2 * rough]

    return Limits(first_slip=_reached(slack, outward), alternating=_reached(width(slack), width(both_ends)),
                  shakedown=_largest(faces, slack, both_ends, made, balance), ratchet=_largest(faces, slack, both_ends, any_balanced, balance),
                  opening=_largest(faces, slack, outward, made, balance), static=static)


def _reached(slack, outward):
    """Return the least s > 0 at which some s outward exceeds its slack."""
    towards = outward > 0
    return float(np.min(slack[towards] / outward[towards], initial=np.inf))


def elastic_change(packing, load, kt_over_kn):
    """Return the change of (R, T) [N], T in all contacts after R in all, by which springs without slip balance a `load` [N] on the bodies.

    A contact without friction has no tangential spring. Raise ResultError if the springs cannot balance the load.
    """
    balance, rough = statics.balance_matrix(packing), packing["contact_friction"] > 0
    springs = sparse.diags(np.concatenate([np.ones(len(rough)), kt_over_kn * rough]))
    stiffness = (balance @ springs @ balance.T).tocsc()
    held = np.flatnonzero(stiffness.diagonal() > 0)
    stiffness = stiffness[held][:, held]
    motion = np.zeros(len(load))
    motion[held] = linalg.spsolve(stiffness + SOFT * stiffness.max() * sparse.identity(len(held), format="csc"), load[held])
    change = -springs @ (balance.T @ motion)
    if not np.abs(balance @ change + load).max() <= 1e-6 * np.abs(load).max():
        raise ResultError("a snapshot", "its contacts cannot carry a change of the load without moving", "take a packing with more contacts")
    return change


def is_rigid(snapshot):
    """Return whether no motion that leaves the length of all normal springs moves a disk's centre or a wall.

    If so, a steady cycle whose contacts stay closed has no net strain: its net motion leaves all R as they were, so it can only turn disks. Strain
    that grows from cycle to cycle then comes from contacts that open and close, or from the change of the geometry.
    """
    packing = _loaded(snapshot)
    stretch = _translations(packing, statics.balance_matrix(packing)).toarray()
    moved = np.abs(stretch).sum(axis=0) > 0  # not the disks without contacts
    return bool(np.linalg.matrix_rank(stretch) == moved.sum())


def _loaded(snapshot):
    """Return the snapshot without the contacts that carry nothing."""
    loaded = snapshot["force_normal"] > 0
    return {name: values[loaded] if name.startswith(("contact_", "force_")) else values
            for name, values in snapshot.items() if isinstance(values, np.ndarray)}


def _faces(friction):
    """Return the matrix of the cones, F (R, T) <= 0: T - mu R and -T - mu R for each contact with friction, -R for each without."""
    mu, one = sparse.diags(friction), sparse.identity(len(friction), format="csr")
    rough = friction > 0
    none = sparse.csr_matrix(one.shape)
    return sparse.vstack([sparse.hstack([-mu, one]).tocsr()[rough], sparse.hstack([-mu, -one]).tocsr()[rough],
                          sparse.hstack([-one, none]).tocsr()[~rough]]).tocsr()


def _translations(packing, balance):
    """Return the matrix that turns the translations of disks and walls into the normal displacements of the contacts."""
    count, disks = len(packing["contact_friction"]), len(packing["body_ids"])
    spins = np.zeros(balance.shape[0], bool)
    spins[2:3 * disks:3] = True
    return balance[:, :count].T.tocsc()[:, ~spins]


def _tangential(packing):
    """Return the matrix that places the T of the contacts with friction among the T of all."""
    rough = packing["contact_friction"] > 0
    return sparse.identity(len(rough), format="csc")[:, rough]


def _made_by_slip(packing, balance):
    """Return the matrix that turns (q, T) into (R, T), R = -(A^T q)_n: with A r = 0 the forces that slips can leave."""
    return sparse.block_diag([-_translations(packing, balance), _tangential(packing)]).tocsr()


def _with_friction(packing):
    """Return the matrix that turns R and the T of contacts with friction into the (R, T) of all."""
    return sparse.block_diag([sparse.identity(len(packing["contact_friction"])), _tangential(packing)]).tocsr()


def _largest(faces, slack, outward, space, balance):
    """Return the largest s for which some r = space x in balance has F r + s outward <= slack."""
    count = space.shape[1]
    equations = sparse.hstack([balance @ space, sparse.csr_matrix((balance.shape[0], 1))])
    cones = sparse.hstack([faces @ space, sparse.csr_matrix(outward[:, None])])
    goal = np.zeros(count + 1)
    goal[-1] = -1
    result = optimize.linprog(goal, cones, slack, equations, np.zeros(balance.shape[0]), [(None, None)] * count + [(0, None)], "highs-ipm")
    if not result.success:
        raise ResultError("a snapshot", f"there is no limit of its cycles ({result.message})", "check that its disks touch the walls")
    return float(result.x[-1])
