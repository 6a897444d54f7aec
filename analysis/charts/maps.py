"""Stability maps: turns the results of the probes into rows, boundaries and figures. Runs nothing."""
import math
from collections import namedtuple
from pathlib import Path

import pandas

from analysis import charts, publish, style, summary
from analysis.style import plt
from yade_scripts.measuring import maps
from yade_scripts.measuring.maps import INACCURATE, NOT_SOLVED, STABLE, UNSTABLE
from yade_scripts.errors import ResultError

TITLE = "Where each method fails"
LACKING = "no boundary was searched to its end"
QUESTION = "Up to which steps, sweeps, tolerances, masses and speeds does each method work, and does the program warn beyond?"


def quantities(table):
    found = table[table.theory.notna()]
    off = (found.boundary.astype(float) / found.theory - 1).abs()
    at = {name: own.set_index("at").boundary for name, own in table.groupby("map")}
    steps, friction = (at[name][~at[name].str.startswith("none")].astype(float) for name in ("cd_time_step", "cd_friction"))
    tolerances = friction.index.str.extract("tolerance=(.*)")[0].astype(float).to_numpy()
    assert all(boundary.startswith("none") == (where.split()[1] == "restitution=0.0") for where, boundary in at["cd_time_step"].items())
    return {"contact": off[(found["map"] == "md_contact") & (found["from"] == "instability")], "packing": off[found["map"] == "md_packing"],
            "steps": steps, "friction": friction / tolerances, "at": at}


MARKERS = {STABLE: ".", INACCURATE: "^", UNSTABLE: "X", NOT_SOLVED: "s"}
COLOURS = {"": style.GREY["9A"], "energy growth": style.VERMILION, "penetration": style.PINK, "wrong motion": style.SKY, "false motion": style.ORANGE,
           "false rest": style.PURPLE, "wrong forces": style.BLUE, "tunnelled": style.DARK_RED, "locked walls": style.VERMILION,
           "load missed": style.GREEN, "non-convergence": style.GREY["55"], "refused": style.OLIVE, "crashed": style.BLACK, "timed out": style.BLACK}
SYMBOLS = {"kt_over_kn": r"$k_t/k_n$", "beta_n": r"$\beta_n$", "stiffening": r"$k_n$ over the usual"}
HEIGHT = 4.7  # in, of one line of panels
MOST_COLUMNS = 3
LINES = ("-", "-.", (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)))

# A map with its results: table of the cells, cases that were not run, the Lines searched, facts of all.
Found = namedtuple("Found", "name map rows missing lines facts")
# A maps.Search, the maps.Boundary found, whether a case beyond it is good again, what the program said beyond it, and the boundary by theory, NaN
# where there is none.
Line = namedtuple("Line", "search boundary beyond told theory")


def measured(results, full, broken=None):
    """Return (Found of every map that was probed, where they come from). Raise ResultError if none was. broken: as of declared.readable."""
    several = [found for found in (collect(name, results, full) for name in maps.names(broken)) if len(found.rows)]
    if not several:
        raise ResultError(Path(results) / maps.FOLDER, "no case has been probed", "run `make charts`")
    return several, charts.origin_of([one for found in several for one in found.facts], full)


def collect(name, results, full):
    chart, work = maps.get(name), maps.Work(name, full, results)
    stored = [(case, work.find(case)) for case in chart.grid(full)]
    missing = [case for case, kept in stored if kept is None]
    facts = {maps.store.name_of(kept): kept for _, kept in stored if kept is not None}
    cells = [case | {name: kept[name] for name in ("verdict", "reason", "told")}
             | {name: kept["measures"].get(name, math.nan) for name in chart.measures} for case, kept in stored if kept is not None]

    def outcome(case):
        if (kept := work.find(case)) is None:
            raise LookupError(case)
        facts[maps.store.name_of(kept)] = kept
        return maps.outcome(kept)

    searched, lines = [], []
    for search in chart.searches(full):
        try:
            maps.bisect(search, outcome)
            searched.append(search)
        except LookupError:
            missing.append(search.at | {search.along: "searched"})
    for search in searched:
        on_line = {value: maps.outcome(kept) for kept in facts.values() if (value := maps.on_line(search, kept["case"])) is not None}
        boundary, beyond = first_failure(search, on_line)
        bad = maps.outcome(work.find(search.case(boundary.bad)))
        theory = chart.theory(search.at) if chart.theory else bad.measures.get("theory", math.nan)
        lines.append(Line(search, boundary, beyond, bad.told, theory if chart.theory_along == search.along else math.nan))
    return Found(name, chart, pandas.DataFrame(cells), missing, lines, list(facts.values()))


def first_failure(search, outcomes):
    """Return (the Boundary along a Search where cases first fail, whether a case beyond it is good again). outcomes: {value along it: outcome}.

    The bisection ends at one crossing; where failures and good cases alternate, a cell of the grid may fail before it.
    """
    inside = [value for value in outcomes if min(search.good, search.bad) <= value <= max(search.good, search.bad)]
    inside.sort(reverse=search.good > search.bad)
    fails = [outcomes[value].verdict not in search.accepted for value in inside]
    if not any(fails):
        return maps.Boundary(search.good, search.bad, "", f"none up to {search.bad:g}"), False
    first = fails.index(True)
    reason = outcomes[inside[first]].reason
    note = "" if first else f"{reason} already at {search.good:g}"
    return maps.Boundary(inside[max(0, first - 1)], inside[first], reason, note), not all(fails[first:])


def rows(several):
    """Return the table of boundaries, one row for each search."""
    words = lambda case: " ".join(f"{name}={value}" for name, value in case.items())
    table = []
    for found in several:
        table += [{publish.STATUS: "", "map": found.name, "at": words(search.at), "along": search.along,
                   "from": "instability" if len(search.accepted) > 1 else "first failure", "boundary": boundary.note or boundary.value,
                   "good": boundary.good, "bad": boundary.bad, "good again beyond": "yes" if beyond else "", "reason": boundary.reason,
                   "theory": theory, "told": told if boundary.reason else ""} for search, boundary, beyond, told, theory in found.lines]
        table += [{publish.STATUS: "not run yet", "map": found.name, "at": words(case)} for case in found.missing]
        if not found.lines and not found.missing:
            table.append({publish.STATUS: "no boundary is searched", "map": found.name})
    return table


def draw(several, folder, line):
    """Draw a figure and write a table of the cells for each map. Return {file name: title} of the figures."""
    for found in several:
        publish.write_table(folder / f"map_{found.name}.csv", found.rows)
        _draw(found, folder / f"map_{found.name}.png", line)
    return {f"map_{found.name}.png": found.map.title for found in several}


def _draw(found, path, line):
    chart = found.map
    panels = list(found.rows[chart.panels].unique()) if chart.panels else [None]
    columns = min(len(panels), MOST_COLUMNS)
    lines = -(-len(panels) // columns)
    fig = plt.figure(figsize=(3.0 + 3.3 * columns, HEIGHT + 3.3 * (lines - 1)))
    grid = fig.add_gridspec(lines, columns + 1, width_ratios=[3.3] * columns + [1.9])
    first = fig.add_subplot(grid[0, 0])
    axes = [first] + [fig.add_subplot(grid[divmod(number, columns)], sharex=first, sharey=first) for number in range(1, len(panels))]
    for axis, panel in zip(axes, panels):
        _cells(axis, chart, found.rows if panel is None else found.rows[found.rows[chart.panels] == panel])
        _boundaries(axis, chart, [line for line in found.lines if panel is None or line.search.at.get(chart.panels) == panel])
        for number, (words, value) in enumerate(chart.marks.items()):  # their words stand above the data, on either side of two lines
            axis.axvline(value, color="k", lw=0.6, ls=":", zorder=0)
            axis.text(value, 1.01, f" {words} ", transform=axis.get_xaxis_transform(), fontsize=6,
                      ha="center" if len(chart.marks) == 1 else "left" if number else "right")
        axis.set_xlabel(chart.x.label)
        if panel is not None:
            axis.set_title(f"{SYMBOLS.get(chart.panels, chart.panels)} = " + (panel if isinstance(panel, str) else f"{panel:g}"),
                           pad=14 if chart.marks else None)
        for name, scale in ((chart.x.name, axis.set_xscale), (chart.y.name, axis.set_yscale)):
            if found.rows[name].min() > 0 and found.rows[name].max() > 10 * found.rows[name].min():
                scale("log")
        axis.tick_params(labelleft=len(axes) == 1 or axis in axes[::columns])
    plt.setp(axes[::columns], ylabel=chart.y.label)
    _legend(fig.add_subplot(grid[0, columns]), axes)
    fig.suptitle(chart.title, fontsize=11)
    missing = f", {len(found.missing)} not run" if found.missing else ""
    style.finish(fig, path, f"{len(found.rows)} cells, {len(found.lines)} searched boundaries{missing}.", line)


def _cells(axis, chart, rows):
    """Draw the markers, with a ring around each failure of which the program does not warn."""
    kinds = rows.groupby(["verdict", "reason"], sort=False)
    for (verdict, reason), own in sorted(kinds, key=lambda kind: list(MARKERS).index(kind[0][0])):
        axis.plot(own[chart.x.name], own[chart.y.name], MARKERS[verdict], color=COLOURS[reason], ls="",
                  ms=5 if verdict == STABLE else 6.5, mew=0, label=verdict + (f": {reason}" if reason else ""))
    if len(silent := rows[(rows.verdict != STABLE) & (rows.told == "")]):
        axis.plot(silent[chart.x.name], silent[chart.y.name], "o", mfc="none", mec="k", mew=0.7, ms=11, ls="",
                  label="the program does not warn")


def _boundaries(axis, chart, lines):
    """Draw the searched boundaries as full lines and those of theory as dashed ones."""
    axes = chart.x.name, chart.y.name, chart.panels

    def kind(line):
        others = [(name, value) for name, value in line.search.at.items() if name not in axes]
        return line.search.accepted, line.search.along, ", ".join(value if isinstance(value, str) else f"{SYMBOLS.get(name, name)} = {value:g}"
                                                                  for name, value in others)

    def draw(points, along, **look):
        """Draw points (value along, value across) in the order of the latter."""
        values, across = zip(*sorted(points, key=lambda point: point[1]))
        axis.plot(*((values, across) if along == chart.x.name else (across, values)), **look)

    groups, drawn_theory = summary.groups(lines, kind, ordered=False), set()
    for number, ((accepted, along, other), own) in enumerate(groups.items()):
        across = chart.y.name if along == chart.x.name else chart.x.name
        words = "instability, searched" if INACCURATE in accepted else "first failure, searched"
        words += f" ({other})" if len({other for *_, other in groups}) > 1 else ""
        if points := [(line.boundary.value, line.search.at[across]) for line in own if not line.boundary.note]:
            draw(points, along, color="k", lw=1.1, ls=LINES[number % len(LINES)], marker="+x1234"[number % 6], ms=6, label=words)
        expected = [(line.theory, line.search.at[across]) for line in own if math.isfinite(line.theory)]
        if expected and along not in drawn_theory:
            drawn_theory.add(along)
            draw(expected, along, color=style.GREEN, lw=3, alpha=0.5, ls="--", marker="_" if len(expected) == 1 else "", ms=14,
                 label=f"theory: {chart.theory_label}")


def _legend(aside, axes):
    """Put one legend of all panels beside them: cells by verdict first, then the lines."""
    handles, verdicts = charts.entries(axes), [*MARKERS]
    labels = sorted(handles, key=lambda label: verdicts.index(verdict) if (verdict := label.split(":")[0]) in verdicts else len(verdicts))
    aside.axis("off")
    aside.legend([handles[label] for label in labels], labels, loc="upper left", borderaxespad=0, fontsize=7.5)
