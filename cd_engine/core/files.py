"""Reads a contact problem from a file of any kind, and writes one."""
import os

from . import body_file, fclib, siconos_text
from .body_problem import BodyProblem


def read_problem(path):
    """The `Problem` in a file: FCLIB (HDF5, a local problem of two dimensions) or Siconos's FrictionContactProblem as text; or the
    `BodyProblem` that `write_problem` wrote.

    A file that is none of them, damaged or cut short is a ValueError that names the file and the line or data set.
    """
    path = os.fspath(path)
    with open(path, "rb") as file:
        first = file.read(8)
    if first.startswith(fclib.SIGNATURE):
        return fclib.read(path)
    return body_file.read(path) if first.startswith(body_file.SIGNATURE) else siconos_text.read(path)


def write_problem(path, problem, title="", description="", contact_ids=None):
    """Write a `Problem` as an FCLIB file, a `BodyProblem` as NumPy's .npz; it takes the place of one of that name only once it is complete.

    title, description and contact_ids, the two bodies of each contact, are for FCLIB alone; a `BodyProblem` knows its bodies.
    """
    if not isinstance(problem, BodyProblem):
        fclib.write_problem(path, problem, title, description, contact_ids)
    elif title or description or contact_ids is not None:
        raise ValueError("a file of a BodyProblem has no title, description or contact_ids")
    else:
        body_file.write(path, problem)
