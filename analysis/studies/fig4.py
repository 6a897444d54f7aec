"""Fig. 4 over the packings: stress against gamma in one loading and unloading, MD left and CD right."""

import matplotlib.pyplot as plt
import numpy as np

from analysis import observables, style
from analysis.studies import summary

TITLE = "Fig. 4: one cycle of loading and unloading"
QUESTION = ("From the same packing, how far do the loops of stress against strain of springs (MD) and rigid contacts (CD) differ, "
            "how much do they dissipate and what strain do they keep - and is that so for every packing?")
TABLES = {"quick": ("quick/fig4.txt",), "full": ("fig4.txt",)}


def summarize(runs):
    """One row a run: the loop, the energies in units of P0 V0, and how well they balance."""
    return [_row(run) for run in runs]


def _row(run):
    gamma, sigma2 = run.values("gamma"), run.values("sigma2")
    snapshot, _ = observables.snapshot_at_load_maximum(run)
    scale = observables.work_scale(run)
    return {
        "method": run.method, "seed": run.parameters["seed"], "outcome": run.outcome,
        "largest |gamma|": float(np.abs(gamma).max()), "remanent gamma": float(observables.permanent_strain(gamma)),
        "loop width": observables.loop_width(gamma, sigma2), "dissipated/P0V0": float(observables.change(run, "dissipated_energy") / scale),
        "work/P0V0": float(observables.change(run, "wall_work") / scale),
        "balance error": float(observables.balance_error(run)), "work by stress and strain, error": float(observables.work_error(run)),
        "sliding at the maximum": int(observables.sliding(snapshot).sum()),
        "coordination at the maximum": float(observables.coordination(snapshot)),
        "stress error/P0": float(observables.stress_error(run)),
        "unsolved steps": observables.unconverged_steps(run) if run.method == "CD" else "",
    }


def draw(runs, rows, path):
    """Above, both methods on the same axes; below, each on its own: a thin line a packing, the first one bold."""
    fig, axes = plt.subplots(2, 2, figsize=(9.6, 7.4))
    for column, method in enumerate(("MD", "CD")):
        own = [run for run in runs if run.method == method]
        for axis, zoomed in ((axes[0, column], False), (axes[1, column], True)):
            exponent = style.power_of_ten(np.concatenate([run.values("gamma") for run in (own if zoomed else runs)] or [[0.0]]))
            for number, run in enumerate(own):
                _loop(axis, run, exponent, bold=number == 0)
            unit = rf" [$10^{{{exponent}}}$]" if exponent else ""
            axis.set_xlabel(rf"$\gamma = \epsilon_2 - \epsilon_1${unit}   (< 0: shortens along axis 2)")
            axis.set_ylabel(r"$\sigma_2/P_0$")
            axis.set_title(f"{method}, {'its own range' if zoomed else 'same axes'}")
            axis.grid(color="#DDDDDD", linewidth=0.5)
    _same_limits(axes[0])
    fig.subplots_adjust(left=0.08, right=0.98, top=0.95, bottom=0.16, hspace=0.38, wspace=0.2)
    note = "Solid: loading, dashed: unloading, square: end; bold: the first packing. CD's own range is its solver's tolerance"
    style.finish(fig, runs, path, note)


def _loop(axis, run, exponent, bold):
    gamma, stress = run.values("gamma") / 10.0**exponent, run.values("sigma2") / run.pressure
    top = int(np.argmax(stress))
    look = dict(color=style.COLOUR[run.method], linewidth=1.6 if bold else 0.6, alpha=1 if bold else 0.6)
    axis.plot(gamma[:top + 1], stress[:top + 1], **look)
    axis.plot(gamma[top:], stress[top:], linestyle=(0, (4, 1.5)), **look)
    axis.plot(gamma[-1], stress[-1], "s", color=look["color"], markersize=7 if bold else 4, markerfacecolor="none")


def _same_limits(axes):
    low, high = (choose(limit) for choose, limit in ((min, [a.get_xlim()[0] for a in axes]), (max, [a.get_xlim()[1] for a in axes])))
    for axis in axes:
        axis.set_xlim(low, high)


def answer(rows):
    """The loops' sizes by method, with the range over the packings, and their ratio."""
    by = {method: [row for row in rows if row["method"] == method] for method in ("MD", "CD")}
    if not all(by.values()):
        return f"Only {' and '.join(m for m in by if by[m])} runs have finished: nothing to compare yet."
    def size(name, method):
        return summary.spread([abs(row[name]) for row in by[method]])
    ratio = summary.paired_ratio(by["MD"], by["CD"], ("seed",), "largest |gamma|")
    balance = {method: summary.largest(row["balance error"] for row in by[method]) for method in by}
    text = (f"The largest |gamma| is {size('largest |gamma|', 'MD')} in MD and {size('largest |gamma|', 'CD')} in CD, smaller by a factor of "
            f"{summary.spread(ratio)} on the same packing. MD keeps |gamma| = {size('remanent gamma', 'MD')} and dissipates "
            f"{size('dissipated/P0V0', 'MD')} P0 V0, CD {size('remanent gamma', 'CD')} and {size('dissipated/P0V0', 'CD')} P0 V0. "
            f"This is the order that the paper reports, in all of {len(ratio)} packings" if min(ratio) > 1 else
            f"The order that the paper reports does not hold for every packing: the largest |gamma| of MD over CD's is {summary.spread(ratio)}")
    return (text + f". The energy balance closes within {summary.percent(balance['MD'])} of the walls' work in MD (dashpots not counted) and "
            f"{summary.percent(balance['CD'])} in CD. How much of CD's loop is the solver's tolerance is the question of another study; "
            f"{sum(row['unsolved steps'] or 0 for row in by['CD'])} CD steps missed theirs.")
