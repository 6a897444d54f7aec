"""Fig. 5: gamma under a load that rises until the sample collapses, and the load at which it yields."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis import observables, style
from analysis import summary
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "Fig. 5: the ramp, up to collapse"
QUESTION = ("Under sigma2 = P0 (1 + alpha t), does MD drift and break down while CD rests up to a critical load and then gives way smoothly? "
            "At which load, how much does it differ between packings, and do the sliding contacts reach the bound 2M - 3N when it breaks?")
ORDER = 3  # in the report
# Up to 2.5 P0 or collapse. CD's walls are light, so that their inertia does not pass for a collapse.
RAMP = dict(loading="ramp", period=1.0, records_per_cycle=50)
METHODS = (dict(method="MD", md_dt_factor=0.3), dict(method="CD", cd_dt=2e-3, tolerance=1e-7, wall_mass_ratio=1.0))
ROWS = {"quick": [row for method in METHODS for row in product(ramp_rate=0.5, cycles=3, **RAMP, **method)],
        "full": [row for method in METHODS for row in product(ramp_rate=0.1, cycles=15, preparation_friction=(0.0, 0.1), seed=range(1, 6), **RAMP, **method)
                 + product(ramp_rate=0.2, cycles=8, **RAMP, **method)]}
# |gamma| that defines a critical load. Elastic strain of MD reaches 1e-3 below yield, so only the largest compares the methods.
THRESHOLDS = (1e-4, 1e-3, 1e-2)


def summarize(runs):
    """Return one row a run: critical loads, the largest jump, volume, sliding contacts against their bound."""
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
    """Return the sliding contacts over the most that can slide at rest, at each sample; rattlers and walls' contacts as at the start.

    A snapshot counts unknowns and equations; between snapshots each contact more adds two unknowns. 1 where the bound is not positive.
    """
    first = run.snapshots[0]
    loaded = first["force_normal"] > 0
    bound = statics.degrees_of_freedom(first, loaded)[2] + 2 * (run.values("contacts") - loaded.sum())
    return np.where(bound > 0, run.values("sliding_contacts") / np.maximum(bound, 1), 1.0)


def _at(run, values, threshold):
    """Return the value where |gamma| passes the threshold; NaN if it never does."""
    above = np.flatnonzero(np.abs(run.values("gamma")) > threshold)
    return float(values[above[0]]) if len(above) else float("nan")


def draw(runs, rows, path):
    """Draw a column for each preparation: gamma over the load with CD enlarged in the inset, and the critical loads."""
    groups = summary.groups(runs, lambda run: run.parameters["preparation_friction"])
    fig, axes = plt.subplots(2, len(groups), figsize=(1 + 3.7 * len(groups), 6.8), squeeze=False)
    for column, (friction, own) in enumerate(groups.items()):
        _strain(axes[0, column], own)
        _loads(axes[1, column], [row for row in rows if row["preparation friction"] == friction])
        axes[0, column].set_title(f"prepared with $\\mu$ = {friction:g}")
    handles = [Line2D([], [], color=colour, marker=style.MARKER[method], label=method) for method, colour in style.COLOUR.items()]
    if len({run.parameters["ramp_rate"] for run in runs}) > 1:
        handles.append(Line2D([], [], color="#444444", linestyle=":", label="twice as fast"))
    if any(run.collapsed for run in runs):
        handles.append(Line2D([], [], color="#444444", marker="x", linestyle="none", label="collapsed"))
    axes[1, -1].legend(handles=handles, loc="lower right")
    style.finish(fig, path, "A line a packing; inset: CD alone, enlarged. Below: grey lines join MD and CD on one packing.", runs)


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


def _loads(axis, rows):
    """Draw the critical loads by threshold: a point a packing, MD and CD of one packing joined by a line."""
    for place, threshold in enumerate(THRESHOLDS):
        name = f"load at |gamma| = {threshold:g}"
        for seed, pair in summary.groups(rows, lambda row: (row["ramp rate"], row["seed"])).items():
            points = [(place + (0.15 if row["method"] == "CD" else -0.15), row[name], row["method"]) for row in pair]
            axis.plot(*zip(*[point[:2] for point in points]), color="#AAAAAA", linewidth=0.6, zorder=1)
            for x, y, method in points:
                axis.plot(x, y, style.MARKER[method], color=style.COLOUR[method], markersize=5)
    axis.set_xticks(range(len(THRESHOLDS)), [f"{threshold:g}" for threshold in THRESHOLDS])
    axis.set(xlabel=r"$|\gamma|$ that defines the critical load", ylabel=r"critical $\sigma_2/P_0$", xlim=(-0.5, len(THRESHOLDS) - 0.5))
    axis.grid(color="#DDDDDD", linewidth=0.5, axis="y")


ANSWER = """
MD strains from the start of the ramp, CD rests up to a critical load; at the end of the ramp the methods nearly agree. Prepared without
friction, CD passes |gamma| = 1e-4 at 1.48 P0 (median; 1.40 to 1.61), MD at 1.07 P0; at |gamma| = 1e-2 it is 1.57 P0 for CD and 1.49 P0 for MD. On
the same packing CD carries 1.04 times the load of MD at |gamma| = 1e-2 (0.97 to 1.07, both preparations), and 0.98 times before it collapses
(0.90 to 1.04; MD's walls are a servo here, CD's are pushed). All 22 runs collapse. A ramp twice as fast changes the load at |gamma| = 1e-2 by less than 4 %.
"""
GIVEN = ("1e-4", "1e-2")
POINTS = (
    (7, "In the MD simulation, the system starts expanding slowly.", "section 3, Fig. 5", "agrees in part",
     "MD strains from the start: it passes |gamma| = 1e-4 at 1.07 P0 and 1e-2 at 1.47 P0 (medians). But the area first shrinks, in 11 of 11 runs."),
    (8, "A sudden compression is perceived [...], after which the deformation rate seems to grow [...]. In the CD simulation, the response is smoother "
     "than in the MD case.", "section 3, Fig. 5", "disagrees", "Before it yields, gamma jumps further in MD than in CD on 1 of 11 pairs of runs only."),
    (9, "This leads to a collapse of the sample at the end of the simulation. In this range of values, however, the CD simulated sample seems to remain "
     "unaltered.", "section 3, Fig. 5", "disagrees", "When MD collapses, at 1.86 P0 (median), CD has passed |gamma| = 1e-2 on 11 of 11 pairs of runs."),
    (10, "At a first stage, the system seems not to be affected by the imposed loading. There is however a critical load, beyond which, the system "
     "expands.", "section 3, Fig. 5", "agrees", "CD stays below |gamma| = 1e-4 up to 1.40 P0 (median). In the end the area has grown in 11 of 11 runs."),
    (11, "this expansion is carried out without any collapse or breakage of the physical structure of the grains.", "section 3, Fig. 5",
     "agrees in part", "After |gamma| = 1e-4 CD carries another 24 % of load (median); in the end 11 of 11 runs collapse. The paper does not say how far "
     "its ramp went."),
    (12, "The response of the material is more apparent in the MD simulation, while CD is much more resistant to collapse.", "section 4", "disagrees",
     "CD's largest load is 0.97 times MD's (median); it exceeds it by more than a tenth on none of 11 pairs. What differs is the strain on the way."),
)


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    small, large, most = "load at |gamma| = 0.0001", "load at |gamma| = 0.01", "largest load"
    slow = table[table["ramp rate"] == table["ramp rate"].min()]
    keys = ["preparation friction", "ramp rate", "seed"]
    md, cd = (table[table.method == method].set_index(keys).sort_index() for method in ("MD", "CD"))
    slow_md, slow_cd = (slow[slow.method == method].set_index(keys).sort_index() for method in ("MD", "CD"))
    dense = lambda rows: rows.loc[0.0]
    ratio, end = slow_cd[large] / slow_md[large], slow_cd[most] / slow_md[most]
    fast = table[table["ramp rate"] > table["ramp rate"].min()].merge(slow, on=["method", "seed", "preparation friction"])
    jump, further = "largest jump of gamma before yield", cd[most] / cd[small] - 1
    return {"1.48": dense(slow_cd)[small].median(), "1.40": [dense(slow_cd)[small].min(), cd[small].median()], "1.61": dense(slow_cd)[small].max(),
            "1.07": [dense(slow_md)[small].median(), ratio.max(), md[small].median()], "1.57": dense(slow_cd)[large].median(), "1.49": dense(slow_md)[large].median(),
            "1.04": [ratio.median(), end.max()], "0.97": [ratio.min(), (cd[most] / md[most]).median()], "0.98": end.median(), "0.90": end.min(),
            "22": table.outcome.str.startswith("collapsed").sum(), "4": 4 if (fast[f"{large}_x"] / fast[f"{large}_y"] - 1).abs().max() < 0.04 else 0,
            "1.47": md[large].median(), "11": [len(md), (md["least volume strain"] < -1e-5).sum(), len(cd), (cd["volume strain at the end"] > 0).sum(),
                                               (cd[large] < md[most]).sum()],
            "1": (md[jump] > cd[jump]).sum(), "1.86": md[most].median(), "24": 100 * further.median()}
