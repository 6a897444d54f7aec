"""Time of computing against the number of disks, at a fixed accuracy, for both methods."""

from pathlib import Path

import numpy as np

from analysis import load
from analysis import publish as tables
from analysis.charts import choice, look, origin, table
from analysis.style import plt

TITLE = "Cost against the number of disks"
QUESTION = "How does the time to a given accuracy grow with the number of disks, by each method?"
LEVEL = 1e-2


def publish(results, folder, full):
    """The table of the cheapest settings, and the figure."""
    rows, records = table.from_records(results, full)
    rows = [row for row in rows if row["size"]]
    if not rows:
        raise load.ResultError(results, "no scene was measured at several sizes", "measure them: make charts")
    found, scenes = costs(rows), {row["scene"] for row in rows}
    used = [record for record in records.values() if record["scene"] in scenes and "disks" in record["row"]]
    Path(folder).mkdir(parents=True, exist_ok=True)
    tables.write_csv(Path(folder) / "cost_against_size.csv", found)
    draw(found, used, Path(folder) / "cost_against_size.png")
    origin.write("cost_against_size", folder,
                 {"title": TITLE, "question": QUESTION, "answer": answer(found), "figures": [{"file": "cost_against_size.png", "title": TITLE}]}, used, full)


def costs(rows):
    """One row a scene, series and size: the cheapest setting that reaches LEVEL."""
    found = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        for size in sorted({row["size"] for row in rows if row["scene"] == scene}):
            own = [row for row in rows if (row["scene"], row["size"]) == (scene, size)]
            for series, members in table.by_series(own).items():
                best = choice.cheapest(members, LEVEL)
                found.append({"status": "" if best else _reason(members), "scene": scene, "series": series, "accuracy": LEVEL, "disks": size}
                             | {name: best[name] if best else None for name in ("setting", "error", "seconds", "steps", "sweeps")})
    return found


def _reason(members):
    """Why no setting of a series reaches the accuracy."""
    errors = [row["error"] for row in members if not row["status"]]
    return f"smallest error {min(errors):.2g}" if errors else members[0]["status"]


def power(found):
    """Exponent of the time in the number of disks, fitted over the larger half of the sizes; NaN of fewer than two."""
    points = sorted((row["disks"], row["seconds"]) for row in found if row["seconds"])
    points = points[len(points) // 2 - 1:] if len(points) > 3 else points
    return float(np.polyfit(*np.log(points).T, 1)[0]) if len(points) > 1 else float("nan")


def draw(found, records, path):
    """A panel a scene; sizes that a series does not solve are crosses at the top."""
    scenes = list(dict.fromkeys(row["scene"] for row in found))
    fig, panels = plt.subplots(1, len(scenes), figsize=(1 + 3.6 * len(scenes), 4.6), squeeze=False)
    for axes, scene in zip(panels[0], scenes):
        for number, series in enumerate(dict.fromkeys(row["series"] for row in found)):
            own = [row for row in found if (row["scene"], row["series"]) == (scene, series)]
            solved = [row for row in own if row["seconds"]]
            kind = look.of(series)
            axes.loglog([row["disks"] for row in solved], [row["seconds"] for row in solved], label=f"{series}, N^{power(own):.2g}" if len(solved) > 1 else series, **kind)
            missed = [row["disks"] for row in own if not row["seconds"]]
            if missed:
                axes.plot(missed, [1 - 0.03 * number] * len(missed), "x", color=kind["color"], transform=axes.get_xaxis_transform(), clip_on=False)
        axes.set(xlabel="disks", title=table.title(scene))
        axes.grid(alpha=0.25, linewidth=0.5)
        axes.legend(loc="lower right")
    panels[0][0].set_ylabel("time of computing [s]")
    origin.finish(fig, path, f"Cheapest setting of each series within an error of {LEVEL:g}; crosses: none is.", records)


def answer(found):
    """The exponents."""
    said = []
    for scene in dict.fromkeys(row["scene"] for row in found):
        parts = []
        for series in dict.fromkeys(row["series"] for row in found):
            own = [row for row in found if (row["scene"], row["series"]) == (scene, series)]
            solved = [row for row in own if row["seconds"]]
            if len(solved) > 1:
                parts.append(f"{series} {solved[-1]['seconds']:.2g} s at {solved[-1]['disks']} disks, as N^{power(own):.2g}")
            elif own:
                parts.append(f"{series} {'one size only' if solved else 'none (' + own[0]['status'] + ')'}")
        said.append(f"{scene}, to {LEVEL:g}: {'; '.join(parts)}.")
    return " ".join(said)
