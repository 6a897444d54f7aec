"""One load and unload of a packing: what an answer costs that is right for springs of a given stiffness, and one that is right for rigid grains."""

import matplotlib.pyplot as plt
import numpy as np

from analysis import observables, style, summary
from yade_scripts.tables import product

TITLE = "What an accurate cycle costs: springs of a given stiffness, or rigid grains?"
QUESTION = ("A load of 0.2 P0 and back: if the stiffness of the contacts is a property of the material, the strain of springs is the truth and rigid contacts "
            "miss it; if grains are rigid, it is an error. What does either method cost for a given error, held against either truth?")
ORDER = 15  # in the report
LOADING = dict(loading="cosine", period=1.0, records_per_cycle=20, wall_mass_ratio=1.0)
SPRINGS = dict(method="MD", md_walls="force", **LOADING)
RIGID = dict(method="CD", method_cd="auto", **LOADING)
# Step over stability's own unit, as far as each stiffness is affordable; the finest of the softest springs is the elastic truth.
STEPS, FINEST = {1: (0.3, 0.1, 0.03), 10: (0.3, 0.1, 0.03), 100: (0.3, 0.1)}, 0.003
TOLERANCES, CD_STEPS, SEEDS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10), (1e-3, 5e-3), (1, 2, 3)
ROWS = {"quick": product(md_dt_factor=(0.3, 0.1), **SPRINGS) + product(tolerance=(1e-4, 1e-6), **RIGID),
        "full": [row for stiffening, steps in STEPS.items() for row in product(stiffening=stiffening, md_dt_factor=steps, seed=SEEDS, **SPRINGS)]
        + product(md_dt_factor=FINEST, seed=SEEDS, **SPRINGS) + product(cd_dt=CD_STEPS, tolerance=TOLERANCES, seed=SEEDS, **RIGID)}


def summarize(runs):
    """Return one row a setting, medians over the packings.

    strain: largest |gamma| of the cycle, which is 0 for rigid grains, whose packings carry this load. elastic error: its difference to that of the
    softest springs in the finest steps, over that. seconds: processor time.
    """
    truth = {}
    for run in sorted((run for run in runs if run.method == "MD" and run.parameters["stiffening"] == 1), key=lambda run: -run.parameters["md_dt_factor"]):
        truth[run.parameters["seed"]] = _strain(run)
    return [_row(*key, group, truth) for key, group in summary.groups(runs, _key).items()]


def _key(run):
    full = run.parameters
    return (run.method, *((full["stiffening"], full["md_dt_factor"]) if run.method == "MD" else (full["cd_dt"], full["tolerance"])))


def _strain(run):
    return float(np.abs(run.values("gamma")).max())


def _row(method, first, second, group, truth):
    errors = [abs(_strain(run) / truth[run.parameters["seed"]] - 1) for run in group if run.parameters["seed"] in truth]
    return {"method": method, "stiffening" if method == "MD" else "step_s": first, "step_factor" if method == "MD" else "tolerance": second, "packings": len(group),
            "strain": float(np.median([_strain(run) for run in group])), "elastic error": float(np.median(errors)) if errors else np.nan,
            "seconds": float(np.median([run.values("processor_time")[-1] for run in group])),
            "unsolved steps": sum(observables.unconverged_steps(run) for run in group) if method == "CD" else ""}


def draw(runs, rows, path):
    """Draw the error against the cost: left against springs of the softest stiffness, right against rigid grains."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.2))
    look = style.shades([row["stiffening"] for row in rows if row["method"] == "MD"] + [1])
    finest = min((row["step_factor"] for row in rows if row["method"] == "MD" and row["stiffening"] == 1), default=0)
    for axis, name in ((left, "elastic error"), (right, "strain")):
        for stiffening, part in summary.groups((row for row in rows if row["method"] == "MD"), lambda row: row["stiffening"]).items():
            part = [row for row in part if name == "strain" or stiffening > 1 or row["step_factor"] > finest]
            axis.plot([row["seconds"] for row in part], [row[name] for row in part], color=look[stiffening], marker=style.MARKER["MD"], ms=5, lw=0.9,
                      label=rf"springs, {stiffening:g} $k_n$")
        for step, part in summary.groups((row for row in rows if row["method"] == "CD"), lambda row: row["step_s"]).items():
            axis.plot([row["seconds"] for row in part], [row[name] for row in part], color=style.COLOUR["CD"], marker=style.MARKER["CD"], ms=5, lw=0.9,
                      ls="-" if step == min(CD_STEPS) else "--", mfc=None if step == min(CD_STEPS) else "none", label=f"rigid, {1e3 * step:g} ms")
        axis.set(xscale="log", yscale="log", xlabel="processor time of a cycle [s]")
    left.set(ylabel=r"error of the largest $|\gamma|$, over it", title=r"truth: springs of $k_n$")
    right.set(ylabel=r"error: the largest $|\gamma|$ itself", title="truth: rigid grains")
    right.legend(fontsize=7)
    style.finish(fig, path, "A point a setting: step of the springs; tolerance of the rigid contacts. Medians over the packings.", runs)


ANSWER = """
Not run yet.
"""
GIVEN = ()
POINTS = ()


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    return {}
