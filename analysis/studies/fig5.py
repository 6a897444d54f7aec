"""Fig. 5: gamma under a load that rises without end, the load at which the sample yields, and what slides on the way."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis import observables, schema, statics, style
from analysis.studies import summary

TITLE = "Fig. 5: the ramp, up to collapse"
QUESTION = ("Under sigma2 = P0 (1 + alpha t), does MD drift and break down while CD rests up to a critical load and then gives way smoothly? "
            "At which load, how much does it differ between packings, and do the sliding contacts reach the bound 2M - 3N when it breaks?")
TABLES = {"quick": ("quick/fig5.txt",), "full": ("fig5.txt",)}
# |gamma| that defines a critical load. Elastic strain of MD reaches 1e-3 below yield, so only the largest compares the methods.
THRESHOLDS = (1e-4, 1e-3, 1e-2)


def summarize(runs):
    """One row a run: critical loads, the largest jump, volume, sliding contacts against their bound."""
    return [_row(run) for run in sorted(runs, key=_order)]


def _order(run):
    row = run.parameters
    return row["preparation_friction"], row["ramp_rate"], run.method != "MD", row["seed"]


def _row(run):
    gamma, load = run.values("gamma"), run.values("sigma2_goal") / run.pressure
    volume = (1 + run.values("strain1")) * (1 + run.values("strain2")) - 1
    used, first = _share_of_bound(run), run.snapshots[0]
    yielded = np.flatnonzero(np.abs(gamma) > THRESHOLDS[-1])
    until = yielded[0] if len(yielded) else len(gamma) - 1
    contacts, disks, bound = statics.degrees_of_freedom(first, first["force_normal"] > 0)
    return {
        "method": run.method, "preparation friction": run.parameters["preparation_friction"], "ramp rate": run.parameters["ramp_rate"],
        "seed": run.parameters["seed"],
        **{f"load at |gamma| = {threshold:g}": observables.critical_load(run, threshold) for threshold in THRESHOLDS},
        "largest load": float(load.max()), "gamma at the end": float(gamma[-1]),
        "largest jump of gamma before yield": float(np.abs(np.diff(gamma[:until + 1])).max()) if until else 0.0,
        "least volume strain": float(volume.min()), "volume strain at the end": float(volume[-1]),
        "load where sliding reaches the bound": float(load[np.argmax(used >= 1)]) if (used >= 1).any() else float("nan"),
        "M at the start": contacts, "N at the start": disks, "bound at the start": bound,
        "sliding/bound at |gamma| = 0.001": _at(run, used, THRESHOLDS[1]), "sliding/bound at |gamma| = 0.01": _at(run, used, THRESHOLDS[-1]),
        "largest sliding/bound": float(used.max()), "balance error": float(observables.balance_error(run)),
        "unsolved steps": observables.unconverged_steps(run) if run.method == "CD" else "", "outcome": run.outcome,
    }


def _share_of_bound(run):
    """Sliding contacts over the most that can slide at rest, at each sample; rattlers and walls' contacts as at the start.

    A snapshot counts unknowns and equations; between snapshots each contact more adds two unknowns. 1 where the bound is not positive.
    """
    first = run.snapshots[0]
    loaded = first["force_normal"] > 0
    bound = statics.degrees_of_freedom(first, loaded)[2] + 2 * (run.values("contacts") - loaded.sum())
    return np.where(bound > 0, run.values("sliding_contacts") / np.maximum(bound, 1), 1.0)


def _at(run, values, threshold):
    """The value where |gamma| passes the threshold; NaN if it never does."""
    above = np.flatnonzero(np.abs(run.values("gamma")) > threshold)
    return float(values[above[0]]) if len(above) else float("nan")


def draw(runs, rows, path):
    """A column for each preparation: gamma over the load with CD enlarged in the inset, sliding contacts over their bound, critical loads."""
    groups = summary.groups(runs, lambda run: run.parameters["preparation_friction"])
    fig, axes = plt.subplots(3, len(groups), figsize=(1 + 5.2 * len(groups), 11), squeeze=False)
    for column, (friction, own) in enumerate(groups.items()):
        top, middle, bottom = axes[:, column]
        _strain(top, own)
        _sliding(middle, own)
        _loads(bottom, [row for row in rows if row["preparation friction"] == friction])
        top.set_title(f"prepared with $\\mu$ = {friction:g}")
    handles = [Line2D([], [], color=colour, label=method) for method, colour in style.COLOUR.items()]
    handles += [Line2D([], [], color="#444444", linestyle=":", label="faster ramp"),
                Line2D([], [], color="#444444", marker="x", linestyle="none", label="collapsed")]
    fig.legend(handles=handles, loc="upper center", ncol=4)
    fig.subplots_adjust(left=0.09 if len(groups) > 1 else 0.14, right=0.98, top=0.93, bottom=0.12 if len(groups) > 1 else 0.14, hspace=0.28, wspace=0.22)
    style.finish(fig, runs, path, "A line a packing; inset: CD alone, on its own scale")


def _line(run, slowest):
    return dict(color=style.COLOUR[run.method], linewidth=1, alpha=0.8, linestyle="-" if run.parameters["ramp_rate"] == slowest else ":")


def _strain(axis, runs):
    slowest = min(run.parameters["ramp_rate"] for run in runs)
    inset = axis.inset_axes([0.14, 0.12, 0.4, 0.45])
    for run in runs:
        load, gamma = run.values("sigma2_goal") / run.pressure, run.values("gamma")
        axis.plot(load, gamma, **_line(run, slowest))
        if run.collapsed:
            axis.plot(load[-1], gamma[-1], "x", color=style.COLOUR[run.method])
        if run.method == "CD":
            inset.plot(load, gamma, **_line(run, slowest))
    yields = [load for load in (observables.critical_load(run, THRESHOLDS[0]) for run in runs if run.method == "CD") if np.isfinite(load)]
    if yields:
        inset.set(xlim=(1, max(yields) + 0.02), ylim=(-3 * THRESHOLDS[0], THRESHOLDS[0]))
    inset.tick_params(labelsize=7)
    inset.set_title("CD", fontsize=8, pad=2)
    axis.set(xlabel=r"$\sigma_2/P_0 = 1 + \alpha t$", ylabel=r"$\gamma$   (< 0: shortens along axis 2)")
    axis.grid(color="#DDDDDD", linewidth=0.5)


def _sliding(axis, runs):
    slowest = min(run.parameters["ramp_rate"] for run in runs)
    for run in runs:
        axis.plot(run.values("sigma2_goal") / run.pressure, _share_of_bound(run), **_line(run, slowest))
    axis.axhline(1, color="#444444", linewidth=0.8, linestyle="--")
    axis.set(xlabel=r"$\sigma_2/P_0$", ylabel="sliding contacts over the bound $2M-3N$")
    axis.grid(color="#DDDDDD", linewidth=0.5)


def _loads(axis, rows):
    """Critical loads by threshold: a point a packing, MD and CD of one packing joined by a line."""
    for place, threshold in enumerate(THRESHOLDS):
        name = f"load at |gamma| = {threshold:g}"
        for seed, pair in summary.groups(rows, lambda row: (row["ramp rate"], row["seed"])).items():
            points = [(place + (0.15 if row["method"] == "CD" else -0.15), row[name], row["method"]) for row in pair]
            axis.plot(*zip(*[point[:2] for point in points]), color="#AAAAAA", linewidth=0.6, zorder=1)
            for x, y, method in points:
                axis.plot(x, y, "o" if method == "MD" else "s", color=style.COLOUR[method], markersize=5)
    axis.set_xticks(range(len(THRESHOLDS)), [f"{threshold:g}" for threshold in THRESHOLDS])
    axis.set(xlabel=r"$|\gamma|$ that defines the critical load", ylabel=r"critical $\sigma_2/P_0$", xlim=(-0.5, len(THRESHOLDS) - 0.5))
    axis.grid(color="#DDDDDD", linewidth=0.5, axis="y")


def answer(rows):
    """Critical loads by method and preparation, what slides there, and how the samples end."""
    slowest = min(row["ramp rate"] for row in rows)
    parts = []
    for friction, own in summary.groups(rows, lambda row: row["preparation friction"]).items():
        slow = [row for row in own if row["ramp rate"] == slowest]
        parts += [f"Prepared with mu = {friction:g}, {_words(method, [row for row in slow if row['method'] == method])}." for method in ("MD", "CD")]
        parts.append(_ratio(slow))
    return "\n".join([*parts, _rate(rows, slowest)])


def _words(method, rows):
    if not rows:
        return f"no {method} run"
    collapsed = sum(row["outcome"] != schema.OUTCOME_COMPLETED for row in rows)
    loads = ", ".join(f"{summary.spread((row[f'load at |gamma| = {threshold:g}'] for row in rows), 3)} at {threshold:g}" for threshold in THRESHOLDS)
    return (f"{method} passes |gamma| = threshold at sigma2/P0 = {loads}; {collapsed} of {len(rows)} collapsed, at most at "
            f"{summary.spread((row['largest load'] for row in rows), 3)} P0; before yield gamma jumps by at most "
            f"{summary.spread(row['largest jump of gamma before yield'] for row in rows)} between samples; the volume shrinks by at most "
            f"{summary.spread(-row['least volume strain'] for row in rows)} of its start and has changed by "
            f"{summary.spread(row['volume strain at the end'] for row in rows)} at the end; the sliding contacts reach their bound at "
            f"{summary.spread((row['load where sliding reaches the bound'] for row in rows), 3)} P0 and are "
            f"{summary.spread(row['sliding/bound at |gamma| = 0.01'] for row in rows)} times it where |gamma| = 0.01, at most {summary.spread(row['largest sliding/bound'] for row in rows)}")


def _ratio(rows):
    by = {method: [row for row in rows if row["method"] == method] for method in ("MD", "CD")}
    ratio = summary.paired_ratio(by["CD"], by["MD"], ("seed",), f"load at |gamma| = {THRESHOLDS[-1]:g}")
    if not len(summary.finite(ratio)):
        return "No packing has been strained that far by both methods."
    return f"On the same packing CD carries {summary.spread(ratio, 3)} times MD's load at |gamma| = {THRESHOLDS[-1]:g}."


def _rate(rows, slowest):
    """How the critical load changes with the rate of the ramp."""
    name = f"load at |gamma| = {THRESHOLDS[-1]:g}"
    fast, slow = ([row for row in rows if (row["ramp rate"] == slowest) == is_slow] for is_slow in (False, True))
    ratio = summary.paired_ratio(fast, slow, ("method", "seed", "preparation friction"), name)
    if not len(summary.finite(ratio)):
        return "One rate of loading only."
    return f"A faster ramp changes that load by a factor of {summary.spread(ratio, 3)}."
