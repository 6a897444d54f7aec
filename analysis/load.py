"""Result files into memory, checked: whatever is returned here is what it claims to be."""

import json
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from analysis import schema
from cd_engine import guarded
from yade_scripts import parameters, results, tables

PARTIAL_SUFFIX = ".partial.h5"
AGAIN, OURS = "remove it and run it again", "give a file written by yade_scripts/run.py"  # what to do
RESULTS = Path(__file__).resolve().parent.parent / "results"


class ResultError(Exception):
    """A result file cannot be used: which one, what is wrong, and what to do."""

    def __init__(self, path, what, remedy):
        super().__init__(f"{path}: {what}; {remedy}")
        self.what, self.remedy = what, remedy


@dataclass(frozen=True)
class Known:
    """A number of a run with what it should be, as `yade_scripts.scenes.Known` declares it."""

    measured: float
    exact: float
    unit: str
    scale: float
    source: str
    deviation: float = 0.0

    @property
    def error(self):
        """As schema.relative_error; infinite where the number is none."""
        error = schema.relative_error(self.measured, self.exact, self.scale, self.deviation)
        return error if np.isfinite(error) else np.inf


@dataclass(frozen=True)
class Run:
    """One result file: names, units and shapes as in `analysis.schema`.

    extra: {name: array} of what only this scene has. known: {name: Known}.
    """

    path: Path
    attributes: dict
    parameters: dict
    history: dict
    snapshots: list
    extra: dict = field(default_factory=dict)
    known: dict = field(default_factory=dict)

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
        return bool(self.attributes["finished"]
                    and self.attributes["status"] == schema.STATUS_FINISHED)

    @property
    def outcome(self):
        """'completed', or 'collapsed: ' and what was seen."""
        return str(self.attributes["outcome"])

    @property
    def collapsed(self):
        """True if the sample gave way, which ended the run early and is a result."""
        return self.outcome.startswith(schema.OUTCOME_COLLAPSED)

    @property
    def error(self):
        """The largest error of what is known about the run; NaN where nothing is."""
        return max((known.error for known in self.known.values()), default=np.nan)

    def values(self, name):
        """A history field; ResultError where it is missing or holds a NaN or an infinity."""
        if name not in self.history:
            raise ResultError(self.path, f"/history/{name} is missing", "run it again")
        values = self.history[name]
        wrong = np.flatnonzero(~np.isfinite(values))
        if len(wrong):
            raise ResultError(self.path, f"/history/{name} is {values[wrong[0]]} at sample "
                              f"{wrong[0]} ({len(wrong)} such of {len(values)})",
                              "the run went wrong: look at its log")
        return values


def load(path, finished=True):
    """The run stored at `path`. ResultError if it is no result file or, with `finished`, no success."""
    path = Path(path)
    if not path.is_file():
        raise ResultError(path, "no such file", "make it with `make study`")
    if path.name.endswith(PARTIAL_SUFFIX) and finished:
        raise ResultError(path, "unfinished, it is being written or was interrupted",
                          "start the run again if it is not under way")
    try:
        run = guarded.call(_open, path)
    except (OSError, ValueError) as error:
        run = f"truncated or damaged ({_first_line(error)})", AGAIN
    if not isinstance(run, Run):
        raise ResultError(path, *run)
    if finished and not run.finished:
        raise ResultError(path, f"the run did not finish: {run.attributes['status']}",
                          "mend the cause, remove the file and run it again")
    return run


def pair(first, second, mixed_commits=False):
    """(MD run, CD run) from two files in either order, comparable: same state, loading and commit."""
    runs = {run.method: run for run in (load(first), load(second))}
    if len(runs) < 2:
        raise ResultError(f"{first}, {second}", f"both are {next(iter(runs))} runs",
                          "give one MD and one CD run")
    md, cd = runs["MD"], runs["CD"]
    both = f"{md.path}, {cd.path}"
    different = _differences(md, cd)
    if different:
        raise ResultError(both, "not comparable, they differ in " + ", ".join(different),
                          "give an MD and a CD run of the same packing and loading")
    commits = [run.attributes["git_commit"] for run in (md, cd)]
    if commits[0] != commits[1] and not mixed_commits:
        raise ResultError(both, f"made by different commits, {commits[0]} and {commits[1]}",
                          "remove the older one and run it again, or allow it by --mixed-commits")
    return md, cd


def pair_of_table(table, folder=RESULTS, mixed_commits=False):
    """The pair that a table of two rows, one MD and one CD, has made in `folder`."""
    try:
        files = [results.path_of(parameters.complete(row), folder) for row in tables.read(table).values()]
    except (tables.TableError, parameters.ParameterError) as error:
        raise ResultError(table, str(error), "mend the table") from None
    if len(files) != 2:
        raise ResultError(table, f"holds {len(files)} rows, a figure of a pair needs two", "name the two files instead")
    return pair(*files, mixed_commits=mixed_commits)


def newest_pair(folder=RESULTS, mixed_commits=False):
    """The MD run and the CD run from the same state and loading that were finished last."""
    runs = {"MD": [], "CD": []}
    for path in sorted(Path(folder).glob("*.h5"), key=lambda p: p.stat().st_mtime, reverse=True):
        try:
            run = load(path)
        except ResultError:
            continue  # `check` reports these; here any usable pair will do
        if run.attributes["state_sha256"]:
            runs[run.method].append(run)
    pairs = [(md, cd) for md in runs["MD"] for cd in runs["CD"] if not _differences(md, cd)
             and (mixed_commits or md.attributes["git_commit"] == cd.attributes["git_commit"])]
    if not pairs:
        raise ResultError(folder, f"holds {len(runs['MD'])} finished MD and {len(runs['CD'])} finished "
                          "CD runs, but no two from the same packing, loading and commit",
                          "make them with `make study`")
    return max(pairs, key=lambda p: min(run.path.stat().st_mtime for run in p))


def _differences(md, cd):
    """Names of what should be the same in both files and is not."""
    general = parameters.REGISTRY
    names = [name for name in dict.fromkeys([*general, *md.parameters, *cd.parameters])  # the latter hold what only their scene has
             if name not in general or general[name].method is None and name != "method"]
    found = [f"{name} ({md.parameters.get(name)} and {cd.parameters.get(name)})"
             for name in names if md.parameters.get(name) != cd.parameters.get(name)]
    if md.attributes["state_sha256"] != cd.attributes["state_sha256"]:
        found.insert(0, "state_sha256")
    return found


def _open(path):
    """The run, or (what is wrong, what to do); called in a process of its own, which a damaged file may end."""
    try:
        with h5py.File(path, "r") as file:
            return _read(path, file)
    except ResultError as error:
        return error.what, error.remedy
    except (OSError, RuntimeError) as error:
        kind = "not a readable HDF5 file" if not _looks_like_hdf5(path) else "truncated or damaged"
        return f"{kind} ({_first_line(error)})", AGAIN
    except (AttributeError, KeyError, TypeError, ValueError) as error:  # parts of other kinds than those that schema.problems looks at
        return f"not a result file of this project ({type(error).__name__}: {_first_line(error)})", OURS


def _read(path, file):
    found = schema.problems(file)
    if found:
        raise ResultError(path, "not a result file of this project: " + "; ".join(found), OURS)
    attributes = {name: file.attrs[name] for name in schema.ROOT_ATTRIBUTES}
    try:
        row = json.loads(attributes["parameters"])
    except json.JSONDecodeError as error:
        raise ResultError(path, f"attribute 'parameters' is not JSON ({error})", AGAIN) from None
    if not isinstance(row, dict):
        raise ResultError(path, "attribute 'parameters' is no table of names and values", AGAIN)
    history = {name: data[()] for name, data in file["history"].items()}
    snapshots = [_read_snapshot(file["snapshots"][number])
                 for number in sorted(file.get("snapshots", ()), key=int)]
    extra = {name: data[()] for name, data in file.get("extra", {}).items()}
    known = {name: _read_known(data) for name, data in file.get("known", {}).items()}
    return Run(path, attributes, row, history, snapshots, extra, known)


def _read_known(data):
    exact = float(data.attrs["exact"])
    return Known(float(data[()]), exact, str(data.attrs["unit"]), float(data.attrs.get("scale", abs(exact) or 1)),
                 str(data.attrs.get("source", "")), float(data.attrs.get("deviation", 0)))


def _read_snapshot(group):
    data = {name: group[name][()] for name in schema.SNAPSHOT}
    return data | {name: float(group.attrs[name]) for name in schema.SNAPSHOT_ATTRIBUTES}


def _looks_like_hdf5(path):
    with open(path, "rb") as file:
        return file.read(8) == b"\x89HDF\r\n\x1a\n"


def _first_line(error):
    return str(error).splitlines()[0] if str(error) else type(error).__name__
