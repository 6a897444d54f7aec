"""How much of the CD loop of Fig. 4 is the solver's accuracy."""

import numpy as np

from analysis import loops, observables, style
from yade_scripts import effective_medium

TITLE = "Fig. 4's CD loop: physics or tolerance?"
QUESTION = ("The paper's Fig. 4 shows a narrow CD loop, 'related to the precision of the method'. How do its width and its remanent strain depend "
            "on the tolerance, on a fixed number of sweeps and on the step, and does fully solved CD move at all below yield?")
TABLES = {"quick": ("quick/tolerance.txt",), "full": ("tolerance.txt",)}

MD, BY_TOLERANCE, BY_SWEEPS, BY_STEP = "MD", "tolerance", "sweeps", "step"
MARKER = {"largest": "o", "width": "s", "remanent": "^"}
SHADE = {"largest": "#1A1A1A", "width": style.COLOUR["CD"], "remanent": style.COLOUR["MD"]}


def summarize(runs):
    """One row a setting, over the packings; `effort` names what is varied."""
    step = _usual_step(runs)
    groups = loops.grouped(runs, lambda run: _key(run, step))
    return [_row(*key, group) for key, group in groups.items()]


def _usual_step(runs):
    """The step that most CD rows have; rows with another one are about the step."""
    steps = [run.parameters["cd_dt"] for run in runs if run.method == "CD"]
    return max(set(steps), key=steps.count) if steps else None


def _key(run, usual):
    row = run.parameters
    if run.method == "MD":
        return MD, 0.0
    if row["cd_dt"] != usual:
        return BY_STEP, row["cd_dt"]
    return (BY_SWEEPS, row["fixed_iterations"]) if row["fixed_iterations"] else (BY_TOLERANCE, row["tolerance"])


def _row(effort, value, group):
    row = {"effort": effort, "value": value, "packings": len(group)} | loops.spread(group)
    if effort == MD:
        return row
    # The samples of the history stand for all steps.
    sweeps = float(np.mean([run.values("iterations")[1:].mean() for run in group]))
    full = group[0].parameters
    if effort == BY_SWEEPS:
        row["kappa_over_kn"] = effective_medium.stiffness(full) / full["kn"]
    return row | {
        "sweeps_a_step": sweeps,
        "error_median": float(np.median([np.median(run.values("residual")[1:]) for run in group])),
        "unsolved_steps": sum(observables.unconverged_steps(run) for run in group),
        "steps": sum(round(run.values("time")[-1] / effective_medium.step(full)) for run in group)}


def _of(rows, effort):
    return sorted((row for row in rows if row["effort"] == effort), key=lambda row: row["value"])


def draw(runs, rows, path):
    """The three numbers of the loop against the tolerance, and against the sweeps, with MD's."""
    fig, panels = style.plt.subplots(1, 2, figsize=(9.5, 4.4), sharey=True)
    texts = {BY_TOLERANCE: ("tolerance on the error $e$", "solved to a tolerance"),
             BY_SWEEPS: ("sweeps a step, no test", "a fixed number of sweeps")}
    for axes, (effort, (label, title)) in zip(panels, texts.items()):
        part = _of(rows, effort)
        for name, words in loops.QUANTITIES.items():
            loops.draw_spread(axes, [row["value"] for row in part], part, name, fmt=MARKER[name] + "-", color=SHADE[name], label=f"CD, {words}")
            for row in _of(rows, MD):
                axes.axhline(row[name], color=SHADE[name], ls="--", lw=0.8)
        axes.set(xscale="log", yscale="log", xlabel=label, title=title)
    panels[0].set_ylabel(r"strain $\gamma$")
    panels[0].legend(title="dashed: MD")
    part, md = _of(rows, BY_SWEEPS), _of(rows, MD)
    if part and md:
        panels[1].plot([row["value"] for row in part], [md[0]["largest"] / row["kappa_over_kn"] for row in part], ":", color="k",
                       label=r"MD's largest $|\gamma|$ times $k_n/\kappa$, $\kappa = q m N_I/\Delta t^2$")
        panels[1].legend()
    style.finish(fig, runs, path, "Mean over the packings, bars from the smallest to the largest; points without bars are of one packing", foot=0.13)


def answer(rows):
    """What was found, by the numbers of the rows."""
    solved, md = _of(rows, BY_TOLERANCE), _of(rows, MD)
    if len(solved) < 2:
        return "Fewer than two tolerances have finished."
    best, worst = solved[0], solved[-1]
    text = (f"Tolerance. From {worst['value']:.0e} to {best['value']:.0e} the largest |gamma| of CD falls from {worst['largest']:.1e} to "
            f"{best['largest']:.1e}, the width of the loop from {worst['width']:.1e} to {best['width']:.1e}, the remanent strain from "
            f"{worst['remanent']:.1e} to {best['remanent']:.1e}")
    level = [words for name, words in (("largest", "largest |gamma|"), ("width", "width"), ("remanent", "remanent strain")) if not _falling(solved, name)]
    text += f" (the {' and the '.join(level)} not at every tolerance on the way)." if level else ", and none of them levels off."
    if md:
        near = min(solved, key=lambda row: abs(np.log(row["largest"] / md[0]["largest"])))
        text += (f" A tolerance of {near['value']:.0e} gives {near['largest'] / md[0]['largest']:.2f} times MD's largest |gamma| "
                 f"({md[0]['largest']:.2e}) and {near['remanent'] / md[0]['remanent']:.2f} times its remanent strain.")
    text += (f" So fully solved CD does not move below yield: the best runs bound its strain by {best['largest']:.0e}, at "
             f"{best['sweeps_a_step']:.0f} sweeps a step with {best['unsolved_steps']} of {best['steps']} steps short of the tolerance.")
    swept = _of(rows, BY_SWEEPS)
    if len(swept) > 1:
        text += (f" With {swept[0]['value']:.0f} to {swept[-1]['value']:.0f} sweeps a step the largest |gamma| goes from {swept[0]['largest']:.1e} to "
                 f"{swept[-1]['largest']:.1e}")
        if md:
            ratio = [row["largest"] * row["kappa_over_kn"] / md[0]["largest"] for row in swept]
            text += f", {min(ratio):.2g} to {max(ratio):.2g} times what springs of kappa = q m N_I/dt^2 would give"
        text += "."
    other = _of(rows, BY_STEP)
    if other:
        text += (" At the tolerance of the study and steps of " + ", ".join(f"{1e3 * row['value']:g}" for row in other)
                 + " ms it is " + ", ".join(f"{row['largest']:.1e}" for row in other) + ".")
    return text + " One load, dSigma = 0.2; packings and loads that yield are another matter (fig5)."


def _falling(rows, name):
    """Whether the quantity goes down with every smaller value."""
    values = [row[name] for row in rows]
    return all(small < large for small, large in zip(values, values[1:]))
