"""The contact forces of MD and CD side by side at the load maximum of Fig. 4, from one packing.

Line thickness is proportional to the normal force R, on one scale for both; contacts at the Coulomb limit (|T| = mu R) have another colour and a
dot; disks that carry nothing (rattlers) are shaded.
"""
import numpy as np
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Rectangle

from analysis import observables, style
from analysis.studies import fig4
from analysis.style import plt
from yade_scripts.errors import ResultError

TITLE = "Do both methods find the same contact forces?"
QUESTION = "One packing at the peak of Fig. 4's load."
ORDER = 20  # in the report
PART = "appendix"
ROWS = {"quick": fig4.ROWS["quick"], "full": fig4.ROWS["quick"]}

# Width in points of a line that carries the mean force: thin enough for five times it to fit between disks.
POINTS_PER_MEAN = 1.0


def summarize(runs):
    """Return one row of the pair: contacts, sliding contacts and rattlers of both, and how far their normal forces agree."""
    row, snapshots = {}, []
    for run in _pair(runs):
        snapshot, load = observables.snapshot_at_load_maximum(run)
        snapshots.append(snapshot)
        row |= {f"contacts {run.method}": _loaded(snapshot).sum(), f"at the Coulomb limit {run.method}": observables.sliding(snapshot).sum(),
                f"rattlers {run.method}": observables.rattlers(snapshot).sum(), f"load {run.method}": load}
    md, cd = forces = observables.matched_forces(*snapshots)
    return [row | {"correlation": np.corrcoef(md, cd)[0, 1], "rms difference": np.sqrt(np.mean((md - cd)**2)) / forces[forces > 0].mean(),
                   "in MD only": (cd == 0).sum(), "in CD only": (md == 0).sum()}]


def _pair(runs):
    """Return [MD run, CD run]; ResultError where one is missing."""
    if len(by := {run.method: run for run in runs}) < 2:
        raise ResultError("force_networks", "needs a run of each method", "run both: make study STUDY=force_networks")
    return [by["MD"], by["CD"]]


def draw(runs, rows, path):
    """Draw both networks and compare their forces contact by contact."""
    pair = _pair(runs)
    snapshots = [observables.snapshot_at_load_maximum(run)[0] for run in pair]
    forces = np.concatenate([snapshot["force_normal"][_loaded(snapshot)] for snapshot in snapshots])
    fig = plt.figure(figsize=(11, 4.6))
    grid = fig.add_gridspec(2, 3, width_ratios=[1, 1, 0.8], height_ratios=[1, 0.08])
    for column, (run, snapshot) in enumerate(zip(pair, snapshots)):
        axis = fig.add_subplot(grid[0, column])
        _network(axis, snapshot, forces.mean())
        axis.set_title(f"{run.method}: {_loaded(snapshot).sum()} contacts, {observables.sliding(snapshot).sum()} at the Coulomb limit")
    _comparison(fig.add_subplot(grid[0, 2]), snapshots, forces.mean())
    below = fig.add_subplot(grid[1, :])
    below.axis("off")
    below.legend(handles=_legend(forces.mean()), loc="center", ncol=5, fontsize=8)
    style.finish(fig, path, "Line thickness is proportional to the normal force R; <R>: its mean over the loaded "
                 "contacts of both.", pair)


def _loaded(snapshot):
    return snapshot["force_normal"] > 0


def _network(axis, snapshot, mean):
    rattlers = observables.rattlers(snapshot)
    circles = [Circle(centre, radius) for centre, radius in zip(snapshot["position"], snapshot["radius"])]
    axis.add_collection(PatchCollection(circles, edgecolor=style.GRAIN, linewidth=0.4, facecolor=np.where(rattlers, style.RATTLER, "none")))
    x_low, x_high, y_low, y_high = snapshot["box"]
    axis.add_patch(Rectangle((x_low, y_low), x_high - x_low, y_high - y_low, fill=False, linewidth=1.2, edgecolor=style.CHAIN))
    segments, sliding = _segments(snapshot), observables.sliding(snapshot)
    widths = POINTS_PER_MEAN * snapshot["force_normal"] / mean
    for mask, colour, level in ((_loaded(snapshot) & ~sliding, style.CHAIN, 2), (sliding, style.SLIDING, 3)):
        axis.add_collection(LineCollection(segments[mask], linewidths=widths[mask], colors=colour, capstyle="round", zorder=level))
    axis.plot(*snapshot["contact_point"][sliding].T, "o", ms=2.6, color=style.SLIDING, mec="white", mew=0.3, zorder=4)
    margin = 0.01 * (x_high - x_low)
    axis.set(aspect="equal", xlim=(x_low - margin, x_high + margin), ylim=(y_low - margin, y_high + margin))
    axis.axis("off")


def _segments(snapshot):
    """Return end points (m, 2, 2) [m] of each force line: the disks' centres, or the contact point at a wall."""
    place = {int(body): centre for body, centre in zip(snapshot["body_ids"], snapshot["position"])}
    ends = [[place.get(int(body), point) for body in ids] for ids, point in zip(snapshot["contact_ids"], snapshot["contact_point"])]
    return np.array(ends).reshape(-1, 2, 2)


def _comparison(axis, snapshots, mean):
    """Draw the normal force of each contact in CD over that in MD."""
    md, cd = observables.matched_forces(*snapshots) / mean
    both = (md > 0) & (cd > 0)
    axis.plot(md[both], cd[both], "o", markersize=2.2, color=style.CHAIN, alpha=0.6, markeredgewidth=0, label=f"in both ({both.sum()})")
    for mask, marker, method in ((cd == 0, "x", "MD"), (md == 0, "+", "CD")):
        axis.plot(md[mask], cd[mask], marker, ms=4, color=style.COLOUR[method], label=f"in {method} only ({mask.sum()})", clip_on=False)
    top = 1.05 * max(md.max(), cd.max())
    axis.plot([0, top], [0, top], color=style.GRAIN, linewidth=0.8, zorder=0)
    axis.set(xlim=(0, top), ylim=(0, top), xlabel=r"R in MD / $\langle R\rangle$", ylabel=r"R in CD / $\langle R\rangle$", aspect="equal",
             title=f"contact by contact: correlation {np.corrcoef(md, cd)[0, 1]:.3f}")
    axis.legend(loc="upper left", handletextpad=0.2)


def _legend(mean):
    lines = [Line2D([], [], color=style.CHAIN, linewidth=POINTS_PER_MEAN * times,
                    label=rf"R = {times:g} $\langle R\rangle$ = {times * mean:.3g} N") for times in (1, 4)]
    return lines + [
        Line2D([], [], color=style.SLIDING, linewidth=2, marker="o", ms=4, mec="white", label=r"at the Coulomb limit, $|T| = \mu R$"),
        Patch(facecolor=style.RATTLER, edgecolor=style.GRAIN, label="rattler"),
        Line2D([], [], color=style.CHAIN, linewidth=1.2, label="walls (frame)")]
