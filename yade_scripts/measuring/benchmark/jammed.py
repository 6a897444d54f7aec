"""Makes jammed packings of tens of thousands of disks within seconds: it quenches soft disks at random places to a minimum of their enthalpy.

Springs without friction, E = sum k d^2/2 over all overlaps d, and walls that hold the pressure P (O'Hern, Silbert, Liu & Nagel 2003,
Phys. Rev. E 68, 011306, with the box as two more unknowns), sought by damped motion. It ends close to mechanical equilibrium; what is left
Contact Dynamics settles. YADE's springs would need half an hour for what takes half a minute in arrays. Needs no YADE.
"""
import numpy as np
from scipy.spatial import cKDTree

STIFFNESS = 1 / 6e-4  # of a contact over P: the ratio of the paper's packings
FRACTION = 0.83       # solid fraction of the random places the quench begins with, a little below the jammed one
BALANCED = 3e-2       # root mean square of the net forces, and error of the pressure, over the mean contact force and P
MOST = 20000          # steps
ALONE = 500           # of these in a box that stands still: the random places overlap, and would blow it up
KEPT = 0.98           # share of the speed that a step keeps; less, and the packing freezes looser
SKIN = 0.25           # pairs are kept to this share of the mean radius beyond contact


class JammingError(RuntimeError):
    """The quench did not come to an equilibrium."""


class SoftDisks:
    """Places in units of the box, sides (L_x, L_y) [m], and the forces on both; stiffness in units of P = 1 N/m."""

    def __init__(self, radii, draw):
        self.radii = radii
        side = np.sqrt(np.pi * np.sum(radii**2) / FRACTION)
        self.sides = np.array([side, side])
        self.places = draw.uniform(radii[:, None] / side, 1 - radii[:, None] / side, (len(radii), 2))
        self.listed = None

    def positions(self):
        """Return (N, 2) [m]."""
        return self.places * self.sides

    def _list(self, x):
        """Return the pairs that may touch before anything has moved by half the skin."""
        skin = SKIN * self.radii.mean()
        if self.listed is None or np.max(np.sum((x - self.listed)**2, axis=1)) > (skin / 2)**2:
            self.listed = x
            pairs = cKDTree(x).query_pairs(2 * self.radii.max() + skin, output_type="ndarray")
            i, j = pairs.T
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
        # Scaling the box with the disks moves those at the high wall away from it by what the wall moves more than they do.
        virial += np.sum(low * x + high * (self.sides - x), axis=0)
        return force, virial - self.sides.prod(), size.mean() if len(size) else 1.0


def jammed(radii, seed):
    """Return (N, 2) positions and (L_x, L_y) [m] of disks of these radii [m] near equilibrium under 1 N/m, drawn from `seed`.

    The disks are numbered anew along a Hilbert curve, so that neighbours have numbers near each other: their radii come third.
    """
    disks = SoftDisks(np.asarray(radii, float), np.random.default_rng(seed))
    n = len(radii)
    # One row more: the strain of the box, in the length that makes its stiffness that of a contact.
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
    raise JammingError(f"no equilibrium of {n} disks (seed {seed}) within {MOST} steps: the error is {error:.1e}, {BALANCED:g} is asked for")


def hilbert(places, bits=12):
    """Return the positions along Hilbert's curve of points in the unit square (Skilling 2004, AIP Conf. Proc. 707, 381, in two dimensions)."""
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
