"""Fig. 4 of the paper: stress against gamma over one loading and unloading, MD left and CD right.

The upper row has the same axes for both, which shows how the two compare; each panel of the lower row
is zoomed to its own range, as in the paper, which notes the difference in horizontal axes.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis import observables, style


_LOADING = dict(linestyle="-", label="loading")
_UNLOADING = dict(linestyle=(0, (4, 1.5)), label="unloading")
# The end is larger and open, since it may lie on the start.
_MARKS = (dict(marker="o", markersize=5, linestyle="none", label="start"),
          dict(marker="^", markersize=6, linestyle="none", label="load maximum"),
          dict(marker="s", markersize=8, markerfacecolor="none", linestyle="none", label="end"))

# Also under fixed_iterations, where the engine tests nothing and counts no step as missed.
_MISSED = dict(marker="x", markersize=4, markeredgewidth=0.6, color="#777777", zorder=1, linestyle="none",
               label="CD step above its tolerance")


def draw(md, cd, path, cycle=1):
    """Write the figure of cycle `cycle` of two comparable runs (see load.pair) to `path`."""
    fig, axes = plt.subplots(2, 2, figsize=(9.6, 7.6))
    loops = [_Loop(run, cycle) for run in (md, cd)]
    exponent = style.power_of_ten(np.concatenate([loop.gamma for loop in loops]))
    for axis, loop in zip(axes[0], loops):
        _curve(axis, loop, exponent)
        axis.set_title(f"{loop.run.method}, same axes")
    _same_limits(axes[0])
    for axis, loop in zip(axes[1], loops):
        _curve(axis, loop, style.power_of_ten(loop.gamma))
        _pad(axis)
        axis.set_title(f"{loop.run.method}, its own range")
        axis.text(0.5, -0.26, loop.report(), transform=axis.transAxes, fontsize=8,
                  ha="center", va="top", linespacing=1.5)
    fig.legend(handles=_legend(), loc="upper center", bbox_to_anchor=(0.5, 0.965), ncol=6)
    fig.subplots_adjust(left=0.08, right=0.98, top=0.89, bottom=0.28, hspace=0.42, wspace=0.2)
    fig.suptitle("One loading and unloading, MD and CD from the same prepared packing (the paper's Fig. 4)",
                 fontsize=11, y=0.99)
    style.finish(fig, (md, cd), path)


class _Loop:
    """The samples of one cycle and the numbers read from them."""

    def __init__(self, run, cycle):
        part = observables.cycle_range(run, cycle)
        self.run = run
        self.missed = observables.above_tolerance(run)[part] if run.method == "CD" else None
        self.gamma = run.values("gamma")[part]
        self.stress = run.values("sigma2")[part] / run.pressure
        self.permanent = observables.permanent_strain(self.gamma)
        self.width = observables.loop_width(self.gamma, self.stress)
        self.dissipated = observables.change(run, "dissipated_energy", part)
        self.work = observables.wall_work(run, part)
        self.stored = observables.change(run, "stored_energy", part)
        self.scale = run.pressure * observables.start_volume(run)

    def report(self):
        """The numbers in words, for the space under a panel."""
        number = style.number
        lines = [rf"remanent $\gamma$ = {number(self.permanent)}, largest loop width {number(self.width)}",
                 rf"work of the walls {number(self.work)} J: dissipated {number(self.dissipated)} J, "
                 rf"stored {number(self.stored)} J",
                 rf"dissipated {number(self.dissipated / self.scale)} $P_0V_0$; largest "
                 rf"$|\sigma-\sigma_\mathrm{{goal}}|$ = {number(observables.stress_error(self.run))} $P_0$"]
        if self.run.method == "CD":
            lines.append(f"{self._convergence()}, e $\\leq$ {number(observables.largest_residual(self.run))}")
        return "\n".join(lines)

    def _convergence(self):
        sweeps = self.run.parameters["fixed_iterations"]
        if sweeps:
            return f"{sweeps} sweeps in every step, whatever the error"
        return (f"{observables.unconverged_steps(self.run)} steps missed the tolerance "
                f"({100 * self.missed.mean():.3g} % of those sampled)")


def _curve(axis, loop, exponent):
    """Stress over gamma in units of 10^exponent, with start, load maximum and end marked."""
    gamma, stress, colour = loop.gamma / 10.0**exponent, loop.stress, style.COLOUR[loop.run.method]
    top = int(np.argmax(stress))
    for part, branch in ((slice(0, top + 1), _LOADING), (slice(top, None), _UNLOADING)):
        axis.plot(gamma[part], stress[part], color=colour, **branch)
    if loop.missed is not None:
        axis.plot(gamma[loop.missed], stress[loop.missed], **_MISSED)
    for mark, at in zip(_MARKS, (0, top, -1)):
        axis.plot(gamma[at], stress[at], color=colour, **mark)
    unit = rf" [$10^{{{exponent}}}$]" if exponent else ""
    axis.set_xlabel(rf"$\gamma = \epsilon_2 - \epsilon_1${unit}   (< 0: shortens along axis 2)")
    axis.set_ylabel(r"$\sigma_2 / P_0$")
    axis.grid(color="#DDDDDD", linewidth=0.5)


def _legend():
    """Handles in a colour that belongs to no method."""
    return [Line2D([], [], **({"color": style.CHAIN} | kind)) for kind in (_LOADING, _UNLOADING, *_MARKS, _MISSED)]


def _same_limits(axes):
    """One range for all axes, that of the data of all."""
    boxes = [axis.dataLim for axis in axes]
    for axis in axes:
        _limits(axis, min(b.x0 for b in boxes), max(b.x1 for b in boxes),
                min(b.y0 for b in boxes), max(b.y1 for b in boxes))


def _pad(axis):
    _limits(axis, *axis.dataLim.intervalx, *axis.dataLim.intervaly)


def _limits(axis, x0, x1, y0, y1, margin=0.06):
    """Limits with a margin; a range of width zero is left to Matplotlib."""
    if x1 > x0:
        axis.set_xlim(x0 - margin * (x1 - x0), x1 + margin * (x1 - x0))
    if y1 > y0:
        axis.set_ylim(y0 - margin * (y1 - y0), y1 + margin * (y1 - y0))
