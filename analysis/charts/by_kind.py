"""Time to an accuracy, by kind of scene: MD against CD. What to use when, in one picture."""
import math

import pandas

from analysis import style
from analysis.charts import choice, table
from analysis.charts.table import SPRINGS
from analysis.style import plt

TITLE = "What to use when: time against accuracy, by kind of scene"
QUESTION = "Which method reaches a given accuracy sooner? Errors are relative to rigid grains; of several in a scene the largest."
LEVELS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6)


def quantities(table):
    reached = table[(table.accuracy == 1e-2) & table.seconds.notna() & table.kind.isin(["piles at rest", "impacts", "sliding and rolling"])]
    md, cd = (reached[reached.method == method].set_index("kind").seconds for method in ("MD", "CD"))
    soft = table[(table.method == SPRINGS) & (table.accuracy == 1e-2)].set_index("kind")
    return {"faster": md / cd, "soft": soft}


def rows(measured):
    """Return one row for each kind, method and accuracy: how many scenes it solves, and the geometric mean of their cheapest settings' times [s]."""
    found = []
    for (kind, method), own in table.one_size(measured).groupby(["kind", "method"], sort=False):
        scenes = own.groupby("scene", sort=False)
        for level in LEVELS:
            best = [choice.cheapest(several, level) for _, several in scenes]
            solved = [row.seconds for row in best if row is not None]
            found.append({"kind": kind, "method": method, "accuracy": level, "scenes": len(scenes), "solved": len(solved),
                          "seconds": math.exp(sum(map(math.log, solved)) / len(solved)) if solved else None})
    return pandas.DataFrame(found)


def draw(rows, folder, line):
    """Draw a panel for each kind; hollow where some of its scenes are not solved."""
    kinds = rows.groupby("kind", sort=False)
    lines = min(2, len(kinds))
    fig, panels = plt.subplots(lines, math.ceil(len(kinds) / lines), figsize=(9.6, 2.9 * lines), sharex=True, sharey=True, squeeze=False)
    for axes, (kind, of_kind) in zip(panels.flat, kinds):
        for method, colour in table.COLOUR.items():
            own = of_kind[(of_kind.method == method) & of_kind.seconds.notna()]
            whole = own[own.solved == own.scenes]
            axes.loglog(whole.accuracy, whole.seconds, color=colour, marker=table.MARKER[method], label=table.WORDS[method])
            for row in own[own.solved < own.scenes].itertuples():
                axes.plot(row.accuracy, row.seconds, table.MARKER[method], color=colour, markerfacecolor="white")
                axes.annotate(f"{row.solved}/{row.scenes}", (row.accuracy, row.seconds), (6, 0), textcoords="offset points",
                              fontsize=6.5, va="center")
        count = of_kind.scenes.max()
        axes.set_title(f"{kind}\n({count} scene{'s' if count > 1 else ''})")
        axes.grid(True)
        axes.tick_params(labelbottom=True)
    for axes, above in zip(panels.flat[len(kinds):], panels[0, len(kinds) - panels.shape[1]:]):
        axes.remove()
        above.set_xlabel("error allowed")  # the lowest panel of its column now
    plt.setp(panels[-1], xlabel="error allowed")
    plt.setp(panels[:, 0], ylabel="time of computing [s]")
    panels[0, 0].invert_xaxis()
    if len(kinds) < panels.size:
        fig.legend(*panels[0, 0].get_legend_handles_labels(), loc="center", bbox_to_anchor=(0.87, 0.32))
    else:
        panels[0, 0].legend()
    style.finish(fig, folder / "by_kind.png",
                 "Time of the cheapest setting that reaches the error: geometric mean over the scenes of a kind. Hollow, 5/6: this error is "
                 "reached in 5 of 6 scenes only, whose mean is drawn.", line)
    return {"by_kind.png": TITLE}
