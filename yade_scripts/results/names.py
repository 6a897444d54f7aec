"""The names of a run's files. Needs no YADE."""
import pathlib

from yade_scripts import FOLDER, parameters


def path_of(full, folder=FOLDER):
    return pathlib.Path(folder) / f"{parameters.result_name(full)}.h5"


def checkpoint_of(path):
    """Return the file from which the run of a result file can be continued."""
    return pathlib.Path(path).with_suffix(".checkpoint.zip")
