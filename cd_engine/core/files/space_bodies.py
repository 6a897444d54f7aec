"""A contact problem in space given by its bodies."""
from dataclasses import dataclass, field

import numpy as np
from scipy import sparse

from .body_problem import UNIT, _length, _pairs
from .problem import Problem, array, refuse_friction, refuse_negative, refuse_sizes


def tangents(normals):
    """Return two unit vectors (n, 3) for each unit normal (n, 3), orthogonal to it and to each other (Duff et al. 2017, JCGT 6)."""
    x, y, z = normals.T
    sign = np.where(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    b = x * y * a
    return np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=1), np.stack([b, sign + y * y * a, -y], axis=1)


@dataclass
class SpaceBodyProblem:
    """n contacts of one time step between N bodies in space. Impulses and velocities have three numbers a contact, along its normal and along its two
    `tangents`.

    inverse_masses    (N, 3): 1/m along x, y, z [1/kg]; 0 where that direction is blocked
    inverse_inertias  (N, 3, 3): inverse inertia tensors in the axes of the world [1/(kg m^2)], symmetric, without negative eigenvalues; 0: blocked.
                      (N,) for spheres
    free_velocities   (N, 6): velocity [m/s] and angular velocity [rad/s] after the step's external forces and before any contact impulse
    pairs             (n, 2): the bodies a and b of each contact; the normal points from a to b, the impulse acts on b, its opposite on a
    normals           (n, 3): unit vectors
    arms              (n, 6): from the centre of a to the contact [m], then from the centre of b
    bias              (n,): added to the normal relative velocity [m/s]: gap/h, or Newton's restitution
    mu                (n,): Coulomb's friction coefficient, from 0 to 1e6
    compliances       (n, 2): C [1/kg] of springs along the normal and across it, 1/(k h^2), added to the diagonal of W; default: 0, rigid
    slip_bias         (n, 2): added to the relative velocity along the two tangents [m/s], such as the force that a spring has already, times
                      -h C; default: 0
    impulses          (3n,): a first guess [N s]; default: zero. `solve` starts from it only if told to

    ValueError, with the place, is raised for any other input, and for a contact of two bodies that cannot move along its normal.
    """
    inverse_masses: np.ndarray
    inverse_inertias: np.ndarray
    free_velocities: np.ndarray
    pairs: np.ndarray
    normals: np.ndarray
    arms: np.ndarray
    bias: np.ndarray
    mu: np.ndarray
    compliances: np.ndarray = field(default=None)
    slip_bias: np.ndarray = field(default=None)
    impulses: np.ndarray = field(default=None)
    dimension = 3

    def __post_init__(self):
        bodies, n = (_length(name, getattr(self, name)) for name in ("inverse_masses", "mu"))
        self.inverse_masses = array("inverse_masses", self.inverse_masses, (bodies, 3))
        if np.ndim(self.inverse_inertias) == 1:
            self.inverse_inertias = array("inverse_inertias", self.inverse_inertias, (bodies,))[:, None, None] * np.eye(3)
        self.inverse_inertias = array("inverse_inertias", self.inverse_inertias, (bodies, 3, 3))
        self.free_velocities = array("free_velocities", self.free_velocities, (bodies, 6))
        self.pairs = _pairs(self.pairs, n, bodies)
        self.normals = array("normals", self.normals, (n, 3))
        self.arms = array("arms", self.arms, (n, 6))
        self.bias = array("bias", self.bias, (n,))
        self.mu = array("mu", self.mu, (n,))
        self.compliances = np.zeros((n, 2)) if self.compliances is None else array("compliances", self.compliances, (n, 2))
        self.slip_bias = np.zeros((n, 2)) if self.slip_bias is None else array("slip_bias", self.slip_bias, (n, 2))
        self.impulses = np.zeros(3 * n) if self.impulses is None else array("impulses", self.impulses, (3 * n,))
        for name in ("inverse_masses", "compliances"):
            refuse_negative(name, getattr(self, name))
        refuse_friction(self.mu)
        turned = self.inverse_inertias
        size = np.abs(turned).max(axis=(1, 2), initial=0)
        if (wrong := np.flatnonzero(np.abs(turned - turned.transpose(0, 2, 1)).max(axis=(1, 2), initial=0) > UNIT * size)).size:
            raise ValueError(f"inverse_inertias[{wrong[0]}] is not symmetric")
        if (wrong := np.flatnonzero(np.linalg.eigvalsh(turned)[:, 0] < -UNIT * size)).size:
            raise ValueError(f"inverse_inertias[{wrong[0]}] has a negative eigenvalue")
        length = np.linalg.norm(self.normals, axis=1)
        if (wrong := np.flatnonzero(np.abs(length - 1) > UNIT)).size:
            raise ValueError(f"normals[{wrong[0]}] has the length {length[wrong[0]]:.12g}, not 1")
        own = self._own()
        if (wrong := np.flatnonzero(own[:, 0] <= 1e-29 * own.sum(axis=1))).size:
            a, b = self.pairs[wrong[0]]
            raise ValueError(f"contact {wrong[0]}: neither of its bodies {a} and {b} can move along its normal, as inverse_masses has it")
        refuse_sizes(self.velocities(np.zeros(3 * n)), np.repeat(own[:, 0], 3))

    @property
    def contacts(self):
        return len(self.mu)

    def body_velocities(self, impulses):
        """Return the (N, 6) velocities of the bodies [m/s, rad/s] after the impulses [N s]."""
        push = (self._directions() @ array("impulses", impulses, (3 * self.contacts,))).reshape(-1, 6)
        return self.free_velocities + np.hstack([self.inverse_masses * push[:, :3], np.einsum("ijk,ik->ij", self.inverse_inertias, push[:, 3:])])

    def velocities(self, impulses):
        """Return the relative velocities u [m/s] for impulses p [N s], 3n each; the bias is included, and what springs give way."""
        u = (self._directions().T @ self.body_velocities(impulses).ravel()).reshape(-1, 3)
        u += np.column_stack([self.bias, self.slip_bias])
        return (u + np.asarray(impulses).reshape(-1, 3) * self.compliances[:, [0, 1, 1]]).ravel()

    def delassus(self):
        """Return the problem as a `Problem`: W = H^T M^-1 H + C, q = H^T v + bias."""
        H, mass = self._directions().tocsc(), self._inverse_mass()
        W = H.T @ mass @ H + sparse.diags(self.compliances[:, [0, 1, 1]].ravel())
        return Problem(0.5 * (W + W.T), self.velocities(np.zeros(3 * self.contacts)), self.mu, 3)

    def spheres(self):
        """Return the arrays that sweeps over spheres need, or None if the problem is not one for them.

        The normal of every contact passes through the centre of each of its bodies that can turn, whose inertia is the same about all axes; other
        bodies move alike in all directions, or along the normals of their contacts. All contacts have a stiffness, or none has and nothing drives
        bodies into each other: a solution exists.
        """
        own, turning = self._own(), self.inverse_inertias
        spin = turning[:, 0, 0]
        round_ = np.abs(turning - spin[:, None, None] * np.eye(3)).max(axis=(1, 2), initial=0) <= UNIT * np.abs(spin)
        still = (self.inverse_masses > 0) | (self.free_velocities[:, :3] == 0)
        sprung = (self.compliances[:, 0] > 0).all() and self.contacts > 0
        rigid = not (self.compliances.any() or self.slip_bias.any()) and still.all() and (self.bias >= 0).all()
        if not (round_.all() and (self.free_velocities[spin == 0, 3:] == 0).all() and (sprung or rigid)):
            return None
        arms = self.arms.reshape(-1, 2, 3)
        along = np.einsum("nki,ni->nk", arms, self.normals) * [1, -1]
        across = np.linalg.norm(arms - (along * [1, -1])[:, :, None] * self.normals[:, None], axis=2)
        turns = spin[self.pairs] > 0
        masses = self.inverse_masses[self.pairs].sum(axis=1)
        drift = masses * self.normals
        drift -= np.sum(drift * self.normals, axis=1)[:, None] * self.normals
        if (turns & ((across > UNIT * np.abs(along)) | (along <= 0))).any() or (np.abs(drift) > UNIT * masses.max(axis=1, initial=0)[:, None]).any() \
                or (np.abs(own[:, 1] - own[:, 2]) > UNIT * own[:, 1]).any():
            return None
        return (np.hstack([self.inverse_masses, np.repeat(spin[:, None], 3, axis=1)]), self.free_velocities, self.pairs, self.normals,
                np.where(turns, along, 0.0), self.bias, self.mu, self.compliances,
                np.einsum("nk,nkj->nj", self.slip_bias, np.stack(tangents(self.normals), axis=1)))

    def _inverse_mass(self):
        blocks = np.zeros((2 * len(self.inverse_masses), 3, 3))
        blocks[::2] = self.inverse_masses[:, :, None] * np.eye(3)
        blocks[1::2] = self.inverse_inertias
        return sparse.bsr_matrix((blocks, np.arange(len(blocks)), np.arange(len(blocks) + 1))).tocsr()

    def _own(self):
        """Return the diagonal of W without compliance, (n, 3)."""
        directions = np.stack([self.normals, *tangents(self.normals)], axis=1)
        own = np.zeros((self.contacts, 3))
        for k in (0, 1):
            body = self.pairs[:, k]
            turned = np.cross(self.arms[:, None, 3 * k:3 * k + 3], directions)
            own += np.einsum("nj,nij->ni", self.inverse_masses[body], directions**2)
            own += np.sum(turned @ self.inverse_inertias[body] * turned, axis=2)
        return own

    def _directions(self):
        """Return H, (6N, 3n): a column holds the forces and torques on all bodies of a unit impulse along a normal or a tangent."""
        n = self.contacts
        directions = np.stack([self.normals, *tangents(self.normals)], axis=1)  # (n, 3, 3)
        a, b = (np.cross(self.arms[:, None, k:k + 3], directions) for k in (0, 3))
        entries = np.concatenate([-directions, -a, directions, b], axis=2)  # (n, 3, 12)
        rows = (6 * self.pairs[:, :, None].astype(np.int64) + np.arange(6)).reshape(n, 1, 12).repeat(3, axis=1)
        return sparse.csc_matrix((entries.ravel(), rows.ravel(), np.arange(0, 36 * n + 1, 12)), shape=(2 * self.inverse_masses.size, 3 * n))

    def __repr__(self):
        return f"<SpaceBodyProblem of {len(self.inverse_masses)} bodies, {self.contacts} contacts>"
