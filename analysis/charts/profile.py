"""Performance profile (Dolan and More, Mathematical Programming 91, 201-213, 2002): the share of scenes that a series of settings solves to a given
accuracy, within a given factor of the fastest series."""
import numpy as np
import pandas

from analysis import charts, style
from analysis.charts import choice, table
from analysis.style import plt

TITLE = "Speed against accuracy, over all scenes"
LACKING = "no scene was measured by both methods"
QUESTION = "Which method, and which way of refining it, solves most scenes that both can run, and how much slower than the fastest is it?"
BEST = {"MD": "MD, best of all", "CD": "CD, best of all", table.SPRINGS: "springs in CD, best of all"}
BOTH = {"MD", "CD"}
# Seven curves at most: the best of each method, and what people refine first.
SHOWN = {BEST["MD"]: (style.COLOUR["MD"], "-", 2.4), "MD step": (style.SKY, "-", 1), "MD stiffness": (style.GREEN, "-", 1),
         BEST["CD"]: (style.COLOUR["CD"], "--", 2.4), "CD step": (style.ORANGE, "--", 1), "CD nsgs": (style.PINK, "--", 1),
         BEST[table.SPRINGS]: (style.PURPLE, ":", 2.4)}


def quantities(table):
    solved = table[table.seconds.notna()].astype({"factor": float}).set_index(["series", "accuracy", "scene"]).factor.sort_index()
    md, cd = ({level: solved[BEST[method], level] for level in (1e-2, 1e-4, 1e-6)} for method in ("MD", "CD"))
    faster = {level: (md[level] / cd[level]).dropna() for level in md}
    assert all(len(each) == len(md[level]) for level, each in faster.items())
    return {"md": md, "cd": cd, "faster": faster}


def rows(measured):
    """Return one row for each scene, accuracy and series: its time over that of the fastest series, or in `status` that no setting is so accurate."""
    found = []
    for scene, own in table.one_size(measured).groupby("scene", sort=False):
        if BOTH <= set(own.method):
            several = table.by_series(own) + [(BEST[method], of_method) for method, of_method in own.groupby("method", sort=False)]
            for level in table.LEVELS:
                for series, settings in several:
                    best = choice.cheapest(settings, level)
                    status = "does not reach the accuracy" if best is None else ""
                    found.append({"status": status, "scene": scene, "accuracy": level, "series": series} | choice.fields(best, "setting", "seconds"))
    if not found:
        return []
    found = pandas.DataFrame(found).astype({"seconds": float})
    return found.assign(factor=found.seconds / found.groupby(["scene", "accuracy"]).seconds.transform("min"))


def share(found, series, level):
    """Return (rising factors on the fastest time, share of the scenes solved within each)."""
    solved = found.factor[(found.series == series) & (found.accuracy == level)].dropna().sort_values()
    return solved.to_numpy(), np.arange(1, len(solved) + 1) / found.scene.nunique()


def draw(rows, folder, line):
    fig, panels = plt.subplots(1, len(table.LEVELS), figsize=(9.4, 3.4), sharey=True)
    last = 2 * rows.factor.max() if rows.factor.notna().any() else 20
    for axes, level in zip(panels, table.LEVELS):
        for series, (colour, dashes, width) in SHOWN.items():
            x, y = share(rows, series, level)
            if len(x):
                axes.step(np.append(x, last), np.append(y, y[-1]), where="post", label=series, linewidth=width, color=colour, linestyle=dashes)
        axes.set(xscale="log", xlabel="time over that of the fastest series", title=f"to an error of {level:g}", ylim=(0, 1.03), xlim=(0.8, last))
        axes.grid(True)
    panels[0].set_ylabel("share of scenes solved")
    handles = charts.entries(panels)
    panels[-1].legend(handles.values(), handles.keys(), loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7)
    style.finish(fig, folder / "profile.png",
                 f"Scenes that both methods run: {rows.scene.nunique()}. Higher and further left is better.", line)
    return {"profile.png": TITLE}
