"""The cost of a given accuracy by each method, where the reference is rigid grains or springs of a given stiffness."""
import matplotlib.pyplot as plt
import numpy as np

from analysis import observables, style, summary
from yade_scripts import parameters
from yade_scripts.tables import product

TITLE = "What does an accurate load cycle cost?"
QUESTION = "Time against error, if rigid grains are the exact answer, and if springs of k_n are."
ORDER = 10  # in the report
# Few samples, since their recording counts as time of computing.
CYCLE = dict(loading="cosine", period=1.0, records_per_cycle=20, wall_mass_ratio=1.0, delta_sigma=0.2)
SPRINGS, RIGID = dict(method="MD", md_walls="force", md_energies=False, **CYCLE), dict(method="CD", **CYCLE)
SEEDS = (1, 2, 3)
STEPS, FINEST = (0.4, 0.3, 0.1, 0.03), 0.01  # beyond 0.45 to 0.5 the springs are unstable
# Stiffer springs answer faster, as 1/sqrt(k_n), so that their cycle may be shorter [s]; rigid grains that rest, rest at any rate.
FASTER = {10: 0.316, 100: 0.1}
# Springs in Contact Dynamics: the step, and the tolerance at one step.
IMPLICIT, IMPLICIT_STEPS, IMPLICIT_TOLERANCES = RIGID | dict(cd_contacts="springs"), (5e-3, 2.5e-3, 1e-3, 5e-4, 2.5e-4), (1e-4, 1e-2, 1.0)
ROWS = {"quick": product(md_dt_factor=STEPS[:2], **SPRINGS) + product(tolerance=(1e-2, 1e-6), cd_dt=5e-3, **RIGID)
        + product(cd_dt=(5e-3, 1e-3), **IMPLICIT),
        "full": [row for stiffness, period in FASTER.items()
                 for row in product(stiffening=stiffness, md_dt_factor=STEPS[:3], seed=SEEDS, **SPRINGS | dict(period=period))]
        + product(cd_dt=5e-3, tolerance=(1e-4, 1e-6, 1e-8), seed=SEEDS, **RIGID | dict(period=FASTER[100]))
        + product(md_dt_factor=STEPS, seed=SEEDS, **SPRINGS) + product(md_dt_factor=FINEST, seed=SEEDS, **SPRINGS | dict(records_per_cycle=200))
        + product(cd_dt=(5e-3, 1e-3), tolerance=(1e-2, 1e-4, 1e-6, 1e-8), seed=SEEDS, **RIGID)
        + product(cd_dt=IMPLICIT_STEPS, seed=SEEDS, **IMPLICIT) + product(cd_dt=1e-3, tolerance=IMPLICIT_TOLERANCES, seed=SEEDS, **IMPLICIT)
        + product(cd_dt=(5e-3, 1e-3), stiffening=(10, 100, 10000), seed=SEEDS, **IMPLICIT)}


def summarize(runs):
    """Return one row a setting, over the packings, with its errors and its processor time [s] (medians).

    The errors are of |gamma| at the largest load: against rigid grains, which do not strain below the static limit (rigid error), and against
    springs of k_n with the smallest step (elastic error), both over the strain of the latter.
    """
    soft = [run for run in runs if run.method == "MD" and run.parameters["stiffening"] == 1]
    soft.sort(key=lambda run: -run.parameters["md_dt_factor"])  # of the runs of a seed the last one, of the smallest step, stays
    truth = {run.parameters["seed"]: _strain(run) for run in soft}
    return [_cycle(key, group, truth) for key, group in summary.groups(runs, _key).items()]


def _key(run):
    """Return what tells settings apart: method, period [s], stiffness of the springs over k_n, step, tolerance."""
    row = run.parameters
    stiffness = row["stiffening"]
    if run.method == "MD":
        return "MD", row["period"], stiffness, row["md_dt_factor"], 0.0
    return "CD", row["period"], stiffness if row["cd_contacts"] == "springs" else 0.0, row["cd_dt"], row["tolerance"]


def _strain(run):
    """Return |gamma| at the largest load."""
    return float(abs(np.interp(run.parameters["period"] / 2, run.values("time"), run.values("gamma"))))


def _cycle(key, group, truth):
    strains = [(_strain(run), truth.get(run.parameters["seed"], np.nan)) for run in group]
    rigid, elastic = ([found / true for found, true in strains], [abs(found - true) / true for found, true in strains])
    method, period, stiffness, step, tolerance = key
    return {
        "method": method, "period": period, "springs over k_n": stiffness or "", "step": step, "tolerance": tolerance or "", "runs": len(group),
        "seconds": float(np.median([run.values("processor_time")[-1] for run in group])),
        "rigid error": float(np.median(rigid)), "least rigid error": min(rigid), "largest rigid error": max(rigid),
        "elastic error": float(np.median(elastic)), "|gamma|": float(np.median([strain for strain, _ in strains])),
        "unsolved steps": max(observables.unconverged_steps(run) for run in group) if key[0] == "CD" else ""}


def draw(runs, rows, path):
    """Draw error against processor time with both references. Lines: the least error of MD that costs no more, and of springs in CD."""
    panels = ("rigid error", "reference: rigid grains"), ("elastic error", r"reference: springs of $k_n$")
    fig, axes = plt.subplots(1, len(panels), figsize=(3.8 * len(panels) + 1.8, 4.2), squeeze=False)
    looks, drawn = _looks(rows), {}
    for axis, (name, title) in zip(axes[0], panels):
        own = [row for row in rows if abs(row[name]) > 0]
        for series, look in looks.items():
            for size, short in ((3, True), (6, False)):
                if points := [row for row in own if _series(row) == series and (row["period"] < CYCLE["period"]) == short]:
                    drawn[series], = axis.plot([row["seconds"] for row in points], [abs(row[name]) for row in points], ls="", ms=size, **look)
        for method, dashes in (("MD", "-"), ("CD", "--")):
            front = [(row["seconds"], abs(row[name])) for row in own if row["method"] == method and row["springs over k_n"]]
            ordered = np.array(sorted(front)).reshape(-1, 2)
            axis.step(ordered[:, 0], np.minimum.accumulate(ordered[:, 1]), where="post", color=style.GREY["88"], lw=0.8, ls=dashes)
        axis.set(xscale="log", yscale="log", xlabel="processor time of a run [s]", title=title)
    axes[0, 0].set_ylabel(r"error of $|\gamma|$ over $|\gamma|$ of springs of $k_n$")
    shown = [series for series in looks if series in drawn]
    axes[0, -1].legend([drawn[series] for series in shown], [looks[series]["label"] for series in shown], loc="center left",
                       bbox_to_anchor=(1.0, 0.5))
    style.finish(fig, path, "Each point is one setting of stiffness, step and tolerance. Small points: cycles of 0.1 s (springs of 10 k_n: "
                 "0.316 s); the others: 1 s. Grey lines: the least error of springs at that cost, full by MD, dashed in CD.", runs)


def _series(row):
    return row["method"], row["springs over k_n"]


def _looks(rows):
    """Return {series: its marker, colour and name}: springs of MD and in CD by stiffness, rigid contacts."""
    found = {_series(row) for row in rows}
    shades = style.shades(stiffness for _, stiffness in found if stiffness)
    looks = {(method, stiffness): dict(marker=marker, color=colour, mfc=face, label=f"{words}, {stiffness:g} $k_n$")
             for method, marker, face, words in (("MD", style.MARKER["MD"], None, "springs (MD)"), ("CD", "D", "none", "springs in CD"))
             for stiffness, colour in shades.items()}
    looks["CD", ""] = dict(marker=style.MARKER["CD"], color=style.COLOUR["CD"], mfc="none", label="rigid contacts (CD)")
    return {series: look for series, look in looks.items() if series in found}


def quantities(table):
    kinds = table.method.where((table.method == "MD") | table["springs over k_n"].isna(), "springs in CD")
    cycle = dict(list(table.groupby(kinds)))
    springs = cycle["MD"].set_index(["period", "springs over k_n", "step"])
    rigid = cycle["CD"].set_index(["period", "step", "tolerance"])
    implicit = cycle["springs in CD"].set_index(["springs over k_n", "step", "tolerance"]).sort_index()
    by_step = implicit.xs((1.0, parameters.SPRING_TOLERANCE), level=("springs over k_n", "tolerance"))
    usual, short, longest = CYCLE["period"], FASTER[100], STEPS[0]
    finest, soft, faster = springs.loc[usual, 1.0, FINEST], springs.loc[usual, 1.0, longest], springs.loc[short, 100.0, longest]
    loose, hasty, strict = rigid.loc[usual, 5e-3, 1e-6], rigid.loc[short, 5e-3, 1e-6], rigid.loc[usual, 5e-3, 1e-8]
    assert rigid[rigid.index.get_level_values("tolerance") <= 1e-6]["elastic error"].min() > 0.98 and hasty["rigid error"] < loose["rigid error"]
    return locals()
