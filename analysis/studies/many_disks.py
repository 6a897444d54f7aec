"""What do four flows of 50 000 disks cost by either method?"""
import math

import numpy as np
import pandas

from analysis import flow_costs, style, summary
from analysis.flow_costs import QUANTITY
from yade_scripts import parameters
from yade_scripts.tables import product

TITLE = "Four flows of 50 000 disks"
QUESTION = "What do they cost by either method?"
ORDER = 33  # in the report
PART = "engine"

WORDS = {"filling": "filling of a box", "hopper": "a silo runs empty", "drum": "a drum turns", "collapse": "a column collapses"}
# Sizes and times grow with the number of disks so that it stays the same flow as in the study of flows.
FILLING = dict(scene="filling", seed=1)
SILO, DRUM = dict(scene="hopper", seed=1, slot=100.0), dict(scene="drum", seed=1)
COLLAPSE = dict(scene="collapse", column_aspect=2.0, radius_spread=0.2)
# Speeds and depths grow, too: a disk goes as far in 1 ms as one of 5000 disks in 1.8 ms. Newton's method is not tried for so many disks, so that
# sweeps have to be enough.
COARSE, MEDIUM, FINE = (dict(method="CD", max_iterations=20000) | dict(cd_dt=step, tolerance=tolerance)
                        for step, tolerance in ((2e-3, 1e-2), (1e-3, 1e-2), (1e-3, 1e-3)))
SOFT, STIFF = (flow_costs.LIGHT | {"kn": kn, "md_energies": True} for kn in (2e6, 2e7))
MANY = 50000
# Springs of 2e7 N/m take hundreds of seconds for a second. So they get a window from the start, at whose end longer runs of rigid contacts have a
# sample.
WINDOW = 0.2  # s
SHORT = dict(disks=MANY, period=WINDOW)
EMPTIED = dict(disks=MANY, period=1.6, records_per_cycle=32)  # until more than half of the disks have left
FALLEN = dict(disks=MANY, period=4.8, records_per_cycle=24)   # to rest
# Rigid contacts refuse the column of seed 1, in which two disks overlap by 0.34 of a radius. To springs that is a small push.
ROWS = {"quick": [row for settings in (FINE, SOFT) for row in product(disks=500, period=1.0, **FILLING, **settings)],
        "full": [row for settings in (FINE, COARSE) for row in product(disks=MANY, period=3.162, **FILLING, **settings)]
        + [row for more in (EMPTIED | COARSE, SHORT | FINE, SHORT | STIFF) for row in product(**SILO | more)]
        + [row for more in (SHORT | FINE, SHORT | STIFF) for row in product(**DRUM | more)]
        + [row for more in (FALLEN | COARSE | {"seed": (1, 2)}, SHORT | MEDIUM | {"seed": 2}, SHORT | FINE | {"seed": 2}, SHORT | STIFF | {"seed": 1})
           for row in product(**COLLAPSE | more)]}


@summary.each
def summarize(run):
    """Return one row a run.

    value: the quantity of the scene at the end; NaN of a silo that is less than half empty. passed: share of the disks that have left it.
    seconds: processor time. window_*: at the end of the window, NaN without a sample there: processor time, what a simulated second costs in its
    last quarter, work of the weights [J], kinetic energy [J]. energy: what the disks have gained, stored and lost over what the weights gave, 1 where
    no energy is made. overlap: largest one over the mean radius, from the second sample on; moving_overlap: the same until the kinetic energy has
    fallen to 1 % of its peak; mean_overlap: of the loaded contacts between disks at the end. unsolved: share of the steps beyond the tolerance;
    law: largest error e of the contact law.
    """
    row, cd, time = run.parameters, run.method == "CD", run.values("time")
    passed = float((run.snapshots[-1]["position"][:, 1] < 0).mean()) if row["scene"] == "hopper" else math.nan
    return {"scene": row["scene"], "disks": row["disks"], "method": run.method, "step": row["cd_dt"] if cd else row["md_dt_factor"],
            "setting": row["tolerance"] if cd else row["kn"], "period": row["period"], "value": float(run.extra[QUANTITY[row["scene"]]]),
            "passed": passed, "seconds": float(run.values("processor_time")[-1]), **_window(run),
            "energy": math.nan if row["scene"] == "drum" else float(_gained(run)[-1] / _weights(run)),
            "overlap": _overlap(run, len(time)), "moving_overlap": _overlap(run, _rest(run) + 1), "mean_overlap": _mean_overlap(run),
            "unsolved": float(run.values("unconverged_steps")[-1] * parameters.steps(row, row["cd_dt"])[1] / time[-1]) if cd else 0.0,
            "law": float(run.values("residual_max").max()) if cd else 0.0}


def _window(run):
    """Return what is known at the end of the window."""
    time, kinetic, seconds = (run.values(name) for name in ("time", "kinetic_energy", "processor_time"))
    at = np.flatnonzero(np.isclose(time, WINDOW))
    if not len(at):
        return dict.fromkeys(("window_seconds", "window_last", "window_work", "window_kinetic"), math.nan)
    before, end = np.interp([0.75 * WINDOW, WINDOW], time, seconds)
    # With rigid contacts energy is conserved, so the history gives the work of gravity, unless a boundary does work; with springs it is not.
    inside = _gained(run)[at[0]] if run.method == "CD" and run.parameters["scene"] != "drum" else math.nan
    return {"window_seconds": float(end), "window_last": float((end - before) / (0.25 * WINDOW)),
            "window_work": float(_weights(run) if at[0] == len(time) - 1 else inside), "window_kinetic": float(kinetic[at[0]])}


def _weights(run):
    """Return the work of the weights over the run [J]."""
    row, (first, last) = run.parameters, (run.snapshots[k] for k in (0, -1))
    masses = row["density"] * row["depth"] * math.pi * first["radius"]**2
    return float(row["gravity"] * masses @ (first["position"][:, 1] - last["position"][:, 1]))


def _gained(run):
    """Return at every sample what the disks have gained and lost since the first one: kinetic, stored and dissipated energy [J]."""
    held = run.values("kinetic_energy") + run.values("dissipated_energy") + run.values("stored_energy")
    return held - held[0]


def _rest(run):
    """Return the sample at which the kinetic energy has fallen to 1 % of its peak, the last one if it has not."""
    kinetic = run.values("kinetic_energy")
    still = np.flatnonzero((np.arange(len(kinetic)) > kinetic.argmax()) & (kinetic < 0.01 * kinetic.max()))
    return int(still[0]) if len(still) else len(kinetic) - 1


def _overlap(run, end):
    """Return the largest overlap of the samples from the second to before `end`, over the mean radius; a deposit may begin with one."""
    return float(run.values("max_penetration")[1:end].max() / run.parameters["radius_mean"])


def _mean_overlap(run):
    """Return the mean overlap of the loaded contacts between disks at the end, over the mean radius."""
    last = run.snapshots[-1]
    bodies, pairs = last["body_ids"], last["contact_ids"][last["force_normal"] > 0]
    pairs = pairs[np.isin(pairs, bodies).all(axis=1)]
    order = np.argsort(bodies)
    one, other = order[np.searchsorted(bodies, pairs, sorter=order)].T
    place, radius = last["position"], last["radius"]
    overlaps = radius[one] + radius[other] - np.hypot(*(place[one] - place[other]).T)
    return float(np.maximum(overlaps, 0).mean() / run.parameters["radius_mean"]) if len(overlaps) else 0.0


def _words(run):
    row = run.parameters
    return f"{1e3 * row['cd_dt']:g} ms, {row['tolerance']:g}" if run.method == "CD" else f"{row['kn']:g} N/m"


def draw(runs, rows, path):
    """Draw, one panel a scene, what a simulated second costs in the course of the runs of the most disks."""
    most = max(run.parameters["disks"] for run in runs)
    shown = [run for run in runs if run.parameters["disks"] == most]
    names = [scene for scene in QUANTITY if scene in {run.parameters["scene"] for run in shown}]
    styles = {words: ("-", "--", ":")[k % 3] for method in ("CD", "MD")
              for k, words in enumerate(dict.fromkeys(_words(run) for run in shown if run.method == method))}
    fig, panels = style.plt.subplots(1, len(names), figsize=(max(4.5, 2.9 * len(names)), 3.9), sharey=True, squeeze=False)
    for axes, scene in zip(panels[0], names):
        for run in (run for run in shown if run.parameters["scene"] == scene):
            time, seconds = run.values("time"), run.values("processor_time")
            rate = np.diff(seconds) / np.diff(time)
            axes.plot(time, [*rate, rate[-1]], drawstyle="steps-post", color=style.COLOUR[run.method], ls=styles[_words(run)])
        axes.set(yscale="log", xlabel="simulated time [s]", title=WORDS[scene])
        axes.set_xlim(left=0)
    panels[0][0].set_ylabel("processor time of a simulated second [s]")
    entries = {_words(run): dict(color=style.COLOUR[run.method], ls=styles[_words(run)], label=f"{run.method}, {_words(run)}") for run in shown}
    style.legend(panels[0][-1], entries.values(), fontsize=7)
    style.finish(fig, path, f"{most} disks, one run each. Labels: step and tolerance, or stiffness. Runs that end at "
                          f"{WINDOW:g} s are windows from the start, a part of the flow.", shown)


def pick(table, scene, settings, disks=MANY, **more):
    """Return the one measured row of a scene with these settings."""
    step, setting = (settings["cd_dt"], settings["tolerance"]) if settings["method"] == "CD" else (settings["md_dt_factor"], settings["kn"])
    asked = {"scene": scene, "disks": disks, "method": settings["method"], "step": step, "setting": setting} | more
    row, = table[(table[list(asked)] == pandas.Series(asked)).all(axis=1)].itertuples()
    return row


def quantities(table):
    window = table[table.window_seconds.notna() & (table.period == WINDOW)]
    scenes = ("hopper", "drum", "collapse")
    fine, stiff = (pandas.DataFrame([pick(window, scene, settings) for scene in scenes], index=scenes) for settings in (FINE, STIFF))
    whole = table[table.period > WINDOW].set_index("scene")
    fillings = table[table.scene == "filling"].to_dict("records")  # of those that stayed physical
    assert len(fillings) < 2 and "hopper" not in whole.index and stiff.window_last.drum < fine.window_last.drum
    return {"fine": fine, "stiff": stiff, "column": whole.loc["collapse"], "fillings": fillings, "window": WINDOW}
