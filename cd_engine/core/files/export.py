"""Writes the problem that the engine in YADE assembled; called from exportProblem (cd_engine/engine_methods.py)."""
import numpy as np

from .body_problem import BodyProblem
from .space_bodies import SpaceBodyProblem, tangents
from . import write_problem


def write_step(path, bodies, *fields):
    """Write the problem whose numbers are given as bytes, in the order of `_in_plane`; without `bodies` its W, q and mu, and the two bodies of each
    contact."""
    inverse_masses, free_velocities, pairs, *of_contacts = map(np.frombuffer, fields, [float] * 2 + [np.int32] + [float] * 7)
    pairs = pairs.reshape(-1, 2)
    in_space = len(of_contacts[0]) == 3 * len(pairs) > 0
    problem = (_in_space if in_space else _in_plane)(inverse_masses, free_velocities, pairs, *of_contacts)
    if bodies:
        write_problem(path, problem)
    else:
        try:
            matrix = problem.delassus()
        except ValueError as error:
            raise ValueError(f"{error}. FCLIB cannot hold it: export it with bodies=True") from None
        write_problem(path, matrix, title="A step of Contact Dynamics", contact_ids=pairs)


def _in_plane(inverse_masses, free_velocities, pairs, normals, arms, bias, mu, impulses, compliances, slip_bias):
    return BodyProblem(inverse_masses.reshape(-1, 3), free_velocities.reshape(-1, 3), pairs, normals.reshape(-1, 2), arms.reshape(-1, 4), bias, mu,
                       impulses, compliances, slip_bias)


def _in_space(inverse_masses, free_velocities, pairs, normals, distances, bias, mu, impulses, compliances, slip_bias):
    """distances: of the contact from the centres of both bodies, along the normal; friction and the bias of the slip are vectors of the world."""
    normals, inverse, velocities = normals.reshape(-1, 3), inverse_masses.reshape(-1, 6), free_velocities.reshape(-1, 6).copy()
    axes = np.stack([normals, *tangents(normals)], axis=1)
    arms = np.concatenate([side * distances.reshape(-1, 2)[:, k:k + 1] * normals for k, side in ((0, 1), (1, -1))], axis=1)
    velocities[(inverse == 0).all(axis=1), 3:] = 0  # points of boundaries, met at the point itself
    p = impulses.reshape(-1, 4)
    p = np.column_stack([p[:, 0], np.einsum("nj,nkj->nk", p[:, 1:], axes[:, 1:])])
    slip = np.einsum("nj,nkj->nk", slip_bias.reshape(-1, 3), axes[:, 1:])
    compliances = compliances.reshape(-1, 2)
    return SpaceBodyProblem(inverse[:, :3], inverse[:, 3:, None] * np.eye(3), velocities, pairs, normals, arms, bias, mu, compliances, slip,
                            p.ravel())
