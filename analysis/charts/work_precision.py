"""Error against time of computing: a chart for each scene, with a line for each series and a point for each setting."""
import numpy as np
import pandas

from analysis import style
from analysis.charts import choice, table
from analysis.style import plt
from yade_scripts import scenes

TITLE = "Speed against accuracy, scene by scene"
QUESTION = ("How long does each method compute to reach a given accuracy? Only the time of the steps counts, not that of start-up, building the "
            "scene and output.")
ANSWER = """
The table has every setting of every scene with its error and time; failures are rows of it. Beside it lies a figure for each scene.
"""
GIVEN = ()
FLOOR = 1e-16  # where an error of zero is drawn
# Okabe and Ito's palette and black, told apart by marker and line as well: MD full lines, CD dashed.
LOOK = {"MD step": ("#0072B2", "o"), "MD stiffness": ("#56B4E9", "s"), "MD stiffness, fine step": ("#009E73", "D"), "MD damping": ("#1A1A1A", "*"),
        "MD law avoid_ratcheting": ("#009E73", "<"), "MD law path_independent": ("#1A1A1A", ">"), "CD step": ("#E69F00", "^"),
        "CD accelerated": ("#D55E00", "v"), "CD nsgs": ("#CC79A7", "P"), "CD sweeps": ("#8C564B", "p"), "CD accuracy": ("#000000", "X"),
        "CD newton": ("#7F3FBF", "d"), "CD auto": ("#B8A100", "H")}


def numbers(table):
    return {}  # the text has none


def rows(measured):
    return measured


def draw(rows, folder, line):
    titles = {}
    for name, own in table.one_size(rows).groupby("scene", sort=False):
        scene, file = scenes.module(name), f"work_precision-{name}.png"
        _draw(own, scene, folder / file, line)
        titles[file] = scene.TITLE
    return titles


def _draw(rows, scene, path, line):
    fig, axes = plt.subplots(figsize=(7.2, 4.4))
    labels, chance = [], scene.KIND == "flow"  # errors of a chaotic mean go up and down by chance: a line would show nothing
    for series, own in table.by_series(rows[(rows.status == "") & rows.error.notna()]):
        colour, marker = LOOK.get(series, ("#7F7F7F", "h"))
        seconds, errors = own.seconds.to_numpy(), own.error.clip(lower=FLOOR).to_numpy()
        axes.loglog(seconds, errors, color=colour, marker=marker, markersize=5, linewidth=1, label=series,
                    linestyle="none" if chance or series in choice.NO_LADDER else "-" if series.startswith("MD") else "--")
        for k in np.flatnonzero(pandas.to_numeric(own.unconverged_steps) > 0):
            axes.plot(seconds[k], errors[k], marker=marker, color=colour, markerfacecolor="white", markersize=5)
        labels += [(own.setting.iloc[k].split("=")[1], (seconds[k], errors[k]), colour) for k in sorted({0, len(own) - 1})]
    _write_labels(axes, labels)
    failed = (rows.status != "").sum()
    axes.set(xlabel="time of computing [s]", ylabel="relative error", title=scene.TITLE)
    axes.grid(alpha=0.25, linewidth=0.5)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7)
    style.finish(fig, path, f"Numbers: coarsest and finest setting. Hollow: with missed steps. {failed} of {len(rows)} settings failed.", line)


def _write_labels(axes, labels):
    """Write the labels, but none within a twentieth of the axes of another."""
    written = []
    for text, place, colour in labels:
        spot = axes.transAxes.inverted().transform(axes.transData.transform(place))
        if all(np.abs(spot - other).max() > 0.05 for other in written):
            written.append(spot)
            axes.annotate(text, place, textcoords="offset points", xytext=(4, 4), fontsize=6.5, color=colour)
