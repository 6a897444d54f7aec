"""The longest stable time step of the springs that join the bodies in YADE's O, from their stiffness and dashpots.

YADE steps by v' = v + dt f(x, v)/m, x' = x + dt v' (leapfrog); its dashpots use the velocity v of half a step before. For a linear system with
the matrices M, C and K,

    x(n+1) - 2 x(n) + x(n-1) = -dt M^-1 C (x(n) - x(n-1)) - dt^2 M^-1 K x(n).

In a step a mode of frequency w and damping ratio z changes by the roots r of r^2 - (2 - 2 z s - s^2) r + (1 - 2 z s) = 0,
s = w dt. Both lie within the unit circle while 4 - 4 z s - s^2 > 0 (Jury's criterion; the first to leave it does so at r = -1), so

    s < 2 (sqrt(1 + z^2) - z).

Without damping this is the limit 2 of central differences; damping lowers it. For all modes at once: dt^2 K + 2 dt C < 4 M.

All contacts are taken as sticking, which is the stiffest case. A contact's stiffness and dashpot are its IPhys's kn and ks, cn and cs, in the plane
or in space; torques that a law adds to its forces are left out. Needs no compiled module.
"""
import math

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh

LIMIT = 4.0  # of the eigenvalues of dt^2 K + 2 dt C with respect to M


def largest_eigenvalue(mass, matrix):
    """Return the largest eigenvalue of `matrix` (symmetric, SciPy sparse) with respect to the diagonal `mass`."""
    scale = sparse.diags(1 / np.sqrt(mass))
    scaled = (scale @ matrix @ scale).tocsr()
    if scaled.shape[0] < 20:
        return float(np.linalg.eigvalsh(scaled.toarray())[-1])
    # A fixed start vector, since a random one would give other last bits in every run.
    return float(eigsh(scaled, k=1, which="LA", v0=np.ones(len(mass)), tol=1e-8, return_eigenvectors=False)[0])


def matrix_limit(mass, damping, stiffness):
    """Return the smallest dt [s] at which dt^2 K + 2 dt C has the eigenvalue 4 with respect to M; `mass` is the diagonal of M."""
    low, high = 0.0, 2 / math.sqrt(largest_eigenvalue(mass, stiffness))
    while high - low > 1e-4 * high:
        dt = (low + high) / 2
        low, high = (dt, high) if largest_eigenvalue(mass, dt**2 * stiffness + 2 * dt * damping) < LIMIT else (low, dt)
    return (low + high) / 2


class Bodies:
    """All bodies in O, as arrays: position and velocities of their centres, masses and moments of inertia. A body is a row, `row[id]` its number.

    owner: the row of the clump of which the body is a member, else its own. free: which of the six coordinates (x, y, z and rotations) can change,
    none of a member. radius: NaN unless it is a sphere.
    """

    def __init__(self):
        from yade import O
        found, names, owners = [], [], []
        engines = {type(engine).__name__: engine for engine in O.engines}
        slowed = "GlobalStiffnessTimeStepper" in engines and engines["NewtonIntegrator"].densityScaling  # without the stepper YADE prints a warning
        for body in O.bodies:
            state = body.state
            x, v, w, inertia, mass = state.pos, state.vel, state.angVel, state.inertia, state.mass
            if slowed:
                mass, inertia = mass / state.densityScaling, inertia / state.densityScaling
            found.append((x[0], x[1], x[2], v[0], v[1], v[2], w[0], w[1], w[2], mass, inertia[0], inertia[1], inertia[2],
                          getattr(body.shape, "radius", math.nan)))
            names.append((body.id, state.blockedDOFs))
            owners.append(body.clumpId if body.isClumpMember else body.id)
        table = np.array(found, float).reshape(-1, 14)
        self.ids = np.array([name for name, _ in names], int)
        self.row = np.full(self.ids.max(initial=-1) + 1, -1)
        self.row[self.ids] = np.arange(len(self.ids))
        self.owner = self.row[np.array(owners, int)]
        self.position, self.velocity, self.mass, self.radius = table[:, :3], table[:, 3:9], table[:, 9], table[:, 13]
        # YADE turns inertia with the body; the smallest moment about any axis gives a step that is too short rather than too long.
        turning = np.where(np.ptp(table[:, 10:13], axis=1)[:, None] > 0, table[:, 10:13].min(axis=1)[:, None], table[:, 10:13])
        self.masses = np.concatenate([np.repeat(self.mass[:, None], 3, axis=1), turning], axis=1)
        blocked = {dofs: [letter not in dofs for letter in "xyzXYZ"] for dofs in {dofs for _, dofs in names}}
        self.free = np.array([blocked[dofs] for _, dofs in names], bool).reshape(-1, 6)
        self.free &= (self.masses > 0) & (self.owner == np.arange(len(self.ids)))[:, None]

    def name(self, row):
        """Return how to call a body in a message."""
        return f"body #{self.ids[row]}"


class Springs:
    """The contacts of O that have stiffness, as arrays, and the matrices that they make for the six coordinates of all bodies.

    kn, ks [N/m], cn, cs [N s/m]: normal and tangential stiffness and dashpots; ks is 0 without friction. overlap [m]. shear: squared shear force
    [N^2]. ends: rows of both bodies.
    """

    def __init__(self, bodies):
        from yade import O
        self.bodies, self.periodic, found = bodies, O.periodic, []
        values = {}  # by the class of IPhys: which of these attributes it has
        added = sum(engine.ratio for engine in O.engines if type(engine).__name__ == "TangentialDashpots" and not engine.dead)
        for contact in O.interactions:
            if not contact.isReal:
                continue
            geom, phys = contact.geom, contact.phys
            kind = type(phys)
            if kind not in values:
                values[kind] = [hasattr(phys, name) for name in ("kn", "ks", "cn", "cs", "tangensOfFrictionAngle")]
            has = values[kind]
            if not has[0] or not hasattr(geom, "penetrationDepth"):
                continue
            kn, n, p = phys.kn, geom.normal, geom.contactPoint
            sticks = has[1] and not (has[4] and phys.tangensOfFrictionAngle == 0)
            cn = phys.cn if has[2] else 0.0
            cs = phys.cs if has[3] else added * cn
            found.append((contact.id1, contact.id2, kn, phys.ks if sticks else 0.0, cn, cs if sticks else 0.0, n[0], n[1], n[2],
                          geom.penetrationDepth, phys.shearForce.squaredNorm(), p[0], p[1], p[2]))
        table = np.array(found, float).reshape(-1, 14)
        self.ends = bodies.row[table[:, :2].astype(int)]
        self.kn, self.ks, self.cn, self.cs = table[:, 2:6].T
        self.normal, self.shear = table[:, 6:9], table[:, 10]
        self.overlap = np.nan_to_num(table[:, 9])  # YADE does not store it
        self.arms = [self._arms(side, table[:, 11:]) for side in (0, 1)]

    def __len__(self):
        return len(self.kn)

    def _arms(self, side, points):
        """Return the vectors from the centre of the body at one end of each contact, or from that of its clump, to the contact point."""
        end = self.ends[:, side]
        centre, owner = self.bodies.position[end], self.bodies.position[self.bodies.owner[end]]
        if not self.periodic:
            return points - owner
        # A contact point is near the first body, the second may lie a cell away from it; boundaries do not turn here.
        length = (1 - 2 * side) * (np.nan_to_num(self.bodies.radius[end]) - self.overlap / 2)
        return length[:, None] * self.normal + centre - owner

    def energy(self):
        """Return the elastic energy [J]."""
        turned = np.divide(self.shear, self.ks, out=np.zeros_like(self.shear), where=self.ks > 0)
        return float((self.kn * np.maximum(self.overlap, 0)**2 + turned).sum() / 2)

    def depths(self):
        """Return the overlaps over the smaller radius."""
        return np.nan_to_num(self.overlap / np.fmin(*self.bodies.radius[self.ends].T))

    def stiffest(self):
        """Return the largest k/m and c/m of a contact and a body that is free there, rows normal and tangential; zeros without contacts."""
        free = np.where(self.bodies.free[:, :3].any(axis=1), self.bodies.mass, math.inf)
        lightest = free[self.bodies.owner[self.ends]].min(axis=1)
        return np.array([[(values / lightest).max(initial=0) for values in pair] for pair in ((self.kn, self.ks), (self.cn, self.cs))]).T

    def _roots(self, normal, tangential):
        """Return H, rows (contact, 4) and columns (end, 6): H^T H is the matrix of contacts with these coefficients."""
        n = self.normal
        along = np.sqrt(normal)[:, None] * n
        across = np.sqrt(tangential)[:, None, None] * (np.eye(3) - n[:, :, None] * n[:, None, :])
        push = np.concatenate([along[:, None, :], across], axis=1)  # force directions, (contact, 4, 3)
        turn = [np.cross(arm[:, None, :], push) for arm in self.arms]
        return np.stack([np.concatenate([-push, -turn[0]], axis=2), np.concatenate([push, turn[1]], axis=2)], axis=2)

    def _matrix(self, normal, tangential, free):
        """Return the matrix of contacts with these coefficients, sparse, of the coordinates `free`."""
        roots = self._roots(normal, tangential)
        columns = np.where(free, np.cumsum(free).reshape(free.shape) - 1, -1)
        where = np.broadcast_to(columns[self.bodies.owner[self.ends]][:, None, :, :], roots.shape)
        rows = np.broadcast_to(np.arange(4 * len(roots)).reshape(-1, 4, 1, 1), roots.shape)
        kept = where >= 0
        matrix = sparse.csr_matrix((roots[kept], (rows[kept], where[kept])), shape=(4 * len(roots), int(free.sum())))
        return (matrix.T @ matrix).tocsr()

    def stiffness(self, free):
        """Return K, sparse, for the coordinates `free` of the bodies: a mask of the shape of Bodies.free."""
        return self._matrix(self.kn, self.ks, free)

    def matrices(self):
        """Return the diagonal of M, then C and K (sparse), for the free coordinates of all bodies; last the body (row) of each coordinate."""
        free = self.bodies.free
        return self.bodies.masses[free], self._matrix(self.cn, self.cs, free), self.stiffness(free), np.nonzero(free)[0]

    def traces(self, dt):
        """Return for every body the trace of its own block of dt^2 K + 2 dt C with respect to M: no eigenvalue of the block is larger."""
        scaled, owner = self._scaled(dt)
        return np.bincount(owner.ravel(), (scaled**2).sum(axis=(1, 3)).ravel(), len(self.bodies.ids))

    def eigenvalue(self, dt, traces):
        """Return the largest eigenvalue of dt^2 K + 2 dt C with respect to M: at LIMIT and above, `dt` is too long. Below, it may be an upper bound.

        A contact's energy is at most twice the sum of its energies with one and with the other body held. So no eigenvalue is above twice the
        largest one of a body's own block. traces: those of this dt.
        """
        tight = traces >= LIMIT / 2
        bound = 2 * float(traces[~tight].max(initial=0))
        if tight.any() and np.isfinite(traces).all():
            scaled, owner = self._scaled(dt)
            contact, side = np.nonzero(tight[owner])
            rows, blocks = scaled[contact, :, side], np.zeros((int(tight.sum()), 6, 6))
            np.add.at(blocks, (np.cumsum(tight) - 1)[owner[contact, side]], np.swapaxes(rows, 1, 2) @ rows)
            bound = max(bound, 2 * float(np.linalg.eigvalsh(blocks)[:, -1].max()))
        if bound < LIMIT or not np.isfinite(traces).all():
            return bound
        free = self.bodies.free
        return largest_eigenvalue(self.bodies.masses[free], self._matrix(*self._coefficients(dt), free))

    def _coefficients(self, dt):
        return dt**2 * self.kn + 2 * dt * self.cn, dt**2 * self.ks + 2 * dt * self.cs

    def _scaled(self, dt):
        """Return H of dt^2 K + 2 dt C, its columns divided by the square roots of the masses, and the moving body at each end of each contact."""
        owner, masses = self.bodies.owner[self.ends], self.bodies.masses
        scale = np.sqrt(np.divide(1, masses, out=np.zeros_like(masses), where=self.bodies.free))
        return self._roots(*self._coefficients(dt)) * scale[owner][:, None], owner

    def limit(self):
        """Return the largest stable step [s]; infinite without contacts."""
        mass, damping, stiffness, _ = self.matrices()
        return matrix_limit(mass, damping, stiffness) if stiffness.nnz else math.inf


def springs():
    """Return the Springs of O at this instant."""
    return Springs(Bodies())


def limit():
    """Return the largest stable step [s] of all that is in O together; infinite without contacts."""
    return springs().limit()


def safe_bound():
    """Return a step [s] that is stable for every packing in which no body is held more stiffly than here.

    A contact's energy is at most twice the sum of its energies with one and with the other body held. So w^2 <= 2 max w_i^2, where w_i is the
    largest frequency of body i with all others held; the same bound holds for dashpots.
    """
    mass, damping, stiffness, body = springs().matrices()
    blocks = [np.flatnonzero(body == k) for k in np.unique(body)]
    return min((matrix_limit(mass[block], 2 * damping[block][:, block], 2 * stiffness[block][:, block]) for block in blocks
                if stiffness[block][:, block].nnz), default=math.inf)
