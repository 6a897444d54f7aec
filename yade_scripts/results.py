"""Where results are and how their runs ended. Needs no YADE."""
import pathlib

import h5py

from analysis.schema import STATUS_FAILED, STATUS_FINISHED
from yade_scripts import parameters

FOLDER = "results"


def path_of(full, folder=FOLDER):
    """The result file of a full row."""
    return pathlib.Path(folder) / f"{parameters.result_name(full)}.h5"


def status(path):
    """'finished', 'failed: reason', or None where there is no file."""
    if not path.exists():
        return None
    try:
        with h5py.File(path, "r") as file:
            return file.attrs["status"]
    except (OSError, KeyError) as error:
        return f"{STATUS_FAILED}{path} is no result file: {error}"


def commit(path):
    """The commit that made a finished run, with '-dirty' where its tree had changes."""
    with h5py.File(path, "r") as file:
        return file.attrs["git_commit"]


def finished(path):
    """Whether the run has ended well."""
    return status(path) == STATUS_FINISHED
