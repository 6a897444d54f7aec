"""The figure of a stability map: a marker a cell, its shape the verdict and its colour the reason; boundaries and theory as lines."""

import math
import textwrap
from pathlib import Path

from analysis.style import plt
from yade_scripts.maps import INACCURATE, NOT_SOLVED, STABLE, UNSTABLE

MARKERS = {STABLE: ".", INACCURATE: "^", UNSTABLE: "X", NOT_SOLVED: "s"}
# Okabe and Ito's palette and three more that differ from it in lightness.
COLOURS = {"": "#9A9A9A", "energy growth": "#D55E00", "penetration": "#CC79A7", "wrong motion": "#56B4E9", "false motion": "#E69F00", "false rest": "#6A3D9A",
           "wrong forces": "#0072B2", "tunnelled": "#8B0000", "locked walls": "#D55E00", "load missed": "#009E73", "non-convergence": "#555555",
           "refused": "#B8A200", "crashed": "#000000", "timed out": "#000000"}
HEIGHT = 4.7  # in, of one line of panels
MOST_COLUMNS = 3
LINES = ("-", "-.", (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)))


def draw(found, theory, path, commit):
    """Write the figure; theory(found, search, row) gives the boundary expected of a search."""
    chart = found.map
    panels = list(dict.fromkeys(row[chart.panels] for row in found.rows)) if chart.panels else [None]
    columns = min(len(panels), MOST_COLUMNS)
    lines = -(-len(panels) // columns)
    width, height = 3.0 + 3.3 * columns, HEIGHT + 3.3 * (lines - 1)
    fig = plt.figure(figsize=(width, height))
    grid = fig.add_gridspec(lines, columns + 1, width_ratios=[3.3] * columns + [1.9])
    axes = []
    for number in range(len(panels)):
        axes.append(fig.add_subplot(grid[divmod(number, columns)], sharex=axes[0] if axes else None, sharey=axes[0] if axes else None))
    for axis, panel in zip(axes, panels):
        _cells(axis, found, panel)
        _boundaries(axis, found, panel, theory)
        for words, value in chart.marks.items():
            axis.axvline(value, color="k", lw=0.6, ls=":")
            axis.text(value, 1.0, f" {words}", transform=axis.get_xaxis_transform(), fontsize=6, rotation=90, va="top", ha="right",
                      bbox={"boxstyle": "square,pad=0", "fc": "w", "ec": "none", "alpha": 0.7})
        axis.set(xlabel=chart.x.label, title="" if panel is None else f"{_title(chart.panels)} = {panel if isinstance(panel, str) else f'{panel:g}'}")
        _scale(axis, found)
        axis.tick_params(labelleft=len(axes) == 1 or axis in axes[::columns])
    for axis in axes[::columns]:
        axis.set_ylabel(chart.y.label)
    _legend(fig.add_subplot(grid[0, columns]), axes)
    note = textwrap.fill(chart.criterion, int(15.5 * width))
    line = f"{len(found.rows)} cells, {len(found.boundaries)} searches" + (f", {len(found.missing)} not run" if found.missing else "") + f", commit {commit}"
    foot = (0.2 + 0.145 * (note.count("\n") + 2)) / height
    fig.suptitle(chart.title, fontsize=11)
    fig.set_layout_engine("constrained", rect=(0, foot, 1, 1 - foot))
    fig.text(0.5, 0.012, f"{note}\n{line}", ha="center", va="bottom", fontsize=7.5, linespacing=1.4)
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    fig.savefig(path, dpi=min(plt.rcParams["savefig.dpi"], 2000 / width), metadata={"Description": line})
    plt.close(fig)


def _title(name):
    return {"kt_over_kn": r"$k_t/k_n$", "beta_n": r"$\beta_n$"}.get(name, name)


def _scale(axis, found):
    """Logarithmic where the values are positive and span more than a decade."""
    for name, scale in ((found.map.x.name, axis.set_xscale), (found.map.y.name, axis.set_yscale)):
        values = [row[name] for row in found.rows]
        if min(values) > 0 and max(values) > 10 * min(values):
            scale("log")


def _cells(axis, found, panel):
    """The markers; a ring around a failure that the program says nothing of."""
    chart, kinds = found.map, {}
    for row in found.rows:
        if panel is None or row[chart.panels] == panel:
            kinds.setdefault((row["verdict"], row["reason"]), []).append(row)
    for (verdict, reason), rows in sorted(kinds.items(), key=lambda item: list(MARKERS).index(item[0][0])):
        axis.plot([row[chart.x.name] for row in rows], [row[chart.y.name] for row in rows], MARKERS[verdict], color=COLOURS[reason], ls="",
                  ms=5 if verdict == STABLE else 6.5, mew=0, label=verdict + (f": {reason}" if reason else ""))
    silent = [row for rows in kinds.values() for row in rows if row["verdict"] != STABLE and not row["told"]]
    if silent:
        axis.plot([row[chart.x.name] for row in silent], [row[chart.y.name] for row in silent], "o", mfc="none", mec="k", mew=0.7, ms=11, ls="",
                  label="the program says nothing")


def _boundaries(axis, found, panel, theory):
    """What was searched, full lines; what theory says, dashed."""
    chart, groups = found.map, {}
    fixed = {chart.x.name, chart.y.name, chart.panels}
    for line, boundary, row in found.boundaries:
        if panel is not None and line.at.get(chart.panels) != panel:
            continue
        other = tuple(value for name, value in line.at.items() if name not in fixed)
        groups.setdefault((line.accepted, line.along, other), []).append((line, boundary, row))
    drawn_theory = set()
    first = next((key[2] for key in groups), ())
    for number, ((accepted, along, other), several) in enumerate(groups.items()):
        across = chart.y.name if along == chart.x.name else chart.x.name
        points = [(boundary.value, line.at[across]) for line, boundary, _ in several if not boundary.note]
        words = "instability, searched" if INACCURATE in accepted else "first failure, searched"
        words += "" if other == first else f" ({', '.join(map(str, other))})"
        if points:
            axis.plot(*_ordered(points, along == chart.x.name), color="k", lw=1.1, ls=LINES[number % len(LINES)], marker="+x1234"[number % 6], ms=6, label=words)
        expected = [(value, line.at[across]) for line, _, row in several if row is not None and math.isfinite(value := theory(found, line, row))]
        if expected and along not in drawn_theory:
            drawn_theory.add(along)
            axis.plot(*_ordered(expected, along == chart.x.name), color="#009E73", lw=3, alpha=0.5, ls="--", marker="_" if len(expected) == 1 else "", ms=14, label=f"theory: {chart.theory_label}")


def _ordered(points, along_x):
    points = sorted(points, key=lambda point: point[1])
    return ([a for a, _ in points], [b for _, b in points]) if along_x else ([b for _, b in points], [a for a, _ in points])


def _legend(aside, axes):
    """One legend of all panels, each entry once, beside them."""
    handles = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels()):
            handles.setdefault(label, handle)
    # Cells by verdict first, then the lines.
    places = {label: next((k for k, verdict in enumerate(MARKERS) if label.split(":")[0] == verdict), len(MARKERS)) for label in handles}
    handles = {label: handles[label] for label in sorted(handles, key=places.get)}
    aside.axis("off")
    aside.legend(handles.values(), handles.keys(), loc="upper left", borderaxespad=0, fontsize=7.5)
