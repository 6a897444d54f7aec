"""How much of the CD loop of Fig. 4 is error of the solver?"""
import numpy as np
import pandas

from analysis import loops, observables, style, summary
from analysis.style import plt
from yade_scripts import parameters
from yade_scripts.tables import product
from yade_scripts.theory import effective_medium

TITLE = "Is the strain of rigid grains an error of the solver?"
QUESTION = "Fig. 4's cycle by CD at tolerances from 1e-2 to 1e-10, and with fixed numbers of sweeps."
ORDER = 1.2  # in the report
LOADING = dict(loading="triangle", period=4.0)
FAST = dict(loading="triangle", period=1.0)
ROWS = {"quick": product(method="MD", **FAST) + product(method="CD", tolerance=(1e-2, 1e-4, 1e-6, 1e-8), **FAST)
        + product(method="CD", fixed_iterations=(1, 3, 10, 30), **FAST),
        "full": product(method="MD", seed=(1, 2, 3), **LOADING) + [row for settings in (
            dict(tolerance=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)), dict(fixed_iterations=(1, 2, 3, 5, 10, 30, 100, 300, 1000)),
            dict(cd_dt=(5e-4, 2e-3, 4e-3)), dict(seed=(2, 3), tolerance=(1e-2, 1e-4, 1e-6, 1e-8)), dict(seed=(2, 3), fixed_iterations=(3, 30, 300)))
                                                                for row in product(method="CD", **settings, **LOADING)]}

MD, BY_TOLERANCE, BY_SWEEPS, BY_STEP = "MD", "tolerance", "sweeps", "step"
USUAL_STEP = parameters.complete({})["cd_dt"]  # rows with another step are about the step
MARKER = {"largest": "o", "width": "s", "remanent": "^"}
SHADE = {"largest": style.INK, "width": style.COLOUR["CD"], "remanent": style.COLOUR["MD"]}


def summarize(runs):
    """Return one row a setting, over the packings; `effort` names what is varied."""
    rows = []
    for (effort, value), group in summary.groups(runs, _key, ordered=False).items():
        full, first = group[0].parameters, loops.of(summary.order(group, "seed")[0])  # of the packing that all settings have
        rows.append({"effort": effort, "value": value, "packings": len(group), **loops.spread(group),
                     "largest, packing 1": first["largest"], "width, packing 1": first["width"]})
        if effort == BY_SWEEPS:
            rows[-1]["kappa_over_kn"] = effective_medium.stiffness(full) / full["kn"]
        if effort != MD:  # the samples of the history represent all steps
            rows[-1] |= {"sweeps_a_step": np.mean([run.values("iterations")[1:].mean() for run in group]),
                         "error_median": np.median([np.median(run.values("residual")[1:]) for run in group]),
                         "unsolved_steps": sum(observables.unconverged_steps(run) for run in group),
                         "steps": sum(round(run.values("time")[-1] / effective_medium.step(full)) for run in group)}
    return rows


def _key(run):
    """Return what is varied, and its value."""
    row = run.parameters
    if run.method == "MD":
        return MD, 0.0
    if row["cd_dt"] != USUAL_STEP:
        return BY_STEP, row["cd_dt"]
    return (BY_SWEEPS, row["fixed_iterations"]) if row["fixed_iterations"] else (BY_TOLERANCE, row["tolerance"])


def draw(runs, rows, path):
    """Draw the three numbers of the loop against the tolerance, and against the sweeps, with MD's."""
    fig, panels = plt.subplots(1, 2, figsize=(9.5, 4.4), sharey=True)
    table = pandas.DataFrame(rows).sort_values("value")
    md, by_tolerance, by_sweeps = (table[table.effort == effort] for effort in (MD, BY_TOLERANCE, BY_SWEEPS))
    for axes, part, label, title in ((panels[0], by_tolerance, "tolerance on the error $e$", "solved to a tolerance"),
                                     (panels[1], by_sweeps, "sweeps a step, no test", "a fixed number of sweeps")):
        for name, words in loops.QUANTITIES.items():
            loops.draw_spread(axes, part, "value", name, fmt=MARKER[name] + "-", color=SHADE[name], label=f"CD, {words}")
            for level in md[name]:
                axes.axhline(level, color=SHADE[name], ls="--", lw=0.8)
        axes.set(xscale="log", yscale="log", xlabel=label, title=title)
    panels[0].set_ylabel("strains named in the legend")
    panels[0].legend(title="dashed: MD" if len(md) else None)
    if len(by_sweeps) and len(md):
        panels[1].plot(by_sweeps.value, md.largest.iloc[0] / by_sweeps.kappa_over_kn, ":", color="k",
                       label=r"MD's largest $|\gamma|$ times $k_n/\kappa$")
        panels[1].legend()
    style.finish(fig, path, "Bars: from the smallest to the largest of three packings, about their mean; points without bars are of one packing. "
                 "Dotted: what Unger and Kertesz (2002) expect, contacts of stiffness kappa = q m N/dt^2 after N sweeps a step dt (m: mass of a "
                 f"disk, q = {effective_medium.RELAXATION:.2g}).",
                 [run for run in runs if _key(run)[0] != BY_STEP])


POINTS = (
    (8, "and related to the precision of the method.", "section 3", "agrees"),
)


def quantities(table):
    solved, swept = (table[table.effort == effort].set_index("value").sort_index() for effort in (BY_TOLERANCE, BY_SWEEPS))
    return {"solved": solved, "swept": swept, "best": solved.iloc[0], "worst": solved.iloc[-1],
            "md": table[table.effort == MD]["largest, packing 1"].iloc[0]}
