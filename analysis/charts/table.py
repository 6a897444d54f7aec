"""The measured settings as a pandas table.

A row: name (of its measurement), status (empty if finished), scene, kind, size (disks where that is varied, else 0), method (MD, CD, or SPRINGS:
springs in Contact Dynamics), series, rank in it (0 the coarsest), setting, arguments (of yade_scripts/run.py), error, worst (the known quantity that
has it), seconds (median of the repeats), fastest, slowest, steps, sweeps, unconverged_steps, disks. Numbers that a failed setting lacks are NaN.
"""
import statistics
from pathlib import Path

import pandas

from analysis import charts, publish, style
from yade_scripts import parameters, scenes
from yade_scripts.measuring import charts as settings
from yade_scripts.measuring import store
from yade_scripts.errors import ResultError
from yade_scripts.results.schema import STATUS_FINISHED

COLUMNS = dict(texts=("status", "scene", "kind", "method", "series", "setting", "arguments", "worst"),
               numbers=("size", "rank", "error", "seconds", "fastest", "slowest", "steps", "sweeps", "unconverged_steps", "disks"))
SPRINGS = "CD springs"
WORDS = style.WORDS | {SPRINGS: "springs in Contact Dynamics"}
COLOUR, MARKER = style.COLOUR | {SPRINGS: style.GREEN}, style.MARKER | {SPRINGS: "D"}
LEVELS = (1e-2, 1e-4, 1e-6)  # accuracies that the charts look at
PUBLISHED = Path(charts.__file__).resolve().parents[1] / "published" / charts.FOLDER / "work_precision.csv"


def measured(results, full, broken=None):
    """Return (the table of all scenes, where it comes from). Raise ResultError if nothing was measured. broken: as of declared.readable."""
    folder = Path(results) / settings.FOLDER
    found = [(setting, facts) for scene in settings.names(broken) for setting in settings.settings(scene, full)
             if (facts := store.get(folder, setting.name))]
    if not found:
        raise ResultError(folder, "holds no measured setting", "measure some: make charts")
    rows = pandas.DataFrame([_row(*one) for one in found]).astype({"error": float, "seconds": float})
    return rows, charts.origin_of([facts for _, facts in found], full)


def _row(setting, found):
    row, series, finished = setting.row, setting.series, found["status"] == STATUS_FINISHED
    seconds, errors = found["seconds"] if finished else [], settings.errors(found["rows"])
    return {"status": "" if finished else found["status"], "name": setting.name, "scene": row["scene"], "kind": scenes.module(row["scene"]).KIND,
            "size": setting.size, "method": _method(row), "series": series.name, "rank": setting.rank,
            "setting": f"{series.parameter}={row[series.parameter]:g}",
            "arguments": " ".join(f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}" for name, value in row.items()),
            "error": found.get("error"), "worst": max(errors, key=errors.get, default=""), "seconds": statistics.median(seconds) if seconds else None,
            "fastest": min(seconds, default=None), "slowest": max(seconds, default=None)} | {
                name: found.get(name) for name in ("steps", "sweeps", "unconverged_steps", "disks")}


def _method(row):
    soft = row["method"] == "CD" and parameters.complete(store.split(row)[0])["cd_contacts"] == "springs"
    return SPRINGS if soft else row["method"]


def from_csv(path):
    return publish.read_table(path, **COLUMNS).fillna({"status": "", "worst": ""})


def one_size(rows):
    """Return the rows of the scenes as they are, without those at other numbers of disks."""
    return rows[rows["size"] == 0]


def by_series(rows):
    """Return [(series, its rows from coarse to fine)] in the order of the rows."""
    return [(series, own.sort_values("rank", kind="stable")) for series, own in rows.groupby("series", sort=False)]
