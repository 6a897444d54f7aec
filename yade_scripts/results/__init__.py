"""Result files: their names, fields (schema), checksum (sealed) and reader, and how a run ended. Needs no YADE.

A file counts as the result of a row if it is undamaged and holds that row's parameters and a history; its name alone does not count.
Nothing here imports code that runs or draws.
"""
import json
import os
import pathlib

from yade_scripts import parameters
from yade_scripts.results import sealed
from yade_scripts.results.schema import STATUS_FAILED, STATUS_FINISHED

FOLDER = "results"


def make(folder):
    """Create the folder of results unless it exists. Raise ParameterError if nothing can be written there."""
    try:
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError("nothing can be written there")
    except OSError as error:
        raise parameters.ParameterError(f"{folder} cannot be used as the folder for results: {error}") from None


def path_of(full, folder=FOLDER):
    return pathlib.Path(folder) / f"{parameters.result_name(full)}.h5"


def ending(path):
    """Return (status, commit) of the run in a file: 'finished' or 'failed: reason', and the commit of its code; (None, '') without a file."""
    if not os.path.lexists(path):
        return None, ""
    try:
        with sealed.open_checked(path) as file:
            commit = str(file.attrs.get("git_commit", ""))
            return reason_against(path, file) or str(file.attrs["status"]), commit
    except (sealed.Damaged, KeyError) as error:
        return f"{STATUS_FAILED}{path} {error}", ""


def reason_against(path, file):
    """Return, as a status, why an open file is not the result that its name promises; '' if it is."""
    try:
        row = parameters.complete(json.loads(file.attrs["parameters"]))
    except (KeyError, TypeError, ValueError) as error:
        return f"{STATUS_FAILED}{path} holds no row of parameters ({error})"
    if parameters.result_name(row) != pathlib.Path(path).name.partition(".")[0]:
        return f"{STATUS_FAILED}{path} holds another run than its name says: {parameters.result_name(row)}"
    if not len(file.get("history/time", ())) and file.attrs["status"] == STATUS_FINISHED:
        return f"{STATUS_FAILED}{path} says that it has finished, but holds no history"
    return ""


def status(path):
    """Return 'finished', 'failed: reason', or None where there is no file."""
    return ending(path)[0]


def finished(path):
    return status(path) == STATUS_FINISHED
