"""Error against time of computing, one chart a scene: a series a line, a setting a point, failures at the top."""

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
    figures, by_name = [], {}
    for record in records:
        by_name.setdefault(record["scene"], []).append(record)
    for scene in dict.fromkeys(row["scene"] for row in table.one_size(rows)):
        file = f"work_precision-{scene}.png"
        own = [row for row in table.one_size(rows) if row["scene"] == scene]
        draw(own, by_name[scene], Path(folder) / file)
        figures.append({"file": file, "title": table.title(scene)})
    origin.write("work_precision", folder, {"title": TITLE, "question": QUESTION, "answer": answer(table.one_size(rows)), "figures": figures}, records, full)


def draw(rows, records, path):
    """The chart of one scene."""
    fig, axes = plt.subplots(figsize=(8.2, 5.2))
    axes.set(xscale="log", yscale="log", xlabel="time of computing [s], median of the repeats; bar: fastest to slowest", ylabel="relative error")
    for series, own in table.by_series(rows).items():
        _draw_series(axes, series, [row for row in own if not row["status"]])
    _draw_failures(axes, rows)
    axes.grid(alpha=0.25, linewidth=0.5)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), title="series, coarse to fine")
    scene, worst = rows[0]["scene"], ", ".join(sorted({row["worst"] for row in rows if row["worst"]}))
    axes.set_title(table.title(scene))
    note = f"Error: the largest of {worst}. Horizon: {scenes.module(scene).HORIZON}\nHollow: steps missed their tolerance. Zero is drawn at {FLOOR:g}."
    origin.finish(fig, path, note, [record for record in records if record["parameters"]["disks"] == records[0]["parameters"]["disks"]], 0.1)


def _draw_series(axes, series, rows):
    """One line; the ends of it say their setting."""
    if not rows:
        return
    seconds, errors = [row["seconds"] for row in rows], [max(row["error"], FLOOR) for row in rows]
    kind = look.of(series)
    joined = {} if series not in choice.NO_LADDER else {"linestyle": "none"}
    axes.plot(seconds, errors, label=series, linewidth=1, alpha=0.9, fillstyle="full", **(kind | joined))
    for row, x, y in zip(rows, seconds, errors):
        axes.plot([row["fastest"], row["slowest"]], [y, y], color=kind["color"], linewidth=0.6, alpha=0.6)
        if row["unconverged_steps"]:
            axes.plot(x, y, marker=kind["marker"], color=kind["color"], markerfacecolor="white", markersize=5)
    for k in sorted({0, len(rows) - 1}):
        axes.annotate(rows[k]["setting"].split("=")[1], (seconds[k], errors[k]), textcoords="offset points", xytext=(4, 4), fontsize=6.5, color=kind["color"])


def _draw_failures(axes, rows):
    """A cross above the chart for each failed setting, where the series would go on."""
    failed = [row for row in rows if row["status"]]
    if not failed:
        return
    slowest = max((row["seconds"] for row in rows if row["seconds"]), default=1.0)
    for number, (series, own) in enumerate(table.by_series(failed).items()):
        places = slowest * 2 * np.geomspace(1, 2, len(own))
        axes.plot(places, [1 - 0.035 * number] * len(own), "x", color=look.of(series)["color"], transform=axes.get_xaxis_transform(), clip_on=False)
        reasons = sorted({row["status"].removeprefix("failed: ").split(":")[0] for row in own})
        axes.annotate(f"{series}, {len(own)} failed: {'; '.join(reasons)}"[:70], (places[0], 1 - 0.035 * number), xycoords=axes.get_xaxis_transform(), fontsize=6,
                      xytext=(-6, 0), textcoords="offset points", ha="right", va="center", color=look.of(series)["color"])


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
