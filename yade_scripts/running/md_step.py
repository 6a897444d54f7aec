"""Computes the longest stable time step of the springs in O from their stiffness and dashpots (theory/spring_limits.py), and checks it before a run.

All contacts are taken as sticking, which is the stiffest case. More contacts may form in the run, so use a step well below the limit.
"""
import math

import numpy as np
from scipy import sparse
from yade import O
from yade.wrapper import Sphere

from yade_scripts.theory import spring_limits
from yade_scripts.errors import ParameterError
from yade_scripts.running import bodies


class StepError(ParameterError, RuntimeError):
    """O.dt is too long for the springs; the row cannot be run, or its run has to end."""


def check(full):
    """Raise StepError if O.dt is above the limit. Without contacts there is nothing to check."""
    mass, damping, stiffness = _matrices()
    if stiffness.nnz == 0:
        return
    matrix = O.dt**2 * stiffness + 2 * O.dt * damping
    if spring_limits.largest_eigenvalue(mass, matrix) >= 4:
        most = full["md_dt_factor"] * spring_limits.matrix_limit(mass, damping, stiffness) / O.dt
        stiffest = _free()[spring_limits.most_moved(mass, matrix) // 3]
        raise StepError(f"md_dt_factor = {full['md_dt_factor']}: the time integration of the springs is unstable if this is {most:.3g} or more "
                        f"(k_t/k_n = {full['kt_over_kn']}, beta_n = {full['beta_n'] * full['damping_factor']:g}); take at most half of that. "
                        f"The stiffest body is {_described(stiffest)}")


def _described(body):
    contacts = sum(body.id in (contact.id1, contact.id2) for contact in bodies.contacts())
    kind = "a disk" if isinstance(body.shape, Sphere) else "a wall"
    heavier = "" if isinstance(body.shape, Sphere) else ". With a larger wall_mass_ratio the limit rises"
    return f"{kind} with {contacts} contacts and a mass of {body.state.mass:.3g} kg{heavier}"


def limit():
    """Return the largest stable step [s] of all that is in O together."""
    return spring_limits.matrix_limit(*_matrices())


def safe_bound():
    """Return a step [s] that is stable for every packing in which no disk is held more stiffly than here.

    A contact's energy is at most twice the sum of its energies with one and with the other body held. So w^2 <= 2 max w_i^2, where w_i is the
    largest frequency of body i with all others held; the same bound holds for dashpots.
    """
    mass, damping, stiffness = _matrices()
    blocks = [slice(k, k + 3) for k in range(0, len(mass), 3)]
    return min(spring_limits.matrix_limit(mass[block], 2 * damping[block, block], 2 * stiffness[block, block])
               for block in blocks if stiffness[block, block].nnz and np.isfinite(mass[block]).any())


def _free():
    """Return the bodies that can move."""
    return [body for body in O.bodies if set("xyZ") - set(body.state.blockedDOFs)]


def _matrices():
    """Return the diagonal of M (infinite for a blocked coordinate), then C and K (sparse), for (x, y, spin) of every body that can move."""
    free, contacts = _free(), bodies.contacts()
    mass = np.array([math.inf if letter in body.state.blockedDOFs else value for body in free
                     for letter, value in zip("xyZ", (body.state.mass, body.state.mass, body.state.inertia[2]))])
    column = {body.id: 3 * k for k, body in enumerate(free)}
    along = _relative(contacts, column)
    return mass, along.T @ sparse.diags([contact.phys.cn for contact in contacts]) @ along, stiffness_matrix(contacts, column)


def stiffness_matrix(contacts, column):
    """Return K [N/m, N, N m] of the springs for (x, y, spin) of the bodies in column: {body: first of its three}; all contacts stick."""
    along, across = _relative(contacts, column), _relative(contacts, column, tangential=True)
    sticking = sparse.diags([contact.phys.ks if contact.phys.tangensOfFrictionAngle > 0 else 0.0 for contact in contacts])
    return along.T @ sparse.diags([contact.phys.kn for contact in contacts]) @ along + across.T @ sticking @ across


def _relative(contacts, column, tangential=False):
    """Return the sparse matrix that turns the velocities of bodies into the relative ones of the contacts, along the normal or across it.

    column: {body: the first of its three columns}.
    """
    rows, columns, values = [], [], []
    for row, contact in enumerate(contacts):
        x, y, _ = contact.geom.normal
        if tangential:
            x, y = -y, x
        for body, sign in ((contact.id1, -1), (contact.id2, 1)):
            if body in column:
                arm = contact.geom.contactPoint - O.bodies[body].state.pos
                rows += [row] * 3
                columns += range(column[body], column[body] + 3)
                values += sign * x, sign * y, sign * (arm[0] * y - arm[1] * x)
    return sparse.csr_matrix((values, (rows, columns)), shape=(len(contacts), 3 * len(column)))
