"""What the three tangential laws leave of a closed path of two disks; the theory stands in yade_scripts/scenes/two_grain_path.py."""

import numpy as np

from analysis import style
from analysis.style import plt

TITLE = "A closed path of two disks under the three tangential laws"
QUESTION = ("Is the tangential spring's force a matter of where the disks are, or of how they came there? McNamara, García-Rojo and "
            "Herrmann (2008) found that the usual law remembers a closed path, and took that for a source of ratcheting.")
TABLES = {"quick": ("quick/closed_path.txt",), "full": ("closed_path.txt",)}

LAWS = {"standard": ("standard (Cundall-Strack)", "#0072B2", "o"), "avoid_ratcheting": ("YADE's avoidGranularRatcheting", "#D55E00", "s"),
        "path_independent": ("path-independent", "#1A1A1A", "^")}
SHARE = "of the force at the far end"
# Without the step's error, of s = h/2R: for each law the force left and the work taken (its size).
SMALL_STEPS = {("standard", "left_force"): lambda s: s, ("standard", "loop_work"): lambda s: s**2, ("avoid_ratcheting", "loop_work"): lambda s: s}
FLOOR = 1e-18  # where a zero is drawn on the logarithmic axes


def summarize(runs):
    """One row a run. Force and work are in units of the largest force k_t 2R A and the largest energy k_t (2R A)^2/2 of the spring."""
    return [_row(run) for run in runs]


def _row(run):
    row, force, work = run.parameters, run.known["left_force"], run.known["loop_work"]
    share = row["path_depth"] / 2  # of the units in which the scene gives the force
    return {"law": row["tangential_law"], "path_depth": row["path_depth"], "path_angle": row["path_angle"], "period_s": row["period"],
            "left_force": force.measured * share, "left_force_theory": force.exact * share,
            "loop_work": work.measured, "loop_work_theory": work.exact,
            "slides": int(run.values("sliding_contacts").max())}


def draw(runs, rows, path):
    """Force left and work taken against the depth of the path, on logarithmic axes, measured and from theory."""
    fig, axes = plt.subplots(1, 2, figsize=(8.6, 4.4))
    for axis, quantity, label in zip(axes, ("left_force", "loop_work"), (
            r"force left $|T|\,/\,(k_t\,2R\,A)$", r"work taken by the path $|W|\,/\,\frac{1}{2}k_t(2R\,A)^2$")):
        for law in LAWS:
            _draw_law(axis, law, quantity, rows)
        axis.set_xlabel(r"depth of the path $h/R$")
        axis.set_ylabel(label)
    axes[0].legend(loc="center left", bbox_to_anchor=(0, 0.37))
    angles = ", ".join(f"{angle:g}" for angle in sorted({row["path_angle"] for row in rows}))
    style.finish(fig, runs, path, f"Lines: theory with the step's error, dashed without. Symbols grow with the path's angle A = {angles} rad. "
                                  "Of the path-independent law: round-off.", foot=0.14)


def _draw_law(axis, law, quantity, rows):
    name, colour, marker = LAWS[law]
    for angle, shown in _by_angle(rows, law):
        depth = [row["path_depth"] for row in shown]
        axis.loglog(depth, _size(shown, quantity), marker, color=colour, markersize=3 + 8 * angle**0.5, fillstyle="none")
        theory = _size(shown, quantity + "_theory")
        if max(theory) > FLOOR:
            axis.loglog(depth, theory, color=colour, linewidth=0.7)
    axis.loglog([], [], marker, color=colour, fillstyle="none", label=name)
    if (law, quantity) in SMALL_STEPS:
        depth = np.geomspace(*(pick(row["path_depth"] for row in rows) for pick in (min, max)))
        axis.loglog(depth, SMALL_STEPS[law, quantity](depth / 2), "--", color=colour, linewidth=0.7)


def _by_angle(rows, law):
    """(angle, rows in the order of their depth) of a law, one set a step."""
    sets = {(row["path_angle"], row["period_s"]) for row in rows if row["law"] == law}
    for angle, period in sorted(sets):
        yield angle, sorted((row for row in rows if (row["law"], row["path_angle"], row["period_s"]) == (law, angle, period)),
                            key=lambda row: row["path_depth"])


def _size(rows, quantity):
    return [max(abs(row[quantity]), FLOOR) for row in rows]


def answer(rows):
    """What each law leaves, how far from the theory, and what that does not tell."""
    said = []
    for law, (name, _, _) in LAWS.items():
        own = [row for row in rows if row["law"] == law]
        if own:
            said.append(_answer_of(law, name, own))
    slid = sum(row["slides"] > 0 for row in rows)
    said.append(f"{slid} of the {len(rows)} paths slipped, so they tell nothing." if slid else "No contact slipped.")
    said.append("The disks are led and do not spin; what this means for a packing, where contacts also slip, only the laws' own study tells.")
    return " ".join(said)


def _answer_of(law, name, rows):
    deep = max(rows, key=lambda row: (row["path_depth"], row["path_angle"], row["period_s"]))
    if law == "path_independent":
        return (f"The {name} law leaves at most {max(abs(row['left_force']) for row in rows):.1g} {SHARE} and takes at most "
                f"{max(abs(row['loop_work']) for row in rows):.1g} of the energy there: round-off.")
    shown = f"{deep['left_force']:.2g} {SHARE} and takes {deep['loop_work']:.2g} of the energy there"
    worst = max(_miss(row, "left_force") for row in rows)
    if law == "standard":
        return (f"The {name} law leaves h/2R of the force: at h/R = {deep['path_depth']:g} and A = {deep['path_angle']:g} rad "
                f"{shown}, which the spring then holds. Force and theory differ by at most {worst:.1g} {SHARE}.")
    return (f"{name} keeps the spring's stretch but not its energy: at the same path it leaves {shown}, so energy comes from nothing each "
            "time the path is gone along, and is lost the other way round, in the first power of the depth; the force that is left is the error of the step "
            f"(at most {max(abs(row['left_force']) for row in rows):.1g} {SHARE}, theory off by {worst:.1g}).")


def _miss(row, quantity):
    return float(np.abs(row[quantity] - row[quantity + "_theory"]))
