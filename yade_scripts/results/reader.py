"""Reads result files and checks that they are undamaged, made by this project, finished, and without NaN or infinity."""
import difflib
import json
import os
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from yade_scripts import FOLDER, parameters
from yade_scripts.errors import NoRunError, ParameterError, ResultError
from yade_scripts.results import names, schema, sealed

PARTIAL_SUFFIX = ".partial.h5"
AGAIN = "run it again"  # this replaces the file
MARK = b"state_sha256\0"  # the name of an attribute that only results have, as HDF5 writes it; a text has no zero
RESULTS = Path(__file__).resolve().parents[2] / FOLDER


class Named(dict):
    """A dictionary whose KeyError tells which names there are."""

    def __missing__(self, name):
        raise KeyError(f"{name}; there are {', '.join(self) or 'none'}")


@dataclass(frozen=True)
class Known:
    """A number measured in a run and its exact value, as `yade_scripts.scenes.Known` declares it."""
    measured: float
    exact: float
    unit: str
    scale: float
    source: str
    deviation: float = 0.0

    @property
    def error(self):
        """The error of schema.relative_error; infinite if it is not finite."""
        error = schema.relative_error(self.measured, self.exact, self.scale, self.deviation)
        return error if np.isfinite(error) else np.inf

    def __str__(self):
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.measured:.4g}{unit}, exact {self.exact:.4g}{unit}, error {self.error:.1g}"


@dataclass(frozen=True)
class Run:
    """One result file: names and units as in `yade_scripts.results.schema`.

    extra: {name: array} of quantities that only this scene has. known: {name: Known}.
    """
    path: Path
    attributes: dict
    parameters: dict
    history: dict
    snapshots: list
    extra: dict = field(default_factory=dict)
    known: dict = field(default_factory=dict)

    @property
    def name(self):
        """The name that its parameters give it. Raise ResultError if this program has no such run, as of a scene that was removed."""
        try:
            return parameters.result_name(parameters.complete(self.parameters))
        except ParameterError as error:
            raise ResultError(self.path, f"the present program refuses the parameters stored in this file: {error}",
                              f"it was made by commit {self.attributes['git_commit']}") from None

    @property
    def method(self):
        """MD or CD."""
        return self.attributes["method"]

    @property
    def pressure(self):
        """P0 [Pa]."""
        return float(self.attributes["pressure"])

    @property
    def finished(self):
        """True if the run reached its end and succeeded."""
        return bool(self.attributes["finished"] and self.attributes["status"] == schema.STATUS_FINISHED)

    @property
    def outcome(self):
        """'completed', 'collapsed: ' and what was observed, 'unstable: ' and the step that would do, or 'failed'."""
        return str(self.attributes["outcome"])

    @property
    def collapsed(self):
        """True if the sample collapsed, which ended the run early and is a valid result."""
        return self.outcome.startswith(schema.OUTCOME_COLLAPSED)

    @property
    def not_shown(self):
        """The names of the quantities in `extra` that the run did not show: single numbers that are NaN."""
        return [name for name, value in self.extra.items() if np.ndim(value) == 0 and np.isnan(value)]

    @property
    def error(self):
        """The largest error of the run's known quantities; NaN if there are none."""
        return max((known.error for known in self.known.values()), default=np.nan)

    def values(self, name):
        """Return a history field. Raise ResultError if it is missing or holds a NaN or an infinity."""
        if name not in self.history and name not in schema.HISTORY:
            near = difflib.get_close_matches(name, schema.HISTORY, n=1)
            raise ResultError(self.path, f"runs have no quantity {name!r}", f"did you mean {near[0]}?" if near else
                              f"they have {', '.join(schema.HISTORY)}")
        if name not in self.history:
            known = schema.HISTORY.get(name)
            if known and self.method not in known.methods:
                raise ResultError(self.path, f"a run of {self.method} has no {name}", f"runs of {' and '.join(known.methods)} have it")
            raise ResultError(self.path, f"/history/{name} is missing", AGAIN)
        values = self.history[name]
        if len(values) and not np.isfinite(values).any():
            raise ResultError(self.path, f"/history/{name} has no value", "its scene, or its settings, do not measure this")
        if len(wrong := np.flatnonzero(~np.isfinite(values))):
            raise ResultError(self.path, f"/history/{name} is {values[wrong[0]]} at sample {wrong[0]} ({len(wrong)} such of {len(values)})",
                              "the run went wrong: look at its log")
        return values


def load(path, finished=True):
    """Return the run stored at `path`. Raise ResultError if it is no result file, is damaged or, with `finished`, did not finish."""
    path = Path(path)
    if not os.path.lexists(path):
        raise ResultError(path, "there is no such file", "make it with `make study`")
    if path.name.endswith(PARTIAL_SUFFIX) and finished:
        raise ResultError(path, "the run is under way or was interrupted", "start it again if it is not under way")
    try:
        with sealed.open_checked(path, MARK) as file:
            if found := schema.problems(file):
                raise ResultError(path, "; ".join(found), AGAIN)
            run = _read(path, file)
    except sealed.Foreign as error:
        raise NoRunError(path, str(error)) from None
    except sealed.Unreadable as error:
        raise ResultError(path, str(error)) from None
    except sealed.Damaged as error:
        raise ResultError(path, str(error), AGAIN) from None
    except (KeyError, TypeError, ValueError) as error:
        raise ResultError(path, f"is no result file of this project ({type(error).__name__}: {error})", AGAIN) from None
    if finished and not run.finished:
        raise ResultError(path, f"the run did not finish: {run.attributes['status']}", "correct the cause and run it again")
    return run


def load_named(path, finished=False):
    """Return the run stored at `path`. Raise ResultError as `load` does, and if its parameters do not give it this name."""
    run = load(path, finished)
    if run.path.name not in (f"{run.name}.h5", f"{run.name}{PARTIAL_SUFFIX}"):
        raise ResultError(path, f"it holds another run than its name says ({run.name})", "rename it, or run it again")
    return run


def load_row(full, folder=FOLDER):
    """Return the run of a full row from its file in `folder`. Parameters that are younger than the file have their defaults. Raise ResultError as
    `load_named` does."""
    run = load_named(names.path_of(full, folder))
    return replace(run, parameters=full | run.parameters)


def _read(path, file):
    attributes = {name: file.attrs[name] for name in schema.ROOT_ATTRIBUTES}
    history = {name: data[()] for name, data in file["history"].items()}
    groups = [file["snapshots"][number] for number in sorted(file.get("snapshots", ()), key=int)]
    snapshots = [Named({name: group[name][()] for name in schema.SNAPSHOT}
                       | {name: float(group.attrs[name]) for name in schema.SNAPSHOT_ATTRIBUTES}) for group in groups]
    extra = Named({name: data[()] for name, data in file.get("extra", {}).items()})
    return Run(path, attributes, json.loads(attributes["parameters"]), history, snapshots, extra, known(file))


def known(file):
    """Return {name: Known} of an open file."""
    return Named({name: Known(float(data[()]), **{key: data.attrs[key] for key in schema.KNOWN}) for name, data in file.get("known", {}).items()})
