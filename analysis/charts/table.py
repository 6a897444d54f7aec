"""The measured settings as rows: of the records of this machine, or of a published table.

A row: name (of its record), status (empty if finished), scene, kind, size (disks where that is varied, else 0), method, series, rank in it (0 the coarsest), setting,
arguments (of yade_scripts/run.py), error, worst (the known that has it), seconds (median of the repeats), fastest, slowest, repeats, steps, sweeps,
unconverged_steps, disks. Numbers that a failed setting lacks are None.
"""

import statistics
from pathlib import Path

from analysis import load, publish
from analysis.charts import kinds
from yade_scripts import scenes
from yade_scripts.charts import records, settings

WHOLE, REAL = ("size", "rank", "repeats", "steps", "sweeps", "unconverged_steps", "disks"), ("error", "seconds", "fastest", "slowest")
LEVELS = (1e-2, 1e-4, 1e-6)  # accuracies that the charts look at
FINISHED = "finished"


def from_records(results, full):
    """(rows, {name: record}) of all scenes, in the order of the settings; ResultError where nothing was measured."""
    rows, used = [], {}
    for scene in settings.charted():
        found = records.read(scene, results)
        for setting in settings.everything(scene, not full):
            if setting.name in found:
                records.check(found[setting.name], records.path(scene, results))
                used[setting.name] = found[setting.name]
                rows.append(_row(setting, found[setting.name]))
    if not rows:
        raise load.ResultError(Path(results) / records.FOLDER, "holds no measured setting", "measure some: make charts")
    return rows, used


def _row(setting, record):
    row = dict(setting.row)
    known = record.get("known") or {}
    seconds = record["seconds"] if record["status"] == FINISHED else []
    return {"name": setting.name, "status": "" if record["status"] == FINISHED else record["status"], "scene": row["scene"], "kind": kinds.of(row["scene"]), "size": setting.size,
            "method": row["method"], "series": setting.series, "rank": setting.rank, "setting": _setting(setting), "arguments": _arguments(row),
            "error": record.get("error"), "worst": _worst(known), "seconds": statistics.median(seconds) if seconds else None,
            "fastest": min(seconds, default=None), "slowest": max(seconds, default=None), "repeats": len(seconds), "steps": record.get("steps"),
            "sweeps": record.get("sweeps"), "unconverged_steps": record.get("unconverged_steps"), "disks": record.get("disks")}


def _setting(setting):
    """What the series varies, and its value here."""
    own = next(one for one in settings.series(dict(setting.row)["scene"]) if one.name == setting.series)
    return f"{own.parameter}={dict(setting.row)[own.parameter]:g}"


def _arguments(row):
    return " ".join(f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}" for name, value in row.items())


def _worst(known):
    """The known with the largest error."""
    measured = {name: records.relative(one) for name, one in known.items() if one["measured"] is not None}
    return max(measured, key=measured.get) if measured else ""


def from_csv(path):
    """The rows of a published table, numbers as numbers; ResultError where it is damaged."""
    try:
        _, rows = publish.read_csv(path)
        for row in rows:
            row |= {name: int(row[name]) if row[name] not in ("", "None") else None for name in WHOLE}
            row |= {name: float(row[name]) if row[name] not in ("", "None") else None for name in REAL}
    except (KeyError, ValueError) as error:
        raise load.ResultError(path, f"is damaged ({error})", "make it again: make charts") from None
    return rows


def one_size(rows):
    """The rows of the scenes as they are, without those at other numbers of disks."""
    return [row for row in rows if not row["size"]]


def by_series(rows):
    """{series: its rows from coarse to fine} in the order of the rows."""
    found = {}
    for row in rows:
        found.setdefault(row["series"], []).append(row)
    return {name: sorted(own, key=lambda row: row["rank"]) for name, own in found.items()}


def title(scene):
    """What a scene is, in a few words."""
    return scenes.module(scene).TITLE
