"""A study's figure, summary table and provenance as files: <name>.png, <name>.csv and <name>.json.

The table has one column `status`: empty in the study's own rows, the reason in those of runs that failed or are missing, which
follow with the parameters that set them apart. Floats are written with all their digits, so that a table compares exactly.
"""

import csv
import json
import math
import platform
from pathlib import Path

import h5py
import matplotlib
import numpy as np

from analysis import comparison, observables, overview, studies
from analysis.load import ResultError

STATUS = "status"


def publish(collection, folder):
    """Write the three files of a study into `folder`; their common stem. ResultError if no run of it has finished."""
    if not collection.runs:
        reason = collection.missing[0][2] if collection.missing else "its tables are empty"
        raise ResultError(collection.name, f"no run has finished (the first: {reason})", f"make them: {run_command(collection)}")
    study, stem = collection.module, Path(folder) / collection.name
    stem.parent.mkdir(parents=True, exist_ok=True)
    rows = study.summarize(collection.runs)
    study.draw(collection.runs, rows, stem.with_suffix(".png"))
    write_csv(stem.with_suffix(".csv"), rows + missing_rows(collection))
    text = json.dumps(findings(collection, rows) | provenance(collection), indent=1, ensure_ascii=False, allow_nan=False)
    stem.with_suffix(".json").write_text(text + "\n")
    return stem


def missing_rows(collection):
    """One row for each run that failed or is missing: its reason, file and the parameters that differ within the study."""
    varied = _split([run.parameters for run in collection.runs] + [row for _, row, _ in collection.missing])[1]
    return [{STATUS: reason, "file": path.name} | {name: row.get(name, "") for name in varied} for path, row, reason in collection.missing]


def write_csv(path, rows):
    """The rows under the union of their headings; a heading that a row lacks stays empty."""
    headings = list(dict.fromkeys(name for row in rows for name in row))
    if STATUS in headings:
        headings.remove(STATUS)
        headings.insert(0, STATUS)
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, headings, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: text(value) for name, value in row.items()} for row in rows)


def text(value):
    """A cell: the shortest digits that read back as the same float, anything else as it prints."""
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)


def read_csv(path):
    """(headings, rows as {heading: text}) of a summary table; ValueError with the line where it is none."""
    with open(path, newline="", errors="replace") as file:
        reader = csv.reader(file)
        try:
            headings = next(reader, [])
            return headings, [dict(zip(headings, line, strict=True)) for line in reader if line]
        except (csv.Error, ValueError) as error:
            raise ValueError(f"{path}:{reader.line_num}: {error}") from None


def read_json(path, kinds):
    """The object in a file; ValueError where one of the names of `kinds` {name: type} is missing or of another type."""
    try:
        found = json.loads(Path(path).read_bytes())
    except RecursionError as error:
        raise ValueError(f"{path}: {error}") from None
    if not isinstance(found, dict):
        raise ValueError(f"{path}: no object of names and values")
    wrong = [name for name, kind in kinds.items() if not isinstance(found.get(name), kind)]
    if wrong:
        raise ValueError(f"{path}: {', '.join(wrong)} missing or of another kind")
    return found


def findings(collection, rows):
    """What a study says: question, answer, its line in the short answer, the paper's statements beside it, energy balance."""
    study = collection.module
    answer = study.answer(rows)
    return {"study": collection.name, "title": study.TITLE, "question": study.QUESTION, "answer": answer,
            "headline": overview.headline(collection.name, rows, answer), "lead": overview.lead(collection.name, rows), "points": comparison.of_study(collection.name, rows),
            "energy_balance": energy_balance(collection.runs)}


def energy_balance(runs):
    """{method: how many runs have a balance, its median and largest error}; see observables.balance_error."""
    found = {}
    for method in ("MD", "CD"):
        errors = [observables.balance_error(run) for run in runs if run.method == method and "wall_work" in run.history]
        errors = np.abs([error for error in errors if math.isfinite(error)])
        if len(errors):
            found[method] = {"runs": len(errors), "median": float(np.median(errors)), "largest": float(errors.max())}
    return found


def provenance(collection):
    """What the figure and the table come from; plain data for JSON."""
    constant, varied = _split([run.parameters for run in collection.runs])
    failed = [reason for _, _, reason in collection.missing if reason.startswith("failed")]
    return {
        "extent": collection.extent, "tables": [f"yade_scripts/tables/{name}" for name in collection.tables],
        "runs_finished": len(collection.runs), "runs_failed": len(failed), "runs_missing": len(collection.missing) - len(failed),
        "runs_collapsed": sum(run.collapsed for run in collection.runs),
        "packings": len({run.attributes["state_sha256"] for run in collection.runs} - {""}),
        "computing_seconds": round(sum(_last(run.history["wall_clock"]) for run in collection.runs), 1),
        "commits": collection.commits, "yade": sorted({str(run.attributes["yade_version"]) for run in collection.runs}),
        "python": platform.python_version(), "numpy": np.__version__, "h5py": h5py.__version__, "matplotlib": matplotlib.__version__,
        "processor": processor(), "run_command": run_command(collection), "figure_command": figure_command(collection),
        "parameters": constant, "varied": varied,
    }


def run_command(collection):
    """The command that runs a study's tables and draws it."""
    return f"make study STUDY={collection.name}" + (" FULL=1" if collection.full else "")


def figure_command(collection):
    """The command that makes a study's three files from the result files."""
    return f"/usr/bin/python3 -m analysis study {collection.name}" + (" --full" if collection.full else "")


def processor():
    """The processor's name as Linux tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def _split(rows):
    """(parameters that are the same in all rows, {name: values} of those that are not); None in a run older than the parameter."""
    values = {name: list(dict.fromkeys(row.get(name) for row in rows)) for name in dict.fromkeys(name for row in rows for name in row)}
    return ({name: seen[0] for name, seen in values.items() if len(seen) == 1},
            {name: sorted(seen, key=_order) for name, seen in values.items() if len(seen) > 1})


def _order(value):
    """None, then numbers, then texts, each in their own order."""
    return (value is not None, isinstance(value, str), 0 if value is None else value)


def _last(values):
    return float(values[-1]) if len(values) and math.isfinite(values[-1]) else 0.0


def publish_all(folder, results, full):
    """Publish every study that has a finished run; {name: reason} of those that have none."""
    left = {}
    for name in studies.names():
        try:
            publish(studies.collect(name, results, full), folder)
        except ResultError as error:
            left[name] = error.what
    return left
