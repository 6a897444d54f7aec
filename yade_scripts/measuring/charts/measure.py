"""Measures one setting of a scene inside YADE: its error and its computing time.

The time runs from the start of the first step to the end of the last, without start-up, building the scene, preparation and output. It is the
median of at least three repeats, each of the scene built anew.
"""
import math
import traceback

from yade import O

import cd_engine
from yade_scripts import accuracy, parameters, scenes
from yade_scripts.errors import ParameterError
from yade_scripts.measuring import charts, store
from yade_scripts.results.schema import STATUS_FAILED, STATUS_UNSTABLE
from yade_scripts.running import bodies, hooks, timing

LEAST, MOST = 3, 9     # repeats
ENOUGH = 0.1           # s: short runs are repeated up to this total time, or MOST times
MEASURING = 5          # limits that a run may take if the scene measures within its steps; that time does not count
PREPARATION = 600      # s that the preparation of a missing packing may take


def left(work, begun):
    """Measure what is left of a chart's work. Before each setting, call begun(name, seconds) with the processor time that it may take."""
    for setting in work.left():
        facts, known = measure(setting.row, work.folder.parent, work.limit, lambda seconds: begun(setting.name, seconds))
        store.add(work.folder, facts, known)
        print(f"{setting.name}: {facts['status']}", flush=True)


def measure(row, folder, limit, allow):
    """Return (facts, known quantities as rows). `folder` holds the prepared packings; allow(seconds) sets the processor time allowed from now on."""
    own, asked = store.split(row)
    full = parameters.complete(own)
    facts = {"row": row, "limit": limit}
    seconds, known = [], []
    try:
        while len(seconds) < LEAST or (len(seconds) < MOST and sum(seconds) < ENOUGH):
            spent, known = run(own, asked, folder, limit, known, allow)
            seconds += [spent] if spent is not None else []
    except Exception as error:
        if not isinstance(error, (RuntimeError, ValueError, ArithmeticError)):
            traceback.print_exception(error)
        kind = STATUS_UNSTABLE if isinstance(error, cd_engine.Unstable) else STATUS_FAILED
        return facts | {"status": kind + (str(error).splitlines() or [type(error).__name__])[0], "seconds": seconds}, []
    error = charts.error(known)
    facts |= {"status": charts.status(known), "error": error if math.isfinite(error) else None, "seconds": seconds, "steps": O.iter,
              "disks": sum(b.state.blockedDOFs != "xyzXYZ" for b in bodies.disks()) or len(bodies.disks())}
    if full["method"] == "CD":
        engine = hooks.engine("ContactDynamics")
        facts |= {"sweeps": engine.totalIterations, "unconverged_steps": engine.unconvergedSteps}
    return facts, known


def run(row, asked, folder, limit, known, allow):
    """Return (seconds, known quantities) of one run, or of a search for the accuracy `asked`.

    Some scenes measure during their steps, which costs more than the steps. Their numbers come from a first run, which has no time (None); their
    times come from later runs that do not measure. known: the quantities measured so far.
    """
    allow(PREPARATION)
    full = parameters.complete(row)
    scene = scenes.build(full, folder)
    if not scene.known:
        raise ParameterError("the scene has no quantity with a known value with these parameters")
    measures = timing.measures()
    allow(limit * (MEASURING if measures else 1))
    if measures and known and not asked:
        return timing.run(scene, full, without=timing.RECORDING | {hooks.MEASURING}), known
    if asked:
        levels = accuracy.search(row, asked, accuracy.run_in_yade(folder))
        scene, spent = levels[-1][0].scene, sum(level.seconds for level, _ in levels)
    else:
        spent = timing.run(scene, full)
    return None if measures and not asked else spent, [values(one, full["scene"]) for one in scene.known]


def values(known, scene):
    measured, exact = float(known.measure()), charts.chart_of(scene).exact.get(known.name, known.exact)
    return {"name": known.name, "measured": measured if math.isfinite(measured) else None, "exact": float(exact), "unit": known.unit,
            "scale": float(known.scale), "source": known.source, "deviation": float(known.deviation)}
