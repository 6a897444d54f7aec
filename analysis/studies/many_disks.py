"""What do four flows of 50 000 disks cost by either method?"""
import math

import numpy as np
import pandas

from analysis import style, summary
from yade_scripts.tables import product

TITLE = "Four flows of 50 000 disks"
QUESTION = ("Flows gain more from rigid contacts the more disks there are. What do a filling, a silo, a drum and a collapse of 50 000 disks cost by "
            "either method, and does what holds for 5000 disks hold for them?")
ORDER = 22  # in the report

QUANTITY = {"filling": "height", "hopper": "rate", "drum": "slope", "collapse": "front"}
WORDS = {"filling": "filling of a box", "hopper": "discharge of a silo", "drum": "slope of a drum", "collapse": "front of a collapse"}
# Sizes and times grow with the number of disks so that it stays the same flow as in the study of flows.
FILLING = dict(scene="filling", seed=1)
SILO, DRUM = dict(scene="hopper", seed=1), dict(scene="drum", seed=1)
COLLAPSE = dict(scene="collapse", seed=1, column_aspect=2.0, radius_spread=0.2)
FINE, COARSE = dict(method="CD", cd_dt=1e-3, tolerance=1e-3), dict(method="CD", cd_dt=2e-3, tolerance=1e-2)
# Speeds and depth grow with the number of disks, too, so that a disk goes as far in 1 ms as one of 5000 in 1.8 ms.
MEDIUM = dict(method="CD", cd_dt=1e-3, tolerance=1e-2)
SOFT, STIFF = (dict(method="MD", md_dt_factor=0.3, kn=kn) for kn in (2e6, 2e7))
MANY, FEWER = 50000, 5000
# Springs of 2e7 N/m take some 1000 s for a second: they get a window from the start, which every long run of rigid contacts has a sample at the end of.
WINDOW = 0.2  # s
EMPTIED = dict(disks=MANY, slot=100.0, period=1.6, records_per_cycle=32)  # until more than half of the disks have left
FALLEN = dict(disks=MANY, period=4.8, records_per_cycle=24)               # to rest
TURNED = dict(disks=MANY, period=4.8, records_per_cycle=24)               # half the time of the study of flows
LIKE_TURNED = dict(disks=FEWER, period=2.7)                               # the same angle of a smaller drum
SHORT = dict(disks=MANY, period=WINDOW)
ROWS = {"quick": [row for settings in (FINE, SOFT) for row in product(disks=500, period=1.0, **FILLING, **settings)],
        "full": [row for settings in (FINE, COARSE, SOFT) for row in product(disks=MANY, period=3.162, **FILLING, **settings)]
        + [row for settings in (COARSE, MEDIUM) for row in product(**SILO | EMPTIED | settings)]
        + [row for settings in (FINE, STIFF) for row in product(**SILO | SHORT | {"slot": 100.0} | settings)]
        + [row for more in (LIKE_TURNED | FINE, LIKE_TURNED | MEDIUM, TURNED | MEDIUM, SHORT | FINE, SHORT | STIFF) for row in product(**DRUM | more)]
        + [row for more in (dict(disks=FEWER, period=2.667) | MEDIUM, FALLEN | COARSE, FALLEN | MEDIUM, SHORT | FINE, SHORT | STIFF)
           for row in product(**COLLAPSE | more)]}


@summary.each
def summarize(run):
    """Return one row a run.

    value: the quantity of the scene at the end; NaN of a silo that is less than half empty. seconds: processor time. At the end of the window:
    its part of `seconds`, the work of the weights [J], the kinetic energy [J]; NaN where there is no sample. energy: what the disks have gained,
    stored and lost over what the weights gave, 1 where no energy is made. overlap: largest one over the mean radius, from the second sample on
    (the deposit may begin with one); mean_overlap: of the loaded contacts between disks at the end. unsolved: share of the steps beyond the tolerance.
    """
    row, cd, time = run.parameters, run.method == "CD", run.values("time")
    weights, gained = _weights(run), _gained(run)
    at, driven = np.flatnonzero(np.isclose(time, WINDOW)), row["scene"] == "drum"
    in_window = {"window_seconds": math.nan, "window_work": math.nan, "window_kinetic": math.nan}
    if len(at):
        # Books of rigid contacts close, so what the weights gave stands in the history; those of springs do not.
        work = weights if at[0] == len(time) - 1 else gained[at[0]] if cd and not driven else math.nan
        in_window = {"window_seconds": float(run.values("processor_time")[at[0]]), "window_work": float(work),
                     "window_kinetic": float(run.values("kinetic_energy")[at[0]])}
    return {"scene": row["scene"], "disks": row["disks"], "method": run.method, "step": row["cd_dt"] if cd else row["md_dt_factor"],
            "setting": row["tolerance"] if cd else row["kn"], "period": row["period"], "value": float(run.extra[QUANTITY[row["scene"]]]),
            "seconds": float(run.values("processor_time")[-1]), **in_window, "energy": math.nan if driven else float(gained[-1] / weights),
            "overlap": float(run.values("max_penetration")[1:].max() / row["radius_mean"]), "mean_overlap": _mean_overlap(run),
            "unsolved": float(run.values("unconverged_steps")[-1] * row["cd_dt"] / time[-1]) if cd else 0.0}


def _weights(run):
    """Return the work of the weights over the run [J]."""
    row, (first, last) = run.parameters, (run.snapshots[k] for k in (0, -1))
    masses = row["density"] * row["depth"] * math.pi * np.asarray(first["radius"])**2
    return float(row["gravity"] * masses @ (np.asarray(first["position"])[:, 1] - np.asarray(last["position"])[:, 1]))


def _gained(run):
    """Return at every sample what the disks have gained and lost since the first one: kinetic, stored and dissipated energy [J]."""
    held = run.values("kinetic_energy") + run.values("dissipated_energy") + run.values("stored_energy")
    return held - held[0]


def _mean_overlap(run):
    """Return the mean overlap of the loaded contacts between disks at the end, over the mean radius."""
    last = run.snapshots[-1]
    bodies, pairs = np.asarray(last["body_ids"]), np.asarray(last["contact_ids"])[np.asarray(last["force_normal"]) > 0]
    pairs = pairs[np.isin(pairs, bodies).all(axis=1)]
    order = np.argsort(bodies)
    one, other = order[np.searchsorted(bodies, pairs, sorter=order)].T
    place, radius = np.asarray(last["position"]), np.asarray(last["radius"])
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
            axes.stairs(np.diff(seconds) / np.diff(time), time, baseline=None, color=style.COLOUR[run.method], ls=styles[_words(run)])
        axes.set(yscale="log", xlabel="simulated time [s]", title=WORDS[scene])
        axes.set_xlim(left=0)
    panels[0][0].set_ylabel("processor time of a simulated second [s]")
    entries = {_words(run): dict(color=style.COLOUR[run.method], ls=styles[_words(run)], label=f"{run.method}, {_words(run)}") for run in shown}
    style.legend(panels[0][-1], entries.values(), fontsize=7)
    style.finish(fig, path, f"{most} disks, one run each. Labels: step and tolerance, or stiffness of the springs.", runs)
