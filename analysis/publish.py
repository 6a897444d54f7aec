"""Writes a study's figure, summary table and provenance: <name>.png, <name>.csv and <name>.json.

The rows of the study come first in the table. Runs that failed or are missing follow: the column `status` has the reason, and further columns the
parameters in which the runs differ. Floats are written with all their digits, so that tables can be compared exactly.
"""
import json
import platform
import traceback
from pathlib import Path

import h5py
import matplotlib
import numpy as np
import pandas

from analysis import observables, studies
from yade_scripts import parameters
from yade_scripts.results import provenance, schema, sealed
from yade_scripts.errors import ResultError

STATUS = "status"


class NotRun(ResultError):
    """No run of a study has finished."""


def publish(collection, folder):
    """Write the three files of a study into `folder`. Return their common stem. Raise NotRun if no run has finished."""
    if not collection.runs:
        reason = collection.missing[0][2] if collection.missing else "it has no rows"
        raise NotRun(collection.name, f"no run has finished (the first: {reason})", f"make them: {command(collection)}")
    study, stem = studies.module(collection.name), Path(folder) / collection.name
    stem.parent.mkdir(parents=True, exist_ok=True)
    rows = study.summarize(collection.runs)
    if not (isinstance(rows, list) and all(isinstance(row, dict) for row in rows)):
        raise TypeError("summarize() must return a list of dictionaries, one for each row of the table")
    rest = f"make the others: {command(collection)}"
    if not any(rows):
        raise ResultError(study.__file__, f"its summarize() makes no row of the {len(collection.runs)} runs that there are", rest)
    picture = stem.with_suffix(".png")
    written = lambda: picture.stat().st_mtime_ns if picture.exists() else None
    before = written()
    study.draw(collection.runs, rows, picture)
    if written() == before:  # an older figure beside a new table would look like success
        raise ResultError(study.__file__, f"its draw() wrote no figure of the {len(collection.runs)} runs that there are",
                          f"{rest}; if none is missing, end draw() with style.finish(fig, path, caption, runs)")
    write_table(stem.with_suffix(".csv"), rows + missing_rows(collection))
    write_json(stem.with_suffix(".json"), {"study": collection.name} | origin(collection))
    return stem


def missing_rows(collection):
    """Return one row for each run that failed or is missing: its reason, file and the parameters that differ within the study."""
    varied = _split([run.parameters for run in collection.runs] + [row for _, row, _ in collection.missing])[1]
    return [{STATUS: reason, "file": path.name} | {name: row.get(name, "") for name in varied} for path, row, reason in collection.missing]


def write_table(path, rows):
    """Write the rows as CSV under the union of their headings, `status` first; a heading that a row lacks stays empty."""
    table = pandas.DataFrame(rows)
    if STATUS in table:
        table.insert(0, STATUS, table.pop(STATUS).fillna(""))
    sealed.replace(path, table.to_csv(index=False).encode())


def read_table(path, texts=(), numbers=()):
    """Return a table written by write_table. Raise ResultError if the file is no table, or lacks one of these columns of texts and of numbers."""
    try:
        table = pandas.read_csv(path, float_precision="round_trip")  # a table that is read and written again keeps its digits
        if missing := [name for name in (*texts, *numbers) if name not in table]:
            raise ValueError(f"no column {', '.join(missing)}")
        return table.astype(dict.fromkeys(texts, object) | dict.fromkeys(numbers, float))
    except FileNotFoundError:
        raise ResultError(path, "is missing", "check its name, or make it first (`make help`)") from None
    except (OSError, ValueError) as error:
        raise ResultError(path, f"is no such table ({str(error).splitlines()[0]})", "make it again") from None


def finished(table):
    """Return the rows of a table that were measured, without those of runs that failed or are missing."""
    return table[table[STATUS].isna()] if STATUS in table else table


def write_json(path, facts):
    sealed.replace(path, (json.dumps(facts, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode())


def read_json(path, kinds):
    """Return the facts in a JSON file. Raise ResultError if it cannot be read, or if a name of {name: type} is missing or has another type."""
    try:
        found = json.loads(Path(path).read_bytes())
    except FileNotFoundError:
        raise ResultError(path, "is missing", "check its name, or make it first (`make help`)") from None
    except (OSError, ValueError, RecursionError) as error:
        raise ResultError(path, f"cannot be read ({error})", "make it again") from None
    if wrong := [name for name, kind in kinds.items() if not isinstance(found, dict) or not isinstance(found.get(name), kind)]:
        raise ResultError(path, f"{', '.join(wrong)} missing or of another kind", "make it again")
    return found


def origin(collection):
    """Return where the figure and the table come from, as plain data for JSON."""
    runs = collection.runs
    constant, varied = _split([parameters.read_by_method(run.parameters) for run in runs])
    failed = [reason for _, _, reason in collection.missing if schema.has_failed(reason)]
    return {
        "extent": "full" if collection.full else "quick", "runs_finished": len(runs), "runs_failed": len(failed),
        "runs_missing": len(collection.missing) - len(failed), "runs_collapsed": sum(run.collapsed for run in runs),
        "packings": len({run.attributes["state_sha256"] for run in runs} - {""}),
        "computing_seconds": round(float(sum(run.values("wall_clock")[-1] for run in runs)), 1),
        "unsolved_steps": sum(observables.unconverged_steps(run) for run in runs if run.method == "CD"), "energy_balance": energy_balance(runs),
        "commits": sorted({run.attributes["git_commit"] for run in runs}),
        "yade": sorted({str(run.attributes["yade_version"]) for run in runs}),
        "run_command": command(collection), "parameters": constant, "varied": varied} | machine()


def of_other_rows(name, facts, table):
    """Tell from the provenance and the table of a study whether its runs had other parameters than its rows have today; later parameters do not
    count."""
    failed = set(table.file.dropna()) if "file" in table else set()
    try:
        rows = [row for row in studies.rows(name, facts["extent"] == "full") if f"{parameters.result_name(row)}.h5" not in failed]
    except ImportError:  # rows that cannot be run are not those that were
        return True
    constant, varied = _split([parameters.read_by_method(row) for row in rows])
    return not (facts["parameters"] | facts["varied"]).items() <= (constant | varied).items()


def machine():
    """Return the versions and the processor of this machine."""
    return {"python": platform.python_version(), "numpy": np.__version__, "h5py": h5py.__version__, "matplotlib": matplotlib.__version__,
            "processor": provenance.processor()}


def energy_balance(runs):
    """Return {method: how many runs have a balance, its median and largest error}; see observables.balance_error."""
    found = {}
    for method in ("MD", "CD"):
        errors = np.abs([observables.balance_error(run) for run in runs if run.method == method])
        errors = errors[np.isfinite(errors)]
        if len(errors):
            found[method] = {"runs": len(errors), "median": float(np.median(errors)), "largest": float(errors.max())}
    return found


def command(collection):
    """Return the make command that runs a study's rows and draws it."""
    return f"make study STUDY={collection.name}" + " FULL=1" * collection.full


def _split(rows):
    """Return (parameters that are the same in all rows that have them, {name: values} of those that are not)."""
    values = {name: list(dict.fromkeys(row[name] for row in rows if name in row)) for name in dict.fromkeys(name for row in rows for name in row)}
    return ({name: seen[0] for name, seen in values.items() if len(seen) == 1},
            {name: sorted(seen, key=lambda value: (value is not None, isinstance(value, str), 0 if value is None else value))
             for name, seen in values.items() if len(seen) > 1})


def publish_all(names, folder, results, full):
    """Publish studies. Return {name: message} of those that have no finished run, and of those whose file fails."""
    waiting, faults = {}, {}
    for name in names:
        try:
            publish(studies.collect(name, results, full), folder)
        except NotRun as error:
            waiting[name] = str(error)
        except (ResultError, ImportError) as error:  # names the file, and says what to do
            faults[name] = f"{name}: its figure and table could not be made: {error}"
        except OSError:
            raise
        except Exception as error:  # a fault in one study must not cost the others their figures
            traceback.print_exc()
            faults[name] = (f"{name}: its figure and table could not be made ({type(error).__name__}: {error}); correct "
                            f"{studies.module(name).__file__}")
    return waiting, faults
