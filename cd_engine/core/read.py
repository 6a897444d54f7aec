"""Reads a contact problem from a file of either kind."""
import os

from . import fclib, siconos_text


def read_problem(path):
    """The `Problem` in a file: FCLIB (HDF5, a local problem of two dimensions) or Siconos's FrictionContactProblem as text.

    A file that is neither, damaged or cut short is a ValueError that names the file and the line or data set.
    """
    path = os.fspath(path)
    with open(path, "rb") as file:
        hdf5 = file.read(len(fclib.SIGNATURE)) == fclib.SIGNATURE
    return fclib.read(path) if hdf5 else siconos_text.read(path)
