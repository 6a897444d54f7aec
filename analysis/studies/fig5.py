"""Fig. 5: gamma under a load that rises until the sample collapses, and the load at which it yields."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis import limits, observables, style, summary
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "Fig. 5: the ramp, up to collapse"
QUESTION = ("Under sigma2 = P0 (1 + alpha t), does MD drift and break down while CD rests up to a critical load and then gives way smoothly? "
            "At which load, how much does it differ between packings, and do the sliding contacts reach the bound 2M - 3N when it breaks?")
ORDER = 3  # in the report
# Up to 2.5 P0 or collapse; with the mean stress held, where sigma1 falls as sigma2 rises, to 1.9 P0. Both methods have the same walls, pushed by
# forces and light, so that their inertia does not pass for a collapse.
RAMP = dict(loading="ramp", period=1.0, records_per_cycle=50, wall_mass_ratio=1.0)
METHODS = (dict(method="MD", md_dt_factor=0.3, md_walls="force"), dict(method="CD", cd_dt=2e-3, tolerance=1e-7))
ROWS = {"quick": [row for method in METHODS for row in product(ramp_rate=0.5, cycles=3, **RAMP, **method)],
        "full": [row for method in METHODS for row in product(ramp_rate=0.1, cycles=15, preparation_friction=(0.0, 0.1), seed=range(1, 6), **RAMP, **method)
                 + product(ramp_rate=0.1, cycles=9, stress_path="mean", preparation_friction=(0.0, 0.1), seed=range(1, 6), **RAMP, **method)
                 + product(ramp_rate=0.2, cycles=8, seed=range(1, 6), **RAMP, **method)]}
# |gamma| that defines a critical load. Elastic strain of MD reaches 1e-3 below yield, so only the largest compares the methods.
THRESHOLDS = (1e-4, 1e-3, 1e-2)


def summarize(runs):
    """Return one row a run: critical loads, the largest jump, volume, sliding contacts against their bound."""
    return [_row(run) for run in sorted(runs, key=_order)]


def _order(run):
    row = run.parameters
    return row["stress_path"], row["preparation_friction"], row["ramp_rate"], run.method != "MD", row["seed"]


def _row(run):
    gamma, load = run.values("gamma"), run.values("sigma2_goal") / run.pressure
    volume = (1 + run.values("strain1")) * (1 + run.values("strain2")) - 1
    used, first = _share_of_bound(run), run.snapshots[0]
    yielded = np.flatnonzero(np.abs(gamma) > THRESHOLDS[-1])
    until = yielded[0] if len(yielded) else len(gamma) - 1
    contacts, disks, bound = statics.degrees_of_freedom(first, first["force_normal"] > 0)
    return {
        "method": run.method, "stress path": run.parameters["stress_path"], "preparation friction": run.parameters["preparation_friction"], "ramp rate": run.parameters["ramp_rate"],
        "seed": run.parameters["seed"], "static limit": limits.static_limit(run),
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
    """Draw a row of panels for each preparation: gamma over the load, a panel a stress path with CD enlarged in the inset, and the critical loads."""
    groups = summary.groups(runs, lambda run: run.parameters["preparation_friction"])
    paths = sorted({run.parameters["stress_path"] for run in runs})
    fig, axes = plt.subplots(len(groups), len(paths) + 1, figsize=(1 + 3.6 * (len(paths) + 1), 0.6 + 3.3 * len(groups)), squeeze=False)
    for line, (friction, own) in zip(axes, groups.items()):
        for axis, stress_path in zip(line, paths):
            _strain(axis, [run for run in own if run.parameters["stress_path"] == stress_path])
            axis.set_title({"constant": r"$\sigma_1 = P_0$", "mean": r"$(\sigma_1+\sigma_2)/2 = P_0$"}[stress_path] + rf", prepared with $\mu$ = {friction:g}", fontsize=9)
        _loads(line[-1], [row for row in rows if row["preparation friction"] == friction])
    handles = [Line2D([], [], color=colour, marker=style.MARKER[method], label=method) for method, colour in style.COLOUR.items()]
    if len({run.parameters["ramp_rate"] for run in runs}) > 1:
        handles.append(Line2D([], [], color="#444444", linestyle=":", label="twice as fast"))
    if any(run.collapsed for run in runs):
        handles.append(Line2D([], [], color="#444444", marker="x", linestyle="none", label="collapsed"))
    axes[0, -1].legend(handles=handles, loc="lower right", fontsize=7)
    style.finish(fig, path, "A line a packing; inset: CD alone, enlarged. Right: grey lines join MD and CD on one packing; open: the mean stress held.", runs)


def _line(run, slowest):
    return dict(color=style.COLOUR[run.method], linewidth=1, alpha=0.8, linestyle="-" if run.parameters["ramp_rate"] == slowest else ":")


def _strain(axis, runs):
    slowest = min((run.parameters["ramp_rate"] for run in runs), default=0)
    inset = axis.inset_axes([0.14, 0.1, 0.34, 0.42])
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
    inset.tick_params(labelsize=6)
    inset.set_title("CD", fontsize=7, pad=2)
    axis.set(xlabel=r"$\sigma_2/P_0 = 1 + \alpha t$", ylabel=r"$\gamma$   (< 0: shortens along axis 2)")
    axis.grid(color="#DDDDDD", linewidth=0.5)


def _loads(axis, rows):
    """Draw the critical loads over the static limit by threshold: a point a packing, MD and CD of one packing joined by a line."""
    slowest = min((row["ramp rate"] for row in rows), default=0)
    for place, threshold in enumerate(THRESHOLDS):
        name = f"load at |gamma| = {threshold:g}"
        for (stress_path, _), pair in summary.groups((row for row in rows if row["ramp rate"] == slowest), lambda row: (row["stress path"], row["seed"])).items():
            shift = place + (0.2 if stress_path == "mean" else -0.2)
            points = [(shift + (0.08 if row["method"] == "CD" else -0.08), row[name] / row["static limit"], row["method"]) for row in pair]
            axis.plot(*zip(*[point[:2] for point in points]), color="#AAAAAA", linewidth=0.6, zorder=1)
            for x, y, method in points:
                axis.plot(x, y, style.MARKER[method], color=style.COLOUR[method], markersize=4, mfc="none" if stress_path == "mean" else None)
    axis.axhline(1, color="k", lw=0.7, ls=":")
    axis.set_xticks(range(len(THRESHOLDS)), [f"{threshold:g}" for threshold in THRESHOLDS])
    axis.set(xlabel=r"$|\gamma|$ that defines the critical load", ylabel="critical load over static limit", xlim=(-0.5, len(THRESHOLDS) - 0.5))
    axis.grid(color="#DDDDDD", linewidth=0.5, axis="y")


ANSWER = """
MD strains from the start of the ramp. CD rests up to the static limit of its packing, which a linear programme knows beforehand: it passes |gamma| = 1e-4 at 1.00
times that limit (median; 0.99 to 1.02; 25 ramps from 10 packings, both stress paths). MD passes that strain at 0.85 times the limit (0.67 to 0.94). Where the
packings break the methods nearly agree: at |gamma| = 1e-2 CD carries 1.02 times the load of MD (0.97 to 1.07, more in 21 of 25 pairs), and before it
collapses 1.01 times (0.96 to 1.07, more in 19 of 25).

The stress path sets the loads. Packings prepared without friction reach |gamma| = 1e-4 in CD at 1.48 P0 with sigma1 held (median; 1.41 to 1.61) and at 1.20 P0 with the mean
stress held (1.17 to 1.23). All 50 runs collapse. A ramp twice as fast changes the load at |gamma| = 1e-2 by less than 3 %. MD's energies balance to 0.3 % of the
work.
"""
GIVEN = ("1e-4", "1e-2")
POINTS = (
    (7, "In the MD simulation, the system starts expanding slowly.", "section 3, Fig. 5", "agrees in part",
     "MD strains from the start: it passes |gamma| = 1e-4 at 1.07 P0 and 1e-2 at 1.49 P0 (medians, sigma1 held, prepared without friction). But with sigma1 held "
     "the area first shrinks, in 15 of 15 runs."),
    (8, "A sudden compression is perceived [...], after which the deformation rate seems to grow [...]. In the CD simulation, the response is smoother "
     "than in the MD case.", "section 3, Fig. 5", "disagrees", "Before it yields, gamma jumps further in MD than in CD in 1 of 25 pairs only."),
    (9, "This leads to a collapse of the sample at the end of the simulation. In this range of values, however, the CD simulated sample seems to remain "
     "unaltered.", "section 3, Fig. 5", "disagrees", "When MD collapses, CD has passed |gamma| = 1e-2 in 25 of 25 pairs, on either stress path."),
    (10, "At a first stage, the system seems not to be affected by the imposed loading. There is however a critical load, beyond which, the system "
     "expands.", "section 3, Fig. 5", "agrees", "CD stays below |gamma| = 1e-4 up to 0.99 to 1.02 times the static limit. In the end the area has grown in 25 of 25 runs."),
    (11, "this expansion is carried out without any collapse or breakage of the physical structure of the grains.", "section 3, Fig. 5",
     "agrees in part", "After |gamma| = 1e-4 CD carries another 22 % of load (median); in the end 25 of 25 runs collapse. The paper does not say how far "
     "its ramp went."),
    (12, "The response of the material is more apparent in the MD simulation, while CD is much more resistant to collapse.", "section 4", "disagrees",
     "Under a ramp CD's largest load is 1.01 times MD's (median); it exceeds it by more than a tenth in none of 25 pairs. What differs is the strain on the way."),
)


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    small, large, most, jump = "load at |gamma| = 0.0001", "load at |gamma| = 0.01", "largest load", "largest jump of gamma before yield"
    keys = ["stress path", "preparation friction", "ramp rate", "seed"]
    md, cd = (table[table.method == method].set_index(keys).sort_index() for method in ("MD", "CD"))
    fast, slow = (table[table["ramp rate"] == rate] for rate in (table["ramp rate"].max(), table["ramp rate"].min()))
    both = fast.merge(slow, on=["method", "seed", "preparation friction", "stress path"])
    limit, springs, yielded, end = cd[small] / cd["static limit"], md[small] / md["static limit"], cd[large] / md[large], cd[most] / md[most]
    dense, held = cd[small].loc["constant", 0.0, 0.1], cd[small].loc["mean", 0.0, 0.1]
    assert (end < 1.1).all()
    return {"1.00": limit.median(), "0.99": limit.min(), "1.02": [limit.max(), yielded.median()], "10": len(md.groupby(level=["preparation friction", "seed"])),
            "25": [len(cd), (cd[large] < md[most]).sum(), (cd["volume strain at the end"] > 0).sum(), cd.outcome.str.startswith("collapsed").sum()],
            "0.85": springs.median(), "0.67": springs.min(), "0.94": springs.max(), "0.97": yielded.min(), "1.07": [yielded.max(), end.max(), md[small].loc["constant", 0.0, 0.1].median()],
            "21": (yielded > 1).sum(), "1.01": end.median(), "0.96": end.min(), "19": (end > 1).sum(), "1.48": dense.median(), "1.41": dense.min(), "1.61": dense.max(),
            "1.20": held.median(), "1.17": held.min(), "1.23": held.max(), "50": table.outcome.str.startswith("collapsed").sum(),
            "3": 100 * max(0.03, (both[f"{large}_x"] / both[f"{large}_y"] - 1).abs().max()), "0.3": 100 * md["balance error"].abs().max(), "1.49": md[large].loc["constant", 0.0, 0.1].median(),
            "15": (md["least volume strain"].loc["constant"] < -1e-5).sum(), "1": (md[jump] > cd[jump]).sum(), "22": 100 * (cd[most] / cd[small] - 1).median()}
