"""Error against time of computing, one chart a scene: a series a line, a setting a point, failures at the top."""

import textwrap
from pathlib import Path

import numpy as np

from analysis import publish as tables
from analysis.charts import choice, look, origin, table
from analysis.style import plt
from yade_scripts import scenes

TITLE = "Speed against accuracy, scene by scene"
QUESTION = ("How long has each method to compute for a given accuracy? Every scene has an exact or converged answer; the error is the largest of all that is "
            "known of it. The time is that of the steps alone: start-up, building the scene, and output are left out.")
FLOOR = 1e-16  # where an error of zero is drawn


def publish(results, folder, full):
    """The table of all settings, and a figure a scene."""
    rows, records = table.from_records(results, full)
    Path(folder).mkdir(parents=True, exist_ok=True)
    tables.write_csv(Path(folder) / "work_precision.csv", rows)
    figures = []
    for scene in dict.fromkeys(row["scene"] for row in table.one_size(rows)):
        file = f"work_precision-{scene}.png"
        own = [row for row in table.one_size(rows) if row["scene"] == scene]
        draw(own, list({row["name"]: records[row["name"]] for row in own}.values()), Path(folder) / file)
        figures.append({"file": file, "title": table.title(scene)})
    origin.write("work_precision", folder, {"title": TITLE, "question": QUESTION, "answer": answer(table.one_size(rows)), "figures": figures}, list(records.values()), full)


def draw(rows, records, path):
    """The chart of one scene: failures in a strip of their own above the errors."""
    failed = table.by_series([row for row in rows if row["status"]])
    fig, (strip, axes) = plt.subplots(2, 1, figsize=(8.2, 5.2 + 0.16 * len(failed)), sharex=True,
                                      gridspec_kw={"height_ratios": (0.16 * len(failed) + 0.01, 4)})
    axes.set(xscale="log", yscale="log", xlabel="time of computing [s], median of the repeats; bar: fastest to slowest", ylabel="relative error")
    labels = []
    for series, own in table.by_series(rows).items():
        _draw_series(axes, series, [row for row in own if not row["status"]], labels)
    axes.grid(alpha=0.25, linewidth=0.5)
    _write_labels(axes, labels)
    _draw_failures(strip, failed, max((row["seconds"] for row in rows if row["seconds"]), default=1.0))
    if axes.lines:
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), title="series, coarse to fine")
    scene, worst = rows[0]["scene"], ", ".join(sorted({row["worst"] for row in rows if row["worst"]}))
    strip.set_title(table.title(scene))
    own = scenes.module(scene)
    note = "\n".join(textwrap.fill(line, 150) for line in (f"Error: the largest of {worst}. {own.HORIZON}", f"Left out: {own.LEFT_OUT}.",
                                                            f"Hollow: steps missed their tolerance. Zero is drawn at {FLOOR:g}."))
    origin.finish(fig, path, note, records)


def _draw_series(axes, series, rows, labels):
    """One line; the ends of it say their setting."""
    if not rows:
        return
    seconds, errors = [row["seconds"] for row in rows], [max(row["error"], FLOOR) for row in rows]
    kind = look.of(series)
    joined = {"linestyle": "none"} if series in choice.NO_LADDER else {}
    axes.plot(seconds, errors, label=series, linewidth=1, alpha=0.9, **(kind | joined))
    for row, x, y in zip(rows, seconds, errors):
        axes.plot([row["fastest"], row["slowest"]], [y, y], color=kind["color"], linewidth=0.6, alpha=0.6)
        if row["unconverged_steps"]:
            axes.plot(x, y, marker=kind["marker"], color=kind["color"], markerfacecolor="white", markersize=5)
    labels += [(rows[k]["setting"].split("=")[1], (seconds[k], errors[k]), kind["color"]) for k in sorted({0, len(rows) - 1})]


def _write_labels(axes, labels):
    """The labels that have room: none within a twentieth of the axes of one written before."""
    written = []
    for text, place, colour in labels:
        spot = axes.transAxes.inverted().transform(axes.transData.transform(place))
        if all(np.abs(spot - other).max() > 0.05 for other in written):
            written.append(spot)
            axes.annotate(text, place, textcoords="offset points", xytext=(4, 4), fontsize=6.5, color=colour)


def _draw_failures(strip, failed, slowest):
    """A line a series: its reasons, and a cross for each setting, where the series would go on."""
    strip.set(ylim=(len(failed), -0.5))
    strip.axis("off")
    for number, (series, own) in enumerate(failed.items()):
        colour, places = look.of(series)["color"], slowest * np.geomspace(1, 1.5, len(own))
        strip.plot(places, [number] * len(own), "x", color=colour, markersize=5, clip_on=False)
        # A setting that was not tried since a coarser one was too slow would have been so, too.
        reasons = "; ".join(sorted({row["status"].removeprefix("failed: ").removeprefix("not tried: a coarser setting ") for row in own}))
        strip.annotate(f"{series}, {len(own)} failed: {reasons}"[:110], (places[0], number), fontsize=6.5, xytext=(-6, 0), textcoords="offset points",
                       ha="right", va="center", color=colour)


def answer(rows):
    """For every scene the cheapest settings of both methods, and what failed."""
    said = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        own = [row for row in rows if row["scene"] == scene]
        said.append(f"{scene}: " + "; ".join(_sentence(own, level) for level in table.LEVELS[:2]) + ".")
    failed = [row for row in rows if row["status"]]
    said.append(f"{len(failed)} of {len(rows)} settings failed." if failed else "No setting failed.")
    return "\n".join(said)


def _sentence(rows, level):
    found = {method: choice.cheapest([row for row in rows if row["method"] == method], level) for method in ("MD", "CD")
             if any(row["method"] == method for row in rows)}
    return f"to {level:g} " + " and ".join(
        f"{method} takes {row['seconds']:.2g} s ({row['setting']})" if row else f"{method} does not come" for method, row in found.items())
