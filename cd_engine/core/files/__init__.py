"""Reads a contact problem from a file of any supported format, and writes one."""
import os

from . import body_file, fclib, siconos_text
from .body_problem import BodyProblem
from .problem import Problem
from .space_bodies import SpaceBodyProblem


def read_problem(path):
    """Return the `Problem`, of the plane or of space, in a file of FCLIB (HDF5, local or global) or in Siconos's text of a FrictionContactProblem, or
    the `BodyProblem` or `SpaceBodyProblem` that `write_problem` wrote.

    Raise ValueError with the file and the line or data set if it is none of them, damaged or cut short.
    """
    path = os.fspath(path)
    with open(path, "rb") as file:
        first = file.read(8)
    if first.startswith(fclib.SIGNATURE):
        return fclib.read(path)
    return body_file.read(path) if first.startswith(body_file.SIGNATURE) else siconos_text.read(path)


def write_problem(path, problem, title="", description="", contact_ids=None):
    """Write a `Problem` as an FCLIB file, a `BodyProblem` as NumPy's .npz. An existing file is replaced only once the new one is complete.

    title, description and contact_ids (the two bodies of each contact) are for FCLIB alone: ValueError if they come with a `BodyProblem`.
    """
    if not isinstance(problem, (Problem, BodyProblem, SpaceBodyProblem)):
        raise ValueError(f"{path}: {str(problem)[:40]!r} is no contact problem: make a core.Problem of W, q and mu, or a core.BodyProblem")
    if isinstance(problem, Problem):
        fclib.write_problem(path, problem, title, description, contact_ids)
    elif title or description or contact_ids is not None:
        raise ValueError("a file of a BodyProblem has no title, description or contact_ids")
    else:
        body_file.write(path, problem)
