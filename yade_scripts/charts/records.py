"""What is kept of every measured setting: one JSON object a line in results/charts/<scene>.jsonl. Needs no YADE.

A record holds `name` (scene, method, hash of the parameters, as a result file's), `row` and full `parameters`, `status` ('finished' or
'failed: reason'), `known` {name: {measured, exact, scale, unit, source, deviation}}, `error`, `seconds` (of every repeat, inside YADE's loop alone), `steps`,
`sweeps`, `unconverged_steps`, `disks`, what the scene says of itself, `limit` [s] that each repeat had, and where it comes from: `git_commit`,
`yade_version`, `processor`. Of several records of one name the last counts.
"""
import json
import math
import pathlib

from analysis.load import ResultError
from analysis.schema import STATUS_FAILED, STATUS_FINISHED, relative_error

FOLDER = "charts"
# Of an error, in scales of its known: beyond it nothing of the solution is left.
DIVERGED = 100.0

# What has to be in a record that charts can use, by its kind; NUMBERS may be null.
TEXTS = "status", "scene", "git_commit", "processor"
NUMBERS = "error", "steps", "sweeps", "unconverged_steps", "disks"
OF_KNOWN = "exact", "scale", "deviation"
REMEDY = "delete its line; make charts measures it again"


def path(scene, results):
    """The file of a scene's records."""
    return pathlib.Path(results) / FOLDER / f"{scene}.jsonl"


def read(scene, results):
    """{name: record} of a scene; a line cut short by a crash is left out. ResultError for one that is no record."""
    found, source = {}, path(scene, results)
    try:
        lines = source.read_bytes().split(b"\n")
    except FileNotFoundError:
        return found
    for number, line in enumerate(lines, 1):
        try:
            record = json.loads(line)
        except (ValueError, RecursionError):
            continue
        if not isinstance(record, dict) or not all(isinstance(record.get(name), str) for name in ("name", "status")):
            raise ResultError(f"{source}:{number}", "no record of a setting, it has no name or status", REMEDY)
        found[record["name"]] = record
    return found


def check(record, source):
    """ResultError for a record that charts cannot use: values that are missing or of another kind."""
    known = record.get("known", {})
    wrong = [name for name in TEXTS if not isinstance(record.get(name), str)]
    wrong += [name for name in NUMBERS if record.get(name) is not None and not _is_number(record[name])]
    wrong += ["row"] * (not isinstance(record.get("row"), dict))
    wrong += ["seconds"] * (not isinstance(record.get("seconds"), list) or not all(map(_is_number, record["seconds"])))
    wrong += ["known"] * (not isinstance(known, dict) or not all(map(_is_known, known.values())))
    if record.get("status") == STATUS_FINISHED:
        wrong += [name for name in ("known", "error", "seconds") if not record.get(name) and record.get(name) != 0]
    if wrong:
        raise ResultError(source, f"{' and '.join(dict.fromkeys(wrong))} of record {record['name']} missing or of another kind", REMEDY)


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300  # which also integers that are no float miss


def _is_known(one):
    return isinstance(one, dict) and all(_is_number(one.get(name, 0)) for name in OF_KNOWN) and one.get("scale") and "exact" in one and "measured" in one and (
        one["measured"] is None or _is_number(one["measured"]))


def add(record, results):
    """Append a record."""
    target = path(record["scene"], results)
    target.parent.mkdir(parents=True, exist_ok=True)
    with open(target, "a+") as file:
        # Behind a line cut short by a crash a new one begins.
        whole = file.tell() == 0 or target.read_bytes().endswith(b"\n")
        file.write("\n" * (not whole) + json.dumps(record, allow_nan=False) + "\n")


def relative(one):
    """Relative error of one of a record's knowns that was measured."""
    return relative_error(one["measured"], one["exact"], one["scale"], one.get("deviation", 0.0))


def error(known):
    """Largest relative error |measured - exact|/scale of a record's knowns; NaN where one was not measured."""
    return max((math.nan if one["measured"] is None else relative(one) for one in known.values()),
               key=lambda value: math.inf if math.isnan(value) else value, default=math.nan)


def status(known):
    """'finished', or why the measured values are no solution."""
    if not known:
        return f"{STATUS_FAILED}nothing is known of the scene"
    lost = [name for name, one in known.items() if one["measured"] is None]
    if lost:
        return f"{STATUS_FAILED}{lost[0]} is not a number"
    if error(known) > DIVERGED:
        return f"{STATUS_FAILED}wrong by more than {DIVERGED:g} times its scale"
    return STATUS_FINISHED


def done(record, limit):
    """Whether a setting needs no run: it has ended, and not for want of time that there would be now."""
    return record is not None and (record["status"] == STATUS_FINISHED or not record.get("out_of_time") or record.get("limit", 0) >= limit)
