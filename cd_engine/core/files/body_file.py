"""Reads and writes a `BodyProblem` or a `SpaceBodyProblem` as NumPy's .npz: one array for each of its fields, under the field's name.

FCLIB's global form (M, H, f, w, mu) does not serve: it stores neither which degrees of freedom belong to one body nor bodies of prescribed
velocity, so a problem could not be read back unchanged. For other codes write the local form, `problem.delassus()`.
"""
from dataclasses import fields, replace

import numpy as np

from .body_problem import BodyProblem
from .problem import made, replaced
from .space_bodies import SpaceBodyProblem

SIGNATURE = b"PK\x03\x04"  # start of a .npz file, which is a zip archive
NAMES = {kind: tuple(field.name for field in fields(kind)) for kind in (BodyProblem, SpaceBodyProblem)}
OPTIONAL = ("compliances", "slip_bias")  # of contacts with a stiffness; files of rigid ones lack them


def write(path, problem):
    """Write `problem`. An existing file of that name is replaced only once the new one is complete."""
    problem = replace(problem)  # checked anew, since its arrays may have been changed
    with replaced(path) as aside, open(aside, "wb") as file:
        springs = problem.compliances.any() or problem.slip_bias.any()
        np.savez(file, **{name: getattr(problem, name) for name in NAMES[type(problem)] if name not in OPTIONAL or springs})


def read(path):
    """Return the problem in the file. Raise ValueError with the array's name if the file is damaged (zip's checksums) or of another kind."""
    try:
        archive = np.load(path, allow_pickle=False)
    except Exception as error:  # many types, of zipfile and of NumPy
        raise ValueError(f"{path}: not a complete .npz file ({error})") from None
    with archive:
        kind = SpaceBodyProblem if "inverse_inertias" in archive.files else BodyProblem
        return made(path, kind, **{name: _array(path, archive, name, NAMES[kind]) for name in NAMES[kind]
                                if name not in OPTIONAL or name in archive.files})


def _array(path, archive, name, names):
    if name not in archive.files:
        raise ValueError(f"{path}, {name}: is missing; a problem of bodies has {', '.join(names)}")
    try:
        return archive[name]
    except Exception as error:
        raise ValueError(f"{path}, {name}: cannot be read ({error or type(error).__name__})") from None
