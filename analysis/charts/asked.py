"""What comes of asking CD for an accuracy (yade_scripts/accuracy.py): the error reached against the one asked for, and what the search costs."""

import statistics
from pathlib import Path

from analysis import load
from analysis import publish as tables
from analysis.charts import choice, look, origin, table
from analysis.style import plt
from yade_scripts import scenes

TITLE = "Asking CD for an accuracy"
QUESTION = ("Can a user ask for an accuracy instead of a time step and a tolerance? Both are refined until the answer stands still; held against what is known "
            "exactly, is the accuracy reached, and what does the search cost beside the cheapest setting that reaches it?")
SERIES = "CD accuracy"
FLOOR = 1e-16


def publish(results, folder, full):
    """The table of all searches, and the figure."""
    rows, records = table.from_records(results, full)
    found = searches(table.one_size(rows))
    if not found:
        raise load.ResultError(results, "no accuracy was asked for", "measure it: make charts")
    used = [records[row["name"]] for row in rows if row["series"] == SERIES]
    Path(folder).mkdir(parents=True, exist_ok=True)
    tables.write_csv(Path(folder) / "asked.csv", found)
    draw(found, used, Path(folder) / "asked.png")
    origin.write("asked", folder, {"title": TITLE, "question": QUESTION, "answer": answer(found), "figures": [{"file": "asked.png", "title": TITLE}]}, used, full)


def searches(rows):
    """One row a scene and accuracy asked for: what was reached, and its time over that of the cheapest other setting of CD that reaches the accuracy."""
    found = []
    for row in rows:
        if row["series"] != SERIES:
            continue
        asked = float(row["setting"].split("=")[1])
        others = [other for other in rows if other["scene"] == row["scene"] and other["method"] == "CD" and other["series"] != SERIES]
        best = choice.cheapest(others, asked)
        found.append({"status": row["status"], "scene": row["scene"], "asked": asked, "reached": row["error"], "seconds": row["seconds"],
                      "cheapest": best["seconds"] if best else None, "cheapest_setting": best["setting"] if best else "",
                      "factor": row["seconds"] / best["seconds"] if best and row["seconds"] else None})
    return found


def draw(found, records, path):
    """Left the errors, right the costs; a marker a scene."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.8))
    for number, scene in enumerate(dict.fromkeys(row["scene"] for row in found)):
        own = [row for row in found if row["scene"] == scene and not row["status"]]
        kind = {"color": look.colour(number), "marker": look.MARKERS[number % len(look.MARKERS)], "linewidth": 0.8, "markersize": 5}
        left.loglog([row["asked"] for row in own], [max(row["reached"], FLOOR) for row in own], label=scenes.module(scene).TITLE, **kind)
        right.loglog([row["asked"] for row in own if row["factor"]], [row["factor"] for row in own if row["factor"]], **kind)
    span = [min(row["asked"] for row in found), max(row["asked"] for row in found)]
    left.plot(span, span, color="black", linewidth=1.5, label="as asked")
    lost = [row["asked"] for row in found if row["status"]]
    if lost:
        left.plot(lost, [1.02] * len(lost), "x", color="black", transform=left.get_xaxis_transform(), clip_on=False, label=f"not reached, and said so ({len(lost)})")
    left.set(xlabel="accuracy asked for", ylabel="error reached")
    right.set(xlabel="accuracy asked for", ylabel="time over that of the cheapest setting")
    for axes in (left, right):
        axes.grid(alpha=0.25, linewidth=0.5)
    right.legend(*left.get_legend_handles_labels(), loc="center left", bbox_to_anchor=(1.0, 0.5))
    origin.finish(fig, path, f"Below the line: more accurate than asked for. Zero is drawn at {FLOOR:g}.", records)


def answer(found):
    """How often it was reached, how often it was refused, and the cost."""
    ended = [row for row in found if not row["status"]]
    kept = [row for row in ended if row["reached"] <= row["asked"]]
    factors = [row["factor"] for row in ended if row["factor"]]
    said = f"In {len(kept)} of {len(ended)} searches that ended the error is within the accuracy asked for"
    worse = [f"{row['scene']} asked for {row['asked']:g} ({row['reached']:.2g})" for row in ended if row not in kept]
    said += f"; not in {', '.join(worse)}." if worse else "."
    if len(found) > len(ended):
        said += f" {len(found) - len(ended)} searches came to no end in their time or their steps, and said so."
    return said + (f" A search takes {statistics.median(factors):.2g} times as long as the cheapest setting known to do (median; {min(factors):.2g} to "
                   f"{max(factors):.2g})." if factors else "")
