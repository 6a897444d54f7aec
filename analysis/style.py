"""The common style of all figures; colours and markers can be told apart without colour vision."""
import io
import math
import textwrap

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # after the backend is chosen
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from yade_scripts.results import provenance, sealed
from yade_scripts.theory import effective_medium

# Okabe and Ito's palette, distinct under the common colour-vision deficiencies, and more that differ from it in lightness.
BLUE, VERMILION, GREEN, PINK, SKY, ORANGE = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00"
PURPLE, DARK_RED, LIME, BROWN, MAGENTA, OLIVE, INK, BLACK = "#6A3D9A", "#8B0000", "#80B918", "#8C564B", "#B030B0", "#B8A100", "#1A1A1A", "#000000"
GREY = {level: f"#{3 * level}" for level in ("44", "55", "77", "7F", "88", "9A", "AA", "BB", "DD", "EE")}  # from dark to light
COLOUR = {"MD": BLUE, "CD": VERMILION}
MARKER = {"MD": "o", "CD": "s"}
WORDS = {"MD": "springs (MD)", "CD": "rigid contacts (CD)"}
STRESS_PATH = {"constant": r"$\sigma_1 = P_0$", "mean": r"$(\sigma_1+\sigma_2)/2 = P_0$"}
# It goes through more hues than viridis, so that nine lines can be told apart: neighbours differ twice as much, also without red or green.
SHADES = LinearSegmentedColormap.from_list("shades", ("#540000", "#6B00CE", "#005CB6", "#00868D", "#819C45", "#FFAE2C"))
SLIDING, CHAIN, GRAIN, RATTLER = VERMILION, INK, "#B8B8B8", "#E6E6E6"
CAPTION, FOOT = "Caption", "Foot"  # entries of the PNG files: what the figure shows; how many pixels at the bottom are the caption

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 160, "font.size": 9, "font.family": "DejaVu Sans",
    "axes.titlesize": 10, "axes.labelsize": 9, "axes.linewidth": 0.7, "axes.spines.top": False,
    "axes.spines.right": False, "lines.linewidth": 1.2, "lines.markersize": 6, "legend.frameon": False,
    "grid.color": "#DDDDDD", "grid.linewidth": 0.5,
    "legend.fontsize": 8, "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.formatter.useoffset": False,
})


def finish(fig, path, note, origin):
    """Put a caption under the figure and write it as a PNG file to `path`.

    note: what the figure shows, in plain text, as in the templates (report.symbols). origin: the runs that it comes from, or a line of text. The JSON
    file beside the figure has the settings. The file holds both as text, and the height of the caption in pixels, since the report shows the caption
    as text of its own.
    """
    _mend_logarithms(fig)
    line = origin if isinstance(origin, str) else source(origin)
    width = int(15.5 * fig.get_figwidth())
    caption = textwrap.fill(note, width) + "\n" + textwrap.fill(line, width)
    foot = (0.15 + 0.145 * (caption.count("\n") + 1)) / fig.get_figheight()
    fig.set_layout_engine("constrained", rect=(0, foot, 1, 1 - foot))
    fig.text(0.5, 0.04 / fig.get_figheight(), caption, ha="center", va="bottom", fontsize=7.5, linespacing=1.4)
    # At most 1600 pixels wide, as wide as a screen shows.
    picture, dpi = io.BytesIO(), min(plt.rcParams["savefig.dpi"], 1600 / fig.get_figwidth())
    fig.savefig(picture, format="png", dpi=dpi, metadata={"Description": line, CAPTION: note, FOOT: str(round(dpi * foot * fig.get_figheight()))})
    plt.close(fig)
    sealed.replace(path, picture.getvalue())


def source(runs):
    """Return where a figure comes from, in words: number of runs, of packings and of their seeds, commit, YADE, CD's tolerance and the share of steps
    that missed it."""
    commits, states = ({run.attributes[name] for run in runs} - {""} for name in ("git_commit", "state_sha256"))
    seeds = len({run.parameters["seed"] for run in runs})
    return (f"{len(runs)} run{'s' * (len(runs) > 1)}" + f" from {len(states)} packing{'s' * (len(states) > 1)}" * bool(states)
            + f" of {seeds} seed{'s' * (seeds > 1)}" * (seeds < len(states))
            + f", {provenance.words(sorted(commits))}, YADE {runs[0].attributes['yade_version']}" + _solved(runs))


def _solved(runs):
    """Return the tolerances of the CD runs and how many steps missed them, and that those of a fixed number of sweeps have none, in words."""
    rigid = [run for run in runs if run.method == "CD"]
    solved = [run for run in rigid if not run.parameters["fixed_iterations"]]
    without = "; runs with a fixed number of sweeps have no tolerance" if len(solved) < len(rigid) else ""
    if not solved:
        return without
    ranges = []
    for springs, words in ((False, ""), (True, "for springs, relative to the change of load, ")):
        tolerances = {run.parameters["tolerance"] for run in solved if (run.parameters.get("cd_contacts") == "springs") == springs}
        if tolerances:
            ranges.append(words + " to ".join(f"{value:.0e}" for value in sorted({min(tolerances), max(tolerances)})))
    steps = [max(1, round(run.values("time")[-1] / effective_medium.step(run.parameters))) for run in solved]
    share = max(run.history["unconverged_steps"][-1] / count for run, count in zip(solved, steps))
    missed = f"missed by at most {100 * share:.2g} % of the steps of a run" if share else "missed by no step"
    return f"; CD's tolerance {', '.join(ranges)}, {missed}{without}"


def _mend_logarithms(fig):
    """Make logarithmic axes without positive values linear, and give those between two powers of ten two numbers at least.

    Matplotlib finds no ticks in the first case. In the second it writes one number, none, or several over each other.
    """
    for axes in fig.axes:
        for axis, scale in ((axes.xaxis, axes.set_xscale), (axes.yaxis, axes.set_yscale)):
            if not isinstance(axis.get_major_locator(), LogLocator):  # linear, or with ticks of its own
                continue
            low, high = sorted(axis.get_view_interval())
            if not math.isfinite(axis.get_minpos()):
                scale("linear")
            elif 0 < low and math.floor(math.log10(high)) <= math.ceil(math.log10(low)):
                axis.set_major_locator(LogLocator(subs=(1, 2, 5)) if high > 5 * low else MaxNLocator(3))
                axis.set_major_formatter(lambda value, _: f"{value:g}")
                axis.set_minor_locator(NullLocator())


def points(axis, table, x, y, method, **look):
    """Draw two columns of a pandas table against each other, one point a row, in a method's colour and marker unless `look` has others."""
    axis.plot(table[x], table[y], **dict(ls="", marker=MARKER[method], ms=4.5, color=COLOUR[method]) | look)


def legend(where, looks, **place):
    """Put a legend on axes or a figure whose entries are lines of these looks: the properties of each and its label."""
    where.legend(handles=[plt.Line2D([], [], **look) for look in looks], **place)


def power_of_ten(values):
    """Return the exponent that brings the largest of `values` between 1 and 10; 0 if all vanish."""
    largest = float(np.abs(values).max()) if len(values) else 0
    return math.floor(math.log10(largest)) if largest else 0


def shades(values):
    """Return {value: colour} for ordered values, from dark to light."""
    ordered = sorted(set(values))
    return {value: SHADES(k / max(1, len(ordered) - 1)) for k, value in enumerate(ordered)}
