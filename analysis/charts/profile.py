"""Performance profile of the series (Dolan and More, Mathematical Programming 91, 201-213, 2002): the share of scenes that a series solves to a given
accuracy within a factor of the fastest."""

import math
from pathlib import Path

import numpy as np

from analysis import load
from analysis import publish as tables
from analysis.charts import choice, look, origin, table
from analysis.style import plt

TITLE = "Speed against accuracy, over all scenes"
QUESTION = ("Which method, and which way of refining it, solves most scenes to a given accuracy, and how much slower than the fastest is it there? "
            "Only scenes that both methods can run count.")
BEST = {"MD": "MD, best of all", "CD": "CD, best of all"}


def publish(results, folder, full):
    """The factors as a table, and the figure."""
    rows, records = table.from_records(results, full)
    found = factors(table.one_size(rows))
    if not found:
        raise load.ResultError(results, "no scene was measured by both methods", "measure more: make charts")
    Path(folder).mkdir(parents=True, exist_ok=True)
    tables.write_csv(Path(folder) / "profile.csv", found)
    shared = {row["scene"] for row in found}
    used = [record for record in records.values() if record["scene"] in shared]
    draw(found, used, Path(folder) / "profile.png")
    origin.write("profile", folder, {"title": TITLE, "question": QUESTION, "answer": answer(found), "figures": [{"file": "profile.png", "title": TITLE}]}, used, full)


def factors(rows):
    """One row a scene, accuracy and series: its time over that of the fastest series; status tells where none of its settings comes so far."""
    found = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        own = [row for row in rows if row["scene"] == scene]
        if {row["method"] for row in own} != set(BEST):
            continue
        for level in table.LEVELS:
            found += _factors(scene, own, level)
    return found


def _factors(scene, rows, level):
    times = {series: choice.cheapest(own, level) for series, own in table.by_series(rows).items()}
    times |= {BEST[method]: choice.cheapest([row for row in rows if row["method"] == method], level) for method in BEST}
    fastest = min((row["seconds"] for row in times.values() if row), default=math.nan)
    return [{"status": "" if row else "does not reach the accuracy", "scene": scene, "accuracy": level, "series": series, "setting": row["setting"] if row else "",
             "seconds": row["seconds"] if row else None, "factor": row["seconds"] / fastest if row else None} for series, row in times.items()]


def share(found, series, level):
    """(factors in rising order, share of the scenes solved within each)."""
    own = [row for row in found if row["series"] == series and row["accuracy"] == level]
    solved = sorted(row["factor"] for row in own if row["factor"])
    return np.array(solved), np.arange(1, len(solved) + 1) / max(1, len({row["scene"] for row in found}))


def draw(found, records, path):
    """A panel an accuracy."""
    fig, panels = plt.subplots(1, len(table.LEVELS), figsize=(11, 4.6), sharey=True)
    last = 2 * max((row["factor"] for row in found if row["factor"]), default=10)
    for axes, level in zip(panels, table.LEVELS):
        for series in dict.fromkeys(row["series"] for row in found):
            x, y = share(found, series, level)
            if not len(x):
                continue
            best = series in BEST.values()
            kind = {"color": look.ENVELOPE[series[:2]], "linestyle": "-" if series[:2] == "MD" else "--"} if best else look.of(series)
            axes.step(np.append(x, last), np.append(y, y[-1]), where="post", label=series, linewidth=2.4 if best else 0.9,
                      **{name: value for name, value in kind.items() if name != "markersize"}, markersize=4)
        axes.set(xscale="log", xlabel="time over the fastest's", title=f"to an error of {level:g}", ylim=(0, 1.03), xlim=(0.8, last))
        axes.grid(alpha=0.25, linewidth=0.5)
    panels[0].set_ylabel("share of scenes solved")
    handles = {label: handle for axes in panels for handle, label in zip(*axes.get_legend_handles_labels())}
    panels[-1].legend(handles.values(), handles.keys(), loc="center left", bbox_to_anchor=(1.0, 0.5))
    scenes = sorted({row["scene"] for row in found})
    half = len(scenes) // 2 + 1
    origin.finish(fig, path, f"{len(scenes)} scenes: {', '.join(scenes[:half])},\n{', '.join(scenes[half:])}", records)


def answer(found):
    """For each accuracy how many scenes each method solves, where it is faster, and by how much."""
    scenes, said = len({row["scene"] for row in found}), []
    for level in table.LEVELS:
        own = {method: {row["scene"]: row["factor"] for row in found if row["series"] == BEST[method] and row["accuracy"] == level and row["factor"]} for method in BEST}
        both = own["MD"].keys() & own["CD"].keys()
        ahead = sum(own["CD"][scene] <= own["MD"][scene] for scene in both)
        ratio = np.median([own["MD"][scene] / own["CD"][scene] for scene in both]) if both else math.nan
        middle = f"; where both do, CD is the faster in {ahead} of {len(both)}, MD's time over CD's is {ratio:.2g} (median)" if both else ""
        said.append(f"To {level:g} MD solves {len(own['MD'])} and CD {len(own['CD'])} of {scenes} scenes{middle}.")
    return " ".join(said)
