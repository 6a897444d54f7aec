"""The contact forces of MD and CD side by side at the load maximum, and contact by contact.

Line thickness is proportional to the normal force R, on one scale for both; sliding contacts
(|T| = mu R) have another colour and a dot; disks that carry nothing (rattlers) are shaded.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Rectangle

from analysis import observables, style
from analysis.load import ResultError

# Width in points of a line that carries the mean force: thin enough for five times it to fit between disks.
POINTS_PER_MEAN = 1.0


def draw(md, cd, path):
    """Write the figure of two comparable runs (see load.pair) to `path`."""
    snapshots, loads = zip(*(observables.snapshot_at_load_maximum(run) for run in (md, cd)))
    _check_same_instant(md, cd, snapshots)
    mean = _mean_force(snapshots, (md, cd))
    fig, axes = plt.subplots(1, 3, figsize=(13, 6.0), gridspec_kw={"width_ratios": [1, 1, 0.72]})
    for axis, run, snapshot, load in zip(axes, (md, cd), snapshots, loads):
        _network(axis, snapshot, mean)
        axis.set_title(f"{run.method}: {_loaded(snapshot).sum()} contacts, {observables.sliding(snapshot).sum()} "
                       f"sliding, {observables.rattlers(snapshot).sum()} rattlers\n"
                       f"$\\sigma_2/P_0$ = {load:.4g}{_error_of_step(run, snapshot)}")
    _comparison(axes[2], snapshots, mean)
    fig.legend(handles=_legend(mean), loc="lower center", ncol=6, bbox_to_anchor=(0.5, 0.11))
    fig.suptitle("Contact forces at the load maximum, from one prepared packing", fontsize=11, y=0.985)
    fig.subplots_adjust(left=0.015, right=0.985, top=0.87, bottom=0.18, wspace=0.12)
    style.finish(fig, (md, cd), path, "line thickness is proportional to the normal force R, on one scale; "
                 r"$\langle R\rangle$ is its mean over the loaded contacts of both")


def _check_same_instant(md, cd, snapshots):
    cycles = [snapshot["cycle"] for snapshot in snapshots]
    if abs(cycles[0] - cycles[1]) > 1e-2:
        raise ResultError(f"{md.path}, {cd.path}", f"the load maxima lie at cycles {cycles[0]:g} and "
                          f"{cycles[1]:g}", "give two runs of the same loading")


def _error_of_step(run, snapshot):
    """For CD: the error e of the step sampled with the snapshot, in words."""
    if run.method != "CD":
        return ""
    nearest = np.argmin(np.abs(run.values("time") - snapshot["time"]))
    return f", error e = {style.number(run.values('residual')[nearest])}"


def _mean_force(snapshots, runs):
    """Mean normal force over the loaded contacts of all snapshots [N], the unit of the figure."""
    forces = np.concatenate([snapshot["force_normal"][_loaded(snapshot)] for snapshot in snapshots])
    if not len(forces):
        raise ResultError(", ".join(str(run.path) for run in runs), "no contact carries a force",
                          "check the loading of these runs")
    return forces.mean()


def _loaded(snapshot):
    return snapshot["force_normal"] > 0


def _network(axis, snapshot, mean):
    """Disks, walls and force chains."""
    rattlers = observables.rattlers(snapshot)
    circles = [Circle(centre, radius) for centre, radius in zip(snapshot["position"], snapshot["radius"])]
    axis.add_collection(PatchCollection(
        circles, edgecolor=style.GRAIN, linewidth=0.4,
        facecolor=[style.RATTLER if idle else "none" for idle in rattlers]))
    x_low, x_high, y_low, y_high = snapshot["box"]
    axis.add_patch(Rectangle((x_low, y_low), x_high - x_low, y_high - y_low, fill=False, linewidth=1.2,
                             edgecolor=style.CHAIN))
    segments, sliding = _segments(snapshot), observables.sliding(snapshot)
    widths = POINTS_PER_MEAN * snapshot["force_normal"] / mean
    for mask, colour, level in ((_loaded(snapshot) & ~sliding, style.CHAIN, 2), (sliding, style.SLIDING, 3)):
        axis.add_collection(LineCollection(segments[mask], linewidths=widths[mask], colors=colour,
                                           capstyle="round", zorder=level))
    axis.plot(*snapshot["contact_point"][sliding].T, "o", markersize=2.6, color=style.SLIDING,
              markeredgecolor="white", markeredgewidth=0.3, zorder=4)
    axis.set_aspect("equal")
    margin = 0.01 * (x_high - x_low)
    axis.set_xlim(x_low - margin, x_high + margin)
    axis.set_ylim(y_low - margin, y_high + margin)
    axis.axis("off")


def _segments(snapshot):
    """End points (m, 2, 2) [m] of each force line: the disks' centres, or the contact point at a wall."""
    place = {int(body): centre for body, centre in zip(snapshot["body_ids"], snapshot["position"])}
    return np.array([[place.get(int(body), point) for body in ids]
                     for ids, point in zip(snapshot["contact_ids"], snapshot["contact_point"])]).reshape(-1, 2, 2)


def _comparison(axis, snapshots, mean):
    """Normal force of each contact in CD over that in MD."""
    md, cd = observables.matched_forces(*snapshots) / mean
    both = (md > 0) & (cd > 0)
    axis.plot(md[both], cd[both], "o", markersize=2.2, color=style.CHAIN, alpha=0.6, markeredgewidth=0,
              label=f"in both ({both.sum()})")
    for mask, marker, method in ((cd == 0, "x", "MD"), (md == 0, "+", "CD")):
        axis.plot(md[mask], cd[mask], marker, markersize=4, color=style.COLOUR[method], linestyle="none",
                  label=f"in {method} only ({mask.sum()})", clip_on=False)
    top = 1.05 * max(md.max(), cd.max())
    axis.plot([0, top], [0, top], color=style.GRAIN, linewidth=0.8, zorder=0)
    axis.set(xlim=(0, top), ylim=(0, top), xlabel=r"R in MD / $\langle R\rangle$", ylabel=r"R in CD / $\langle R\rangle$")
    axis.set_aspect("equal")
    difference = np.sqrt(np.mean((md - cd)**2))
    axis.set_title(f"contact by contact: correlation {observables.correlation(md, cd):.4f},\n"
                   rf"rms difference {style.number(difference)} $\langle R\rangle$")
    axis.legend(loc="upper left", handletextpad=0.2)


def _legend(mean):
    lines = [Line2D([], [], color=style.CHAIN, linewidth=POINTS_PER_MEAN * times,
                    label=rf"R = {times:g} $\langle R\rangle$ = {style.number(times * mean)} N") for times in (1, 4)]
    return lines + [
        Line2D([], [], color=style.SLIDING, linewidth=2, marker="o", markersize=4, markeredgecolor="white",
               label=r"at the Coulomb limit (sliding), $|T| = \mu R$"),
        Patch(facecolor=style.RATTLER, edgecolor=style.GRAIN, label="rattler"),
        Line2D([], [], color=style.CHAIN, linewidth=1.2, label="walls (frame)")]
