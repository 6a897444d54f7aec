"""Measures settings of one scene in one YADE: error and time of computing of each, appended to the scene's records.

    yade -n -x yade_scripts/charts/measure.py --results=results --limit=10 --rows=rows.json

rows.json holds a list of rows. The time is that between the first and the last step's end, without start-up, scene building, preparation and
output; it is the median of at least three repeats, each of the scene built anew. A run that takes longer than the limit [s] is ended by
SIGPROF (processor time), which ends the process: whoever started it reads in <rows>.begun which row that was, and starts the others in a new one.
"""
import json
import math
import pathlib
import signal
import sys
import traceback

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[2]))

from yade import O, config

from analysis.publish import processor
from analysis.schema import STATUS_FAILED
from yade_scripts import accuracy, bare_run, commits, hooks, parameters, scenes
from yade_scripts.charts import records, settings

LEAST, MOST = 3, 9     # repeats
ENOUGH = 0.1           # s: short runs are repeated more often, up to this in all
MEASURING = 5          # limits that a run may take while the scene measures in its steps, which is not counted
PREPARATION = 600      # s a packing may take that is not there yet


def measure(row, folder, limit, origin):
    """The record of a row; `folder` holds results and prepared packings, origin: the record's keys that tell where it comes from."""
    own, asked = settings.split(row)
    full = parameters.complete(own)
    record = {"name": settings.name(row), "scene": full["scene"], "method": full["method"], "row": row, "parameters": full, "limit": limit} | origin
    seconds, known = [], {}
    try:
        while len(seconds) < LEAST or (len(seconds) < MOST and sum(seconds) < ENOUGH):
            spent, known, more = run(own, asked, folder, limit, known)
            seconds += [spent] if spent is not None else []
            record |= more
    except Exception as error:
        if not isinstance(error, (RuntimeError, ValueError, ArithmeticError)):
            traceback.print_exception(error)
        return record | {"status": f"{STATUS_FAILED}{str(error).splitlines()[0] if str(error) else type(error).__name__}", "seconds": seconds}
    finally:
        _allow(0)
    error = records.error(known)
    return record | {"status": records.status(known), "known": known, "error": error if math.isfinite(error) else None, "seconds": seconds,
                     "steps": O.iter, "disks": sum(b.state.blockedDOFs != "xyzXYZ" for b in O.bodies)} | solver(full)


def run(row, asked, folder, limit, known):
    """(seconds, {name: value of a Known}, what else the record says) of one run, or of a search for the accuracy `asked`.

    A scene that measures in the course of its steps, which costs more than they do, has its numbers from a first run without a time (None), and
    its times from runs that do not measure; known: the numbers so far.
    """
    _allow(PREPARATION)
    full = parameters.complete(row)
    scene = scenes.build(full, folder)
    if not scene.known:
        raise parameters.ParameterError("nothing is known of the scene with these parameters")
    measures, more = bare_run.measures(), {}
    _allow(limit * (MEASURING if measures else 1))
    if measures and known and not asked:
        return bare_run.run(scene, full, without=bare_run.RECORDING | {hooks.MEASURING}), known, more
    if asked:
        levels = accuracy.search(row, asked, accuracy.run_in_yade(folder))
        scene, spent = levels[-1][0].scene, sum(level.seconds for level, _ in levels)
        more = {"levels": len(levels), "estimate": levels[-1][1]}
    else:
        spent = bare_run.run(scene, full)
    return None if measures and not asked else spent, {one.name: values(one, full["scene"]) for one in scene.known}, more


def _allow(seconds):
    """So much processor time from now on, 0: as much as it takes; one that waits in vain is ended after twenty times as long by the clock."""
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.alarm(20 * seconds)


def values(known, scene):
    """What a record says of a Known."""
    measured = float(known.measure())
    return {"measured": measured if math.isfinite(measured) else None, "exact": settings.EXACT.get(scene, {}).get(known.name, known.exact),
            "unit": known.unit, "scale": known.scale, "source": known.source, "deviation": known.deviation}


def solver(full):
    """What CD's solver did in the run, the last one of a search."""
    if full["method"] != "CD":
        return {}
    engine = bare_run.contact_dynamics()
    return {"sweeps": engine.totalIterations, "unconverged_steps": engine.unconvergedSteps}


def main(arguments):
    """Measure all rows of the file."""
    options = dict(argument.lstrip("-").split("=", 1) for argument in arguments)
    rows, limit, folder = pathlib.Path(options["rows"]), int(options["limit"]), options["results"]
    origin = {"git_commit": commits.git_commit(), "yade_version": config.version, "processor": processor()}
    for row in json.loads(rows.read_text()):
        rows.with_suffix(".begun").write_text(json.dumps(row))
        record = measure(row, folder, limit, origin)
        records.add(record, folder)
        print(f"{record['name']}: {record['status']}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
