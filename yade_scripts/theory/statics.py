"""Computes the balance of forces on the grains in the box and the contact forces that it admits. It shares no code with the contact solvers.

Forces of a contact as in `yade_scripts.results.schema`: R along the normal, compression positive, T along the normal turned by +90 degrees,
both on the second body. SI units.
"""
import numpy as np
from scipy import optimize, sparse

from yade_scripts.errors import ResultError

# Walls that are free to move along their normal in the biaxial box: (id, axis). The opposite walls are fixed.
FREE_WALLS = ((1, 0), (3, 1))


def balance_matrix(snapshot):
    """Return A with A (R, T) = resultants on the free bodies: force along x and y and torque over radius of each disk [N], then the two walls.

    Columns are the contacts' R, then their T. Torques are divided by the disk's radius so that all rows are forces.
    """
    ids, normal, point = (snapshot[name] for name in ("contact_ids", "contact_normal", "contact_point"))
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    row_of = {body: 3 * k for k, body in enumerate(snapshot["body_ids"].tolist())}
    walls = {wall: (3 * len(row_of) + k, axis) for k, (wall, axis) in enumerate(FREE_WALLS)}
    matrix = sparse.lil_matrix((3 * len(row_of) + len(walls), 2 * len(ids)))
    for k, pair in enumerate(ids.tolist()):
        for body, sign in zip(pair, (-1, 1)):
            for column, direction in ((k, normal[k]), (k + len(ids), tangent[k])):
                if body in row_of:
                    row = row_of[body]
                    arm = (point[k] - snapshot["position"][row // 3]) / snapshot["radius"][row // 3]
                    matrix[row, column], matrix[row + 1, column] = sign * direction
                    matrix[row + 2, column] = sign * (arm[0] * direction[1] - arm[1] * direction[0])
                elif body in walls:
                    row, axis = walls[body]
                    matrix[row, column] = sign * direction[axis]
    return matrix.tocsr()


def wall_loads(snapshot, stresses, depth):
    """Return the forces [N] of (sigma1, sigma2) [Pa] on the free bodies, in the rows of `balance_matrix`."""
    x_low, x_high, y_low, y_high = snapshot["box"]
    load = np.zeros(3 * len(snapshot["body_ids"]) + len(FREE_WALLS))
    load[-2:] = -stresses[0] * (y_high - y_low) * depth, -stresses[1] * (x_high - x_low) * depth
    return load


def rising_load(snapshot, pressure, depth, stress_path):
    """Return by how much the loads [N] on the free bodies change when sigma2 rises by P0 [Pa], which is a dSigma of 1, along a stress path."""
    return wall_loads(snapshot, {"constant": (0, pressure), "mean": (-pressure, pressure)}[stress_path], depth)


def violations(snapshot, normal, tangential, load):
    """Return how far networks (R and T, one row each, [N]) are from admissible: three columns, over the network's mean R.

    They are the largest resultant on a body, the largest |T| - mu R, and the largest tension -R. The last two are negative inside the cone.
    """
    normal, tangential = np.atleast_2d(normal), np.atleast_2d(tangential)
    resultant = np.hstack([normal, tangential]) @ balance_matrix(snapshot).T + load
    excess = np.abs(tangential) - snapshot["contact_friction"] * normal
    scale = np.array([row[row > 0].mean() for row in normal])
    return np.stack([np.abs(resultant).max(axis=1), excess.max(axis=1), (-normal).max(axis=1)], axis=1) / scale[:, None]


def degrees_of_freedom(snapshot, loaded):
    """Return (M, N, dimension) of the networks on the contacts of the mask `loaded`: contacts, disks with such contacts, unknowns minus equations.

    The dimension is 2M - 3N minus one for each free wall. A contact without friction has only one unknown, and a disk with only such contacts has
    no equation for its torque.
    """
    rough = snapshot["contact_friction"] > 0
    held, turned = (np.isin(snapshot["body_ids"], snapshot["contact_ids"][mask]).sum() for mask in (loaded, loaded & rough))
    unknowns = loaded.sum() + (loaded & rough).sum()
    return int(loaded.sum()), int(held), int(unknowns - 2 * held - turned - len(FREE_WALLS))


def dimension(snapshot, loaded):
    """Return the dimension of degrees_of_freedom by the rank of the equations, which may be dependent: exact, a second for 400 disks."""
    unknowns = np.flatnonzero(np.concatenate([loaded, loaded & (snapshot["contact_friction"] > 0)]))
    return len(unknowns) - int(np.linalg.matrix_rank(balance_matrix(snapshot)[:, unknowns].toarray()))


def limit_loads(snapshot, pressure, depth, stress_path="constant"):
    """Return (least, largest) sigma2/P0 at which the contacts admit any forces under sigma1 = P0: the static theorem of limit analysis.

    stress_path: "mean" for sigma1 = 2 P0 - sigma2.
    Beyond these loads rigid contacts cannot hold the sample in its present geometry. Between them they need not hold it: Coulomb's friction is not
    associated, so that the largest is only an upper bound of the load that is carried (Radenkovic 1961).
    """
    if not np.isfinite(snapshot["box"]).all():
        raise ResultError("a snapshot", "no walls are loaded in it", "take a run of a packing under P0")
    rising = rising_load(snapshot, pressure, depth, stress_path)
    constant = wall_loads(snapshot, (pressure, pressure), depth) - rising
    goal = np.zeros(2 * len(snapshot["contact_ids"]) + 1)
    goal[-1] = 1
    return _extremes(snapshot, goal, constant, rising)


def force_range(snapshot, load, contact):
    """Return (least, largest) R [N] that admissible networks under `load` can put on one contact."""
    goal = np.zeros(2 * len(snapshot["contact_ids"]) + 1)
    goal[contact] = 1
    return tuple(np.abs(load).max() * value for value in _extremes(snapshot, goal, load, np.zeros_like(load)))


def _extremes(snapshot, goal, load, rising):
    """Return (least, largest) goal . (R, T, s) over all admissible forces under load + s rising [N], in units of the largest load.

    In the plane two straight lines bound Coulomb's cone, so these are linear programmes. Interior points take 5 s for 1600 disks, the simplex
    method minutes; both agree to 1e-8.
    """
    count, mu = len(snapshot["contact_ids"]), sparse.diags(snapshot["contact_friction"])
    one, none = sparse.identity(count), sparse.csr_matrix((count, 1))
    unit = np.abs(load).max()
    cone = sparse.bmat([[-mu, one, none], [-mu, -one, none]])
    balance = sparse.hstack([balance_matrix(snapshot), sparse.csr_matrix(rising[:, None] / unit)])
    bounds = [(0, None)] * count + [(None, None)] * count + [(None, None) if rising.any() else (0, 0)]
    found = []
    for sign in (1, -1):
        result = optimize.linprog(sign * goal, cone, np.zeros(2 * count), balance, -load / unit, bounds, "highs-ipm")
        if not result.success:
            raise ResultError("a snapshot", f"there is no limit, as its contacts carry any load or none ({result.message})",
                              "check that its disks touch the walls")
        found.append(sign * float(result.fun))
    return tuple(found)
