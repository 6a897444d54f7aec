"""Writes the problem that the engine in YADE assembled; called from exportProblem (cd_engine/engine_methods.py)."""
import numpy as np

from .body_problem import BodyProblem
from . import write_problem


def write_step(path, bodies, inverse_masses, free_velocities, pairs, normals, arms, bias, mu, impulses, compliances, slip_bias):
    """Write the `BodyProblem` whose fields are given as bytes; without `bodies` its W, q and mu, and the two bodies of each contact."""
    pairs = np.frombuffer(pairs, np.int32).reshape(-1, 2)
    inverse_masses, free_velocities, normals, arms = (
        np.frombuffer(numbers).reshape(-1, width) for numbers, width in ((inverse_masses, 3), (free_velocities, 3), (normals, 2), (arms, 4)))
    problem = BodyProblem(inverse_masses, free_velocities, pairs, normals, arms, *map(np.frombuffer, (bias, mu, impulses, compliances, slip_bias)))
    if bodies:
        write_problem(path, problem)
    else:
        try:
            matrix = problem.delassus()
        except ValueError as error:
            raise ValueError(f"{error}. FCLIB cannot hold it: export it with bodies=True") from None
        write_problem(path, matrix, title="A step of Contact Dynamics", contact_ids=pairs)
