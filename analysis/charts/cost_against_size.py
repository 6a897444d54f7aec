"""Time of computing against the number of disks, at a fixed accuracy, for both methods."""
import numpy as np
import pandas

from analysis import style
from analysis.charts import choice, table
from analysis.style import plt
from yade_scripts import scenes

TITLE = "Cost against the number of disks"
LACKING = "no scene was measured at several sizes"
QUESTION = "How does the time to an error of 1e-2 grow with the number of disks, by each method?"
LEVEL = 1e-2
LOOK = {"MD step": (style.COLOUR["MD"], "o"), "CD accelerated": (style.COLOUR["CD"], "s"), "CD nsgs": (style.PINK, "^")}


def quantities(table):
    return {"seconds": table.set_index(["scene", "series", "disks"]).seconds.astype(float)}


def rows(measured):
    """Return one row for each scene, series and size: the cheapest setting that reaches LEVEL."""
    found = []
    for (scene, size), own in measured[measured["size"] > 0].groupby(["scene", "size"]):
        for series, members in table.by_series(own):
            best, finished = choice.cheapest(members, LEVEL), members[members.status == ""]
            why = f"smallest error {finished.error.min():.2g}" if len(finished) else members.status.iloc[0]
            found.append({"status": why if best is None else "", "scene": scene, "series": series, "accuracy": LEVEL, "disks": size}
                         | choice.fields(best, "setting", "error", "seconds", "steps", "sweeps"))
    return pandas.DataFrame(found)


def power(found):
    """Return the exponent of the time in the number of disks, fitted over the larger half of the sizes; NaN of fewer than two."""
    points = found.dropna(subset=["seconds"]).sort_values("disks")[["disks", "seconds"]].to_numpy()
    points = points[len(points) // 2 - 1:] if len(points) > 3 else points
    return float(np.polyfit(*np.log(points).T, 1)[0]) if len(points) > 1 else float("nan")


def draw(rows, folder, line):
    of_scenes = rows.groupby("scene", sort=False)
    fig, panels = plt.subplots(1, len(of_scenes), figsize=(1 + 2.7 * len(of_scenes), 3.6), squeeze=False)
    for axes, (scene, own) in zip(panels[0], of_scenes):
        for series, (colour, marker) in LOOK.items():
            if len(solved := own[(own.series == series) & own.seconds.notna()]):
                axes.loglog(solved.disks, solved.seconds, color=colour, marker=marker, markersize=4,
                            label=f"{series}, $N^{{{power(solved):.2g}}}$")
        axes.set_title(scenes.module(scene).TITLE, fontsize=9)
        axes.set_xlabel("disks $N$")
        axes.grid(True)
        axes.legend(loc="best", fontsize=7)
    panels[0][0].set_ylabel("time of computing [s]")
    style.finish(fig, folder / "cost_against_size.png", f"Cheapest setting of each series within an error of {LEVEL:g}.", line)
    return {"cost_against_size.png": TITLE}
