"""The measured settings as rows.

A row: name (of its measurement), status (empty if finished), scene, kind, size (disks where that is varied, else 0), method, series, rank in it
(0 the coarsest), setting, arguments (of yade_scripts/run.py), error, worst (the known quantity that has it), seconds (median of the repeats),
fastest, slowest, steps, sweeps, unconverged_steps, disks. Numbers that a failed setting lacks are None.
"""

import statistics
from pathlib import Path

import pandas

from analysis import charts, publish
from yade_scripts import scenes
from yade_scripts.measuring import charts as settings
from yade_scripts.measuring import store
from yade_scripts.results.reader import ResultError
from yade_scripts.results.schema import STATUS_FINISHED, relative_error

LEVELS = (1e-2, 1e-4, 1e-6)  # accuracies that the charts look at
PUBLISHED = Path(charts.__file__).resolve().parents[1] / "published" / charts.FOLDER / "work_precision.csv"


def measured(results, full):
    """Return (rows of all scenes, where they come from); ResultError where nothing was measured."""
    rows, facts, folder = [], [], Path(results) / settings.FOLDER
    for scene in settings.names():
        for setting in settings.settings(scene, full):
            found = store.get(folder, setting.name)
            if found:
                facts.append(found)
                rows.append(_row(setting, found))
    if not rows:
        raise ResultError(folder, "holds no measured setting", "measure some: make charts")
    return rows, charts.origin_of(facts, full)


def _row(setting, found):
    scene, finished = setting.row["scene"], found["status"] == STATUS_FINISHED
    seconds = found["seconds"] if finished else []
    errors = {one["name"]: relative_error(one["measured"], one["exact"], one["scale"], one["deviation"]) for one in found["rows"] if one["measured"] is not None}
    return {"status": "" if finished else found["status"], "name": setting.name, "scene": scene, "kind": scenes.module(scene).KIND, "size": setting.size,
            "method": setting.row["method"], "series": setting.series.name, "rank": setting.rank,
            "setting": f"{setting.series.parameter}={setting.row[setting.series.parameter]:g}",
            "arguments": " ".join(f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}" for name, value in setting.row.items()),
            "error": found.get("error"), "worst": max(errors, key=errors.get, default=""), "seconds": statistics.median(seconds) if seconds else None,
            "fastest": min(seconds, default=None), "slowest": max(seconds, default=None)} | {
                name: found.get(name) for name in ("steps", "sweeps", "unconverged_steps", "disks")}


def from_csv(path):
    """Return the rows of a published table."""
    table = publish.read_table(path)
    try:
        table = table[["status", "scene", "kind", "size", "method", "series", "rank", "setting", "arguments", "error", "seconds", "fastest", "slowest", "steps", "sweeps",
                       "unconverged_steps", "disks", "worst"]]
    except KeyError as error:
        raise ResultError(path, f"lacks columns ({error})", "make it again: make charts") from None
    table = table.fillna({name: "" for name in ("status", "worst")})
    return table.replace("None", None).astype(object).where(pandas.notna(table), None).to_dict("records")


def one_size(rows):
    """Return the rows of the scenes as they are, without those at other numbers of disks."""
    return [row for row in rows if not row["size"]]


def by_series(rows):
    """Return {series: its rows from coarse to fine} in the order of the rows."""
    found = {}
    for row in rows:
        found.setdefault(row["series"], []).append(row)
    return {name: sorted(own, key=lambda row: row["rank"]) for name, own in found.items()}
