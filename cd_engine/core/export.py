"""Writes the problem that the engine in YADE assembled; called from cd_engine/yade_plugin/next_problem.cpp."""
import numpy as np
from scipy import sparse

from .body_problem import BodyProblem
from .files import write_problem
from .problem import Problem


def write_step(path, start, column, blocks, q, mu, ids):
    """Write W in rows of 2 x 2 blocks, q and mu, all given as bytes; ids: the two bodies of each contact, the normal pointing to the second."""
    q = np.frombuffer(q)
    blocks = np.frombuffer(blocks).reshape(-1, 2, 2)
    start, column = np.frombuffer(start, np.int64), np.frombuffer(column, np.int32)
    W = sparse.bsr_matrix((blocks, column, start), shape=(len(q), len(q))) if len(blocks) else sparse.csr_matrix((0, 0))
    write_problem(path, Problem(W, q, np.frombuffer(mu)), title="A step of Contact Dynamics",
                  contact_ids=np.frombuffer(ids, np.int32).reshape(-1, 2))


def write_bodies(path, inverse_masses, free_velocities, pairs, normals, arms, bias, mu, impulses):
    """Write a `BodyProblem` whose fields are given as bytes."""
    pairs = np.frombuffer(pairs, np.int32).reshape(-1, 2)
    inverse_masses, free_velocities, normals, arms = (
        np.frombuffer(numbers).reshape(-1, width) for numbers, width in ((inverse_masses, 3), (free_velocities, 3), (normals, 2), (arms, 4)))
    write_problem(path, BodyProblem(inverse_masses, free_velocities, pairs, normals, arms, *map(np.frombuffer, (bias, mu, impulses))))
