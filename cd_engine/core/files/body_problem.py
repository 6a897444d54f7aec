"""A contact problem given by its bodies: sweeps use this form, which has no matrix."""
from dataclasses import dataclass, field

import numpy as np
from scipy import sparse

from .problem import Problem, array, place, refuse_friction, refuse_negative, refuse_sizes, whole_pairs

# As in contact_row.hpp: inverse effective mass along the normal over that of both directions; less is round-off of the normal, such as cos(pi/2).
HELD = 1e-29
UNIT = 1e-9  # largest error of the length of a normal: far above round-off, far below what changes a problem


@dataclass
class BodyProblem:
    """n contacts of one time step between N plane bodies. Impulses and velocities have two numbers a contact, normal then tangential.

    inverse_masses   (N, 3): 1/m along x and along y [1/kg], 1/I [1/(kg m^2)]; 0 where that degree of freedom is blocked
    free_velocities  (N, 3): v_x, v_y [m/s] and omega [rad/s] after the step's external forces and before any contact impulse
    pairs            (n, 2): the bodies a and b of each contact; the normal points from a to b, the impulse acts on b, its opposite on a
    normals          (n, 2): unit vectors n; t is n turned by +90 degrees
    arms             (n, 4): lever arms [m] of n and t about the centre of a, then of b: cross(r, n), cross(r, t) with r from there to the contact
    bias             (n,): added to the normal relative velocity [m/s]: gap/h, or Newton's restitution
    mu               (n,): Coulomb's friction coefficient, from 0 to 1e6
    impulses         (2n,): a first guess [N s], such as the solution of the step before; default: zero. `solve` starts from it only if told to
    compliances      (2n,): C [1/kg] of contacts with a stiffness, such as 1/(k_n h^2), 1/(k_t h^2); default: zero. The normal ones are all above 0 or
                     all 0. The law is then that of u + C p (contact_system.hpp)
    slip_bias        (n,): added to the tangential relative velocity [m/s] of such contacts; default: zero

    Sweeps visit the contacts in the order given, so contacts near in space should be near in the list. ValueError, with the place, is raised for
    any other input, and for a contact of two bodies that cannot move along its normal.
    """
    inverse_masses: np.ndarray
    free_velocities: np.ndarray
    pairs: np.ndarray
    normals: np.ndarray
    arms: np.ndarray
    bias: np.ndarray
    mu: np.ndarray
    impulses: np.ndarray = field(default=None)
    compliances: np.ndarray = field(default=None)
    slip_bias: np.ndarray = field(default=None)
    dimension = 2

    def __post_init__(self):
        bodies, n = (_length(name, getattr(self, name)) for name in ("inverse_masses", "mu"))
        self.inverse_masses = array("inverse_masses", self.inverse_masses, (bodies, 3))
        self.free_velocities = array("free_velocities", self.free_velocities, (bodies, 3))
        self.pairs = _pairs(self.pairs, n, bodies)
        self.normals = array("normals", self.normals, (n, 2))
        self.arms = array("arms", self.arms, (n, 4))
        self.bias = array("bias", self.bias, (n,))
        self.mu = array("mu", self.mu, (n,))
        self.impulses = np.zeros(2 * n) if self.impulses is None else array("impulses", self.impulses, (2 * n,))
        self.compliances = np.zeros(2 * n) if self.compliances is None else array("compliances", self.compliances, (2 * n,))
        self.slip_bias = np.zeros(n) if self.slip_bias is None else array("slip_bias", self.slip_bias, (n,))
        refuse_negative("inverse_masses", self.inverse_masses)
        refuse_negative("compliances", self.compliances)
        normal = self.compliances[::2] > 0
        if normal.any() != (normal.all() and n > 0) or not normal.any() and (self.compliances.any() or self.slip_bias.any()):
            raise ValueError("compliances: either all contacts have a normal compliance above 0, or none has any compliance or slip_bias")
        refuse_friction(self.mu)
        if (wrong := np.flatnonzero(np.abs(np.hypot(*self.normals.T) - 1) > UNIT)).size:
            raise ValueError(f"normals[{wrong[0]}] has the length {np.hypot(*self.normals[wrong[0]]):.12g}, not 1")
        along, across = (H.power(2).T @ self.inverse_masses.ravel() for H in (self._normals(), self._tangents()))
        if (wrong := np.flatnonzero(along <= HELD * (along + across))).size:
            a, b = self.pairs[wrong[0]]
            raise ValueError(f"contact {wrong[0]}: neither of its bodies {a} and {b} can move along its normal, as inverse_masses has it")
        refuse_sizes(self.velocities(np.zeros(2 * n)), np.repeat(along, 2))

    @property
    def contacts(self):
        return len(self.mu)

    def body_velocities(self, impulses):
        """Return the (N, 3) velocities of the bodies [m/s, rad/s] after the impulses [N s]."""
        p = array("impulses", impulses, (2 * self.contacts,))
        push = self._normals() @ p[::2] + self._tangents() @ p[1::2]
        return self.free_velocities + self.inverse_masses * push.reshape(-1, 3)

    def velocities(self, impulses):
        """Return the relative velocities u + C p [m/s] for impulses p [N s], 2n each; the biases are included."""
        v = self.body_velocities(impulses).ravel()
        return np.stack([self._normals().T @ v + self.bias, self._tangents().T @ v + self.slip_bias], axis=1).ravel() \
            + self.compliances * impulses

    def delassus(self):
        """Return the problem as a `Problem`: W = H^T M^-1 H + C, q = H^T v + bias. In a dense packing W takes four times the memory of this form."""
        H = sparse.hstack([self._normals(), self._tangents()]).tocsc()[:, np.arange(2 * self.contacts).reshape(2, -1).T.ravel()]
        # sqrt(M^-1) on either side, so that W is symmetric to the last bit.
        H = sparse.diags(np.sqrt(self.inverse_masses.ravel())) @ H
        H.eliminate_zeros()  # a body that does not move couples none of its contacts
        w = H.T @ H
        return Problem(w + sparse.diags(self.compliances) if self.compliances.any() else w, self.velocities(np.zeros(2 * self.contacts)), self.mu)

    def _normals(self):
        """Return a (3N, n) matrix: column i holds the forces and torques on all bodies of a unit impulse along the normal of contact i."""
        (nx, ny), (an, _, bn, _) = self.normals.T, self.arms.T
        return self._columns(-nx, -ny, -an, nx, ny, bn)

    def _tangents(self):
        """Return the same matrix for unit impulses along t = (-n_y, n_x)."""
        (nx, ny), (_, at, _, bt) = self.normals.T, self.arms.T
        return self._columns(ny, -nx, -at, -ny, nx, bt)

    def _columns(self, *entries):
        rows = (3 * self.pairs[:, :, None].astype(np.int64) + np.arange(3)).ravel()
        return sparse.csc_matrix((np.stack(entries, axis=1).ravel(), rows, np.arange(0, len(rows) + 1, 6)),
                                 shape=(self.inverse_masses.size, self.contacts))

    def __repr__(self):
        return f"<BodyProblem of {len(self.inverse_masses)} bodies, {self.contacts} contacts>"


def _length(name, values):
    try:
        return len(values)
    except TypeError:
        raise ValueError(f"{name} is not an array of numbers") from None


def _pairs(values, n, bodies):
    """Return the pairs as 32-bit integers. Raise ValueError unless each has two different bodies of the problem."""
    pairs = whole_pairs("pairs", values, n)
    if (wrong := np.argwhere((pairs < 0) | (pairs >= bodies))).size:
        raise ValueError(f"{place('pairs', wrong[0])} = {pairs[tuple(wrong[0])]}; the bodies are 0 to {bodies - 1}")
    if (wrong := np.flatnonzero(pairs[:, 0] == pairs[:, 1])).size:
        raise ValueError(f"pairs[{wrong[0]}]: body {pairs[wrong[0], 0]} touches itself")
    return pairs
