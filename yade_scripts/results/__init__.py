"""Result files: their names (names), fields (schema), checksum (sealed) and reader, and how a run ended. Needs no YADE.

A file counts as the result of a row if `reader` accepts it and it holds that row's parameters; its name alone does not count.
Nothing here imports code that runs or draws.
"""
import os
import pathlib

from yade_scripts import FOLDER
from yade_scripts.errors import ParameterError, ResultError
from yade_scripts.results import reader
from yade_scripts.results.names import checkpoint_of, path_of
from yade_scripts.results.schema import STATUS_FAILED, STATUS_FINISHED, has_failed

__all__ = ["FOLDER", "STATUS_FAILED", "STATUS_FINISHED", "checkpoint_of", "ending", "finished", "has_failed", "in_words", "make", "path_of", "status"]


def make(folder, kind="results"):
    """Create the folder for files of a kind unless it exists. Raise ParameterError if nothing can be written there."""
    try:
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError("nothing can be written there")
    except OSError as error:
        raise ParameterError(f"{folder} cannot be used as the folder for {kind}: {error}") from None


def ending(path):
    """Return (status, commit) of the run in a file: 'finished', 'failed: reason' or 'unstable: reason', and the commit of its code; (None, '')
    without a file."""
    if not os.path.lexists(path):
        return None, ""
    try:
        run = reader.load_named(path)
    except ResultError as error:
        return f"{STATUS_FAILED}{error}", ""
    return str(run.attributes["status"]), str(run.attributes["git_commit"])


def status(path):
    """Return 'finished', 'failed: reason', 'unstable: reason', or None where there is no file."""
    return ending(path)[0]


def in_words(path):
    """Return `status`, and of a sample that collapsed its outcome, too."""
    found = status(path)
    if found == STATUS_FINISHED and (run := reader.load(path)).collapsed:
        return f"{found}, {run.outcome}"
    return found


def finished(path):
    return status(path) == STATUS_FINISHED
