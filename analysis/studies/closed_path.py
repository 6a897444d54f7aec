"""Force and energy that tangential laws leave after a closed path of two disks; theory: yade_scripts/scenes/two_grain_path.py."""
import numpy as np
import pandas

from analysis import style, summary
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "What do tangential laws do on a closed path?"
QUESTION = "Two disks led along a closed path without slip: three laws of MD, and springs in Contact Dynamics."
ORDER = 23  # in the report
PART = "appendix"
PATHS = dict(scene="two_grain_path", path_depth=(1e-4, 1e-3, 1e-2, 1e-1))
MD = PATHS | dict(tangential_law=("standard", "avoid_ratcheting", "path_independent"))
IMPLICIT = "springs in CD"
# The last rows take four times the steps: the error of the step falls.
ROWS = {"quick": product(path_angle=0.1, **MD) + product(path_angle=0.1, method="CD", **PATHS),
        "full": [row for settings in (MD, PATHS | dict(method="CD"))
                 for row in product(path_angle=(0.01, 0.03, 0.1, 0.3), **settings) + product(path_angle=0.3, period=4.0, **settings)]}

LAWS = {"standard": ("standard (Cundall-Strack)", style.BLUE, "o"), "avoid_ratcheting": ("YADE's avoidGranularRatcheting", style.VERMILION, "s"),
        "path_independent": ("path-independent: round-off", style.INK, "^"), IMPLICIT: ("springs in Contact Dynamics", style.GREEN, "x")}
# Theory for infinitely small steps, as functions of s = h/(2R): force left, size of the work.
SMALL_STEPS = {("standard", "left_force"): lambda s: s, ("standard", "loop_work"): lambda s: s**2, ("avoid_ratcheting", "loop_work"): lambda s: s}
FLOOR = 1e-18  # where a zero is drawn on the logarithmic axes


@summary.each
def summarize(run):
    """Return the row of a run: force and work over the largest force k_t 2R A and the largest energy k_t (2R A)^2/2 of the spring."""
    row, force, work = run.parameters, run.known["left_force"], run.known["loop_work"]
    share = row["path_depth"] / 2  # of the units in which the scene gives the force
    law = row["tangential_law"] if run.method == "MD" else IMPLICIT
    return {"law": law, "path_depth": row["path_depth"], "path_angle": row["path_angle"], "period_s": row["period"],
            "left_force": force.measured * share, "left_force_theory": force.exact * share,
            "loop_work": work.measured, "loop_work_theory": work.exact, "slides": int(run.values("sliding_contacts").max())}


def draw(runs, rows, path):
    """Draw force left and work taken against the depth of the path, on logarithmic axes, measured and from theory."""
    table = pandas.DataFrame(rows).sort_values("path_depth")
    fig, axes = plt.subplots(1, 2, figsize=(8.6, 4.4))
    for axis, quantity, label in zip(axes, ("left_force", "loop_work"), (
            r"force left $|T|\,/\,(k_t\,2R\,A)$", r"work taken by the path $|W|\,/\,\frac{1}{2}k_t(2R\,A)^2$")):
        for law in LAWS:
            if len(own := table[table.law == law]):
                _draw_law(axis, law, quantity, own)
        axis.set(xlabel=r"depth of the path $h/R$", ylabel=label)
    axes[0].legend(loc="center left", bbox_to_anchor=(0, 0.37))
    angles = ", ".join(f"{angle:g}" for angle in sorted(table.path_angle.unique()))
    style.finish(fig, path, f"Symbols grow with the path's angle A = {angles} rad; half filled: finer steps. Lines: theory, dashed without the "
                 "step's error.", runs)


def _draw_law(axis, law, quantity, table):
    """Draw a law's rows against their depth, one set an angle and step; of the finer step half filled."""
    name, colour, marker = LAWS[law]
    coarse = table.period_s.min()
    for (angle, period), shown in table.groupby(["path_angle", "period_s"]):
        measured, theory = (shown[column].abs().clip(lower=FLOOR) for column in (quantity, f"{quantity}_theory"))
        axis.loglog(shown.path_depth, measured, marker, color=colour, markersize=3 + 8 * angle**0.5,
                    fillstyle="none" if period == coarse else "bottom")
        if theory.max() > FLOOR:
            axis.loglog(shown.path_depth, theory, color=colour, linewidth=0.7)
    axis.loglog([], [], marker, color=colour, fillstyle="none", label=name)
    if (law, quantity) in SMALL_STEPS:
        depth = np.geomspace(table.path_depth.min(), table.path_depth.max())
        axis.loglog(depth, SMALL_STEPS[law, quantity](depth / 2), "--", color=colour, linewidth=0.7)


def quantities(table):
    return {"implicit": IMPLICIT}
