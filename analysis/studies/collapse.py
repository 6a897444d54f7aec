"""When a packing collapses under cycles, by what is changed one thing at a time."""

import matplotlib.pyplot as plt
import numpy as np

from analysis import limits, observables, style, summary
from yade_scripts.tables import product

TITLE = "What decides when a packing collapses"
QUESTION = ("With the mean stress held, springs and rigid contacts both collapse under cycles that pass the static limit. In which cycle, and is it the "
            "stiffness, the solver's error, the choice of the force network, the tangential law, the walls or the period that decides?")
ORDER = 5  # in the report
LOADING = dict(loading="cosine", period=0.5, records_per_cycle=20, cycles=40, wall_mass_ratio=1.0, stress_path="mean")
SLOW = dict(period=2.0, records_per_cycle=40, cycles=10)
SPRINGS = dict(method="MD", md_dt_factor=0.3, md_walls="force", **LOADING)
RIGID = dict(method="CD", cd_dt=2.5e-3, tolerance=1e-8, method_cd="auto", **LOADING)
# What is changed of springs and of rigid contacts; the packings of 10 k_n are the same ones, stiffened.
SPRING_CASES = {"springs": {}, "10 k_n": dict(stiffening=10.0), "step / 3": dict(md_dt_factor=0.1), "path-independent law": dict(tangential_law="path_independent"),
                "servo for walls": dict(md_walls="servo"), "springs, 2 s": SLOW}
RIGID_CASES = {"rigid": {}, "packing of 10 k_n": dict(stiffening=10.0), "tolerance 1e-6": dict(tolerance=1e-6), "step / 5": dict(cd_dt=5e-4),
               "other forces": dict(network_seed=1), "rigid, 2 s": SLOW}
LOADS, SEEDS = (0.3, 0.4), range(1, 7)
ROWS = {"quick": product(delta_sigma=0.4, **SPRINGS) + product(delta_sigma=0.4, **RIGID),
        "full": [row for base, cases in ((SPRINGS, SPRING_CASES), (RIGID, RIGID_CASES)) for change in cases.values()
                 for row in product(**base | change | dict(delta_sigma=LOADS, seed=SEEDS))]}


def case(run):
    """Return the name of what is changed in a run."""
    base, cases = (SPRINGS, SPRING_CASES) if run.method == "MD" else (RIGID, RIGID_CASES)
    return next(name for name, change in cases.items() if all(run.parameters[key] == value for key, value in (base | dict(stiffening=1.0) | change).items())
                and run.parameters["tangential_law"] == change.get("tangential_law", "standard")
                and run.parameters["network_seed"] == change.get("network_seed", 0))


def summarize(runs):
    """Return one row a run: when it collapses, in cycles and seconds, or how far it has strained where it stands."""
    return [_row(run) for run in runs]


def _row(run):
    full, collapsed = run.parameters, run.collapsed
    return {"method": run.method, "case": case(run), "dSigma": full["delta_sigma"], "seed": full["seed"], "static limit": limits.static_limit(run),
            "load over limit": limits.load_over_limit(run), "collapses after": float(run.values("cycle")[-1]) if collapsed else np.nan,
            "seconds": float(run.values("time")[-1]) if collapsed else np.nan, "stands": np.nan if collapsed else float(run.values("cycle")[-1]),
            "gamma at the end": float(run.values("gamma")[-1]), "unsolved steps": observables.unconverged_steps(run) if run.method == "CD" else "",
            "balance error": float(observables.balance_error(run)), "outcome": run.outcome}


def draw(runs, rows, path):
    """Draw for every case the cycle in which each packing collapses, a panel a load; what still stands is drawn open at its last cycle."""
    names = list(dict.fromkeys(row["case"] for row in rows))
    loads = summary.groups(rows, lambda row: row["dSigma"])
    fig, axes = plt.subplots(1, len(loads), figsize=(3 + 4 * len(loads), 4.4), squeeze=False, sharey=True)
    for axis, (load, own) in zip(axes[0], loads.items()):
        for row in own:
            place = names.index(row["case"]) + 0.07 * (row["seed"] - 3.5)
            stands = np.isnan(row["collapses after"])
            axis.plot(row["stands"] if stands else row["collapses after"], place, ls="", marker=style.MARKER[row["method"]], ms=5,
                      color=style.COLOUR[row["method"]], mfc="none" if stands else None)
        axis.set(xscale="log", xlabel="cycles until collapse", title=rf"$\Delta\sigma$ = {load:g}")
        axis.grid(color="#DDDDDD", linewidth=0.5)
    axes[0, 0].set_yticks(range(len(names)), names)
    axes[0, 0].invert_yaxis()
    style.finish(fig, path, "A point a packing. Open: it still stands after so many cycles.", runs)


ANSWER = """
Not run yet.
"""
GIVEN = ()
POINTS = ()


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    return {}
