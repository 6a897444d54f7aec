"""Where results are and how their runs ended. Needs no YADE."""
import os
import pathlib

import h5py

from analysis.schema import STATUS_FAILED, STATUS_FINISHED
from cd_engine import guarded
from yade_scripts import parameters

FOLDER = "results"
AT_ONCE = 100  # files read in one process, which costs 8 ms; a file costs 0.1 ms


def make(folder):
    """Make the folder of results unless it is there; ParameterError where it cannot be one."""
    try:
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError("nothing can be written there")
    except OSError as error:
        raise parameters.ParameterError(f"{folder} cannot be a folder of results: {error}") from None


def path_of(full, folder=FOLDER):
    """The result file of a full row."""
    return pathlib.Path(folder) / f"{parameters.result_name(full)}.h5"


def endings(paths):
    """{path: (status, commit)} of the files that are there: 'finished' or 'failed: reason', and what code made it, '-dirty' where it had changes."""
    found, there = {}, [path for path in paths if path.exists()]
    for begin in range(0, len(there), AT_ONCE):
        some = there[begin:begin + AT_ONCE]
        try:
            found |= guarded.call(lambda _: {path: _ending(path) for path in some}, some[0])
        except (OSError, ValueError) as error:  # a damaged file ends or holds up the process: which?
            found |= {some[0]: _damaged(some[0], error)} if len(some) == 1 else {path: one for path in some for one in endings([path]).values()}
    return found


def status(path):
    """'finished', 'failed: reason', or None where there is no file."""
    return endings([path]).get(path, (None, None))[0]


def finished(path):
    """Whether the run has ended well."""
    return status(path) == STATUS_FINISHED


def _ending(path):
    try:
        with h5py.File(path, "r") as file:
            return str(file.attrs["status"]), str(file.attrs.get("git_commit", ""))
    except (OSError, KeyError, RuntimeError, TypeError, ValueError) as error:
        return _damaged(path, error)


def _damaged(path, error):
    return f"{STATUS_FAILED}{path} is no result file: {error}", ""


def settle(new, path):
    """Give a file that was written aside its name, once it is on the disk: after a crash there is the old file or the new one, whole."""
    _to_disk(new)
    os.replace(new, path)
    _to_disk(pathlib.Path(path).parent)


def _to_disk(place):
    handle = os.open(place, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

