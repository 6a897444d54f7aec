"""Error against time of computing: a chart for each scene, with a line for each series and a point for each setting."""
import numpy as np
import pandas

from analysis import style
from analysis.charts import choice, table
from analysis.style import plt
from yade_scripts import parameters, scenes

TITLE = "Speed against accuracy, scene by scene"
QUESTION = "How long does each method compute to reach a given accuracy? Only the time of the steps counts."
FLOOR = 1e-16  # where an error of zero is drawn
# A colour and a marker of its own for each series. MD full lines, CD dashed.
LOOK = {"MD step": (style.BLUE, "o"), "MD stiffness": (style.SKY, "s"), "MD stiffness, fine step": (style.GREEN, "D"), "MD damping": (style.INK, "*"),
        "MD law avoid_ratcheting": (style.LIME, "<"), "MD law path_independent": (style.PURPLE, ">"), "CD step": (style.ORANGE, "^"),
        "CD accelerated": (style.VERMILION, "v"), "CD nsgs": (style.PINK, "P"), "CD sweeps": (style.BROWN, "p"), "CD accuracy": (style.DARK_RED, "X"),
        "CD newton": (style.MAGENTA, "d"), "CD auto": (style.OLIVE, "H"), "CD springs step": (style.GREEN, "D"),
        "CD springs tolerance": (style.PURPLE, "v"), "CD springs stiffness": (style.BROWN, "s")}


def rows(measured):
    return measured


def draw(rows, folder, line):
    titles = {}
    for name, own in table.one_size(rows).groupby("scene", sort=False):
        scene, file = scenes.module(name), f"work_precision-{name}.png"
        _draw(own, scene, folder / file, line)
        titles[file] = name
    return titles


def _draw(rows, scene, path, line):
    """Draw a panel for each method, in which the settings of the others are grey."""
    found, chance = rows[(rows.status == "") & rows.error.notna()], scene.KIND == "flow"  # means of chaotic flows err by chance: a line would mislead
    methods = [method for method in table.WORDS if method in set(rows.method)]
    fig, panels = plt.subplots(1, len(methods), figsize=(4 + 2.7 * len(methods), 4.6), sharex=True, sharey=True, squeeze=False)
    for axes, method in zip(panels[0], methods):
        others = found[found.method != method]
        axes.loglog(others.seconds, others.error.clip(lower=FLOOR), ".", color=style.GREY["BB"], markersize=4, zorder=1)
        for series, own in table.by_series(found[found.method == method]):
            colour, marker = LOOK.get(series, (style.GREY["7F"], "h"))
            seconds, errors = own.seconds.to_numpy(), own.error.clip(lower=FLOOR).to_numpy()
            axes.loglog(seconds, errors, color=colour, marker=marker, markersize=5, linewidth=1, label=_label(series, own),
                        linestyle="none" if chance or series in choice.NO_LADDER else "-" if method == "MD" else "--")
            axes.plot(seconds[0], errors[0], marker=marker, color=colour, markersize=8)
            missed = np.flatnonzero(pandas.to_numeric(own.unconverged_steps) > 0)
            axes.plot(seconds[missed], errors[missed], marker=marker, color=colour, ls="none", markerfacecolor="white", markersize=5)
        axes.set(xlabel="time of computing [s]", title=table.WORDS[method])
        axes.grid(True)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), ncol=2, fontsize=6, columnspacing=1, handlelength=1.5)
    panels[0, 0].set_ylabel("relative error")
    fig.suptitle(scene.TITLE)
    style.finish(fig, path, "Each series varies one parameter of a run, from the coarsest value (large) to the finest. Hollow: with missed steps. "
                 + "Grey: the other methods. " * (len(methods) > 1) + f"{(rows.status != '').sum()} of {len(rows)} settings failed.", line)


def _label(series, rows):
    """Return the name of a series with the parameter that it varies, its range and its unit."""
    (name, coarsest), (_, finest) = (rows.setting.iloc[k].split("=") for k in (0, -1))
    known = parameters.registry(rows.scene.iloc[0]).get(name)
    unit = f" {known.unit}" if known and known.unit != "1" else ""
    series = series.removeprefix(f"{rows.method.iloc[0]} ")
    return f"{series}{'' if series == name else f', {name}'}: {coarsest} to {finest}{unit}"
