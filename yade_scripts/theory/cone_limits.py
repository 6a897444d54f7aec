"""The static limit of a packing of spheres: the largest load that its contact forces can carry within Coulomb's circular cones.

Shares no code with the contact solvers. Forces as in `yade_scripts.results.schema`, in space. SI units.
"""
import numpy as np
from scipy import optimize, sparse

from yade_scripts.errors import ResultError

FREE_WALLS = ((1, 0), (3, 1), (5, 2))  # (id, axis); the opposite walls are fixed
FIRST_CUTS = 8  # planes around each cone in the first linear programme
SHARPNESS = 3e-3  # share of mu R by which |T| may exceed it in the end; both bounds then differ by less than this
MOST_ROUNDS = 30  # for each bound
TINY = 1e-8  # of the largest normal force: to which interior points solve


def _tangents(normal):
    """Return two unit vectors for each normal, orthogonal to it and to each other."""
    helper = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    first = np.cross(normal, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normal, first)


def balance_matrix(snapshot, directions):
    """Return A with A (f_1, f_2, f_3) = resultants on the free bodies: force and torque over radius of each sphere [N], then the three walls.

    directions: three arrays of unit vectors, a row a contact; f_k are the components of the force on its second body along them.
    """
    ids, centre, radius = snapshot["contact_ids"], snapshot["position"], snapshot["radius"]
    row_of = np.full(ids.max() + 1, -1)
    row_of[snapshot["body_ids"]] = np.arange(len(radius))
    count, spheres = len(ids), len(radius)
    rows, columns, values = [], [], []
    for side, sign in ((0, -1.0), (1, 1.0)):
        body = row_of[ids[:, side]]
        held = body >= 0
        arm = (snapshot["contact_point"][held] - centre[body[held]]) / radius[body[held], None]
        for k, direction in enumerate(directions):
            force = sign * direction[held]
            for axis, part in enumerate(np.hstack([force, np.cross(arm, force)]).T):
                rows.append(6 * body[held] + axis)
                columns.append(np.flatnonzero(held) + k * count)
                values.append(part)
            for number, (wall, axis) in enumerate(FREE_WALLS):
                touched = np.flatnonzero(ids[:, side] == wall)
                rows.append(np.full(len(touched), 6 * spheres + number))
                columns.append(touched + k * count)
                values.append(sign * direction[touched, axis])
    return sparse.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
                             shape=(6 * spheres + len(FREE_WALLS), 3 * count))


def wall_loads(snapshot, stresses):
    """Return the forces [N] of (sigma1, sigma2, sigma3) [Pa] on the free bodies, in the rows of `balance_matrix`."""
    x, y, z = np.diff(snapshot["box"].reshape(3, 2)).ravel()
    load = np.zeros(6 * len(snapshot["radius"]) + len(FREE_WALLS))
    load[-3:] = -np.array(stresses) * (y * z, x * z, x * y)
    return load


def limit_load(snapshot, pressure):
    """Return (below, above), between which lies the largest sigma2/P0 that the contacts can carry while sigma1 = sigma3 = P0.

    This is the static theorem of limit analysis. Since Coulomb's friction is not associated, rigid grains may move already below this load
    (Radenkovic 1961). Planes around a cone contain it, so a linear programme gives an upper bound. Each round adds, at every contact whose force lies
    outside its cone, the plane that touches the cone there (Kelley's cutting planes). The lower bound is the load that is found for a friction
    smaller by SHARPNESS, once all its forces lie inside the true cones.

    Raise ResultError if the contacts carry no such stresses, if they carry any load, and if a programme cannot be solved.

    Half a minute for 500 spheres, a quarter of an hour for 2000.
    """
    count, mu = len(snapshot["contact_ids"]), snapshot["contact_friction"]
    normal = snapshot["contact_normal"]
    first, second = _tangents(normal)
    balance = balance_matrix(snapshot, (normal, first, second))
    constant, rising = wall_loads(snapshot, (pressure, 0, pressure)), wall_loads(snapshot, (0, pressure, 0))
    unit = np.abs(constant).max()
    rough = np.flatnonzero(mu > 0)
    contact = np.repeat(rough, FIRST_CUTS)
    angle = np.tile(2 * np.pi * np.arange(FIRST_CUTS) / FIRST_CUTS, len(rough))
    upper = np.where(np.concatenate([np.zeros(count), mu == 0, mu == 0]), 0.0, np.inf)  # a contact without friction has no tangential force
    bounds = np.stack([np.concatenate([np.zeros(count), -upper[count:]]), np.concatenate([np.full(count, np.inf), upper[count:]])], axis=1)
    bounds = np.vstack([bounds, (0, np.inf)])
    equations = sparse.hstack([balance, sparse.csr_matrix(rising[:, None] / unit)]).tocsr()
    goal = np.zeros(3 * count + 1)
    goal[-1] = -1

    def solve(share):
        """Return the linear programme's load with friction coefficients multiplied by share, and at each rough contact |T|, mu R and T's angle."""
        rows = np.arange(len(contact))
        cone = sparse.csr_matrix((np.concatenate([-share * mu[contact], np.cos(angle), np.sin(angle)]),
                                  (np.tile(rows, 3), np.concatenate([contact, contact + count, contact + 2 * count]))),
                                 shape=(len(contact), 3 * count + 1))
        result = optimize.linprog(goal, cone, np.zeros(len(contact)), equations, -constant / unit, bounds, "highs-ipm")
        if not result.success:
            what = {2: "its contacts cannot carry P0 along x and z", 3: "its contacts carry any load"}.get(result.status, result.message)
            raise ResultError("a snapshot", f"it has no static limit: {what}", "check that its spheres touch the walls")
        force, one, two = result.x[:-1].reshape(3, count)
        size = np.hypot(one, two)[rough]
        return -result.fun, size - TINY * force.max(), mu[rough] * force[rough], np.arctan2(two, one)

    def bound(share, allowed):
        """Return the load for this share of the friction, once no |T| exceeds `allowed` times mu R."""
        nonlocal contact, angle
        for _ in range(MOST_ROUNDS):
            load, size, largest, direction = solve(share)
            if not (outside := rough[size > allowed * largest]).size:
                return load
            contact, angle = np.append(contact, outside), np.append(angle, direction[outside])
        raise ResultError("a snapshot", f"its static limit was not found in {MOST_ROUNDS} rounds", "raise SHARPNESS in cone_limits.py")

    above = bound(1.0, 1 + SHARPNESS)
    return bound(1 - SHARPNESS, 1.0), above
