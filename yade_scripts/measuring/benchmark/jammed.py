"""Makes jammed packings of tens of thousands of disks within half a minute: it quenches soft disks at random places to a minimum of their enthalpy.

The disks repel by springs without friction, E = sum k d^2/2 over all overlaps d, and the walls hold the pressure P (O'Hern, Silbert, Liu & Nagel
2003, Phys. Rev. E 68, 011306, with the sides of the box as two more unknowns). Damped motion leads close to equilibrium; Contact Dynamics
removes the rest of the imbalance. YADE's springs would need half an hour instead of the half minute of these arrays. Needs no YADE.
"""
import numpy as np
from scipy.spatial import cKDTree

STIFFNESS = 1 / 6e-4  # of a contact, over P: the ratio of the paper's packings
FRACTION = 0.83       # solid fraction at the start of the quench, a little below the jammed one
BALANCED = 3e-2       # bound on the root mean square net force over the mean contact force, and on the pressure's error over P
MOST = 20000          # steps
ALONE = 500           # first steps, in a fixed box: the overlaps of random places would blow it up
KEPT = 0.98           # share of the speed that a step keeps; a smaller share gives looser packings
SKIN = 0.25           # distance beyond contact up to which pairs are listed, over the mean radius


class SoftDisks:
    """Soft disks in a box: their places in units of its sides (L_x, L_y) [m], and the forces on disks and box. The unit of force is P = 1 N/m."""

    def __init__(self, radii, draw):
        self.radii = radii
        side = np.sqrt(np.pi * np.sum(radii**2) / FRACTION)
        self.sides = np.array([side, side])
        self.places = draw.uniform(radii[:, None] / side, 1 - radii[:, None] / side, (len(radii), 2))
        self.listed = None

    def positions(self):
        """Return the centres, (N, 2) [m]."""
        return self.places * self.sides

    def _list(self, x):
        """List the pairs that may touch before any disk moves by half the skin; renew the list once one has."""
        skin = SKIN * self.radii.mean()
        if self.listed is None or np.max(np.sum((x - self.listed)**2, axis=1)) > (skin / 2)**2:
            self.listed = x
            i, j = cKDTree(x).query_pairs(2 * self.radii.max() + skin, output_type="ndarray").T
            near = np.sum((x[i] - x[j])**2, axis=1) < (self.radii[i] + self.radii[j] + skin)**2
            self.i, self.j = np.ascontiguousarray(i[near]), np.ascontiguousarray(j[near])
            self.reach = self.radii[self.i] + self.radii[self.j]

    def forces(self):
        """Return (N, 2) forces on the disks, forces that strain the box along x and y [N m], mean contact force [N]."""
        x, n = self.positions(), len(self.radii)
        self._list(x)
        way = x[self.j] - x[self.i]
        distance = np.hypot(*way.T)
        touching = np.flatnonzero(distance < self.reach)
        i, j, way, distance = self.i[touching], self.j[touching], way[touching], distance[touching]
        size = STIFFNESS * (self.reach[touching] - distance)
        push = way * (size / distance)[:, None]
        force = np.stack([np.bincount(j, push[:, k], n) - np.bincount(i, push[:, k], n) for k in (0, 1)], axis=1)
        virial = np.sum(push * way, axis=0)
        low = STIFFNESS * np.maximum(0, self.radii[:, None] - x)
        high = STIFFNESS * np.maximum(0, self.radii[:, None] - (self.sides - x))
        force = force + low - high
        # A strain of the box moves a disk at x in proportion to x: the high wall at L moves away from it in proportion to L - x.
        virial += np.sum(low * x + high * (self.sides - x), axis=0)
        return force, virial - self.sides.prod(), size.mean() if len(size) else 1.0


def jammed(radii, seed):
    """Return (N, 2) positions and (L_x, L_y) [m] of disks of these radii [m] near equilibrium under 1 N/m, drawn from `seed`.

    The disks are numbered anew along a Hilbert curve, so that neighbours have numbers near each other: their radii come third.
    """
    disks = SoftDisks(np.asarray(radii, float), np.random.default_rng(seed))
    n = len(radii)
    # The last row is the strain of the box, times a length that makes its stiffness comparable with a contact's.
    length = 2 * disks.radii.mean() * np.sqrt(n)
    velocity = np.zeros((n + 1, 2))
    dt = 0.4 / np.sqrt(STIFFNESS)
    for step in range(MOST):
        force, strain, scale = disks.forces()
        error = max(np.sqrt(np.mean(force**2)) / scale, np.abs(strain).max() / disks.sides.prod())
        if error < BALANCED and step > ALONE:
            order = np.argsort(hilbert(disks.places))
            return disks.positions()[order], disks.sides, disks.radii[order]
        force = np.vstack([force, strain / length if step > ALONE else (0, 0)])
        velocity = KEPT * velocity + dt * force
        disks.places += dt * velocity[:-1] / disks.sides
        disks.sides = disks.sides * np.exp(dt * velocity[-1] / length)
    raise RuntimeError(f"no equilibrium of {n} disks (seed {seed}) within {MOST} steps: the error is {error:.1e}, {BALANCED:g} is asked for")


def hilbert(places, bits=12):
    """Return the positions along Hilbert's curve of points in the unit square (Skilling 2004, AIP Conf. Proc. 707, 381, for two dimensions)."""
    x, y = np.clip((places * 2**bits).astype(np.int64), 0, 2**bits - 1).T
    along = np.zeros(len(x), np.int64)
    for bit in range(bits - 1, -1, -1):
        right, up = (x >> bit) & 1, (y >> bit) & 1
        along = 4 * along + ((3 * right) ^ up)
        turned, mask = up == 0, (1 << bit) - 1
        x, y = x & mask, y & mask
        flip = turned & (right == 1)
        x, y = np.where(flip, mask - x, x), np.where(flip, mask - y, y)
        x, y = np.where(turned, y, x), np.where(turned, x, y)
    return along
