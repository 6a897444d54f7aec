"""Stability maps: what the probes of yade_scripts/maps found, as rows, boundaries, words and files. Runs nothing."""

import json
import math
import platform
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

from analysis import publish as tables
from analysis import style
from analysis.charts import maps_draw
from analysis.load import ResultError
from yade_scripts import maps
from yade_scripts.maps import search, store

NOT_RUN = "not run yet"


@dataclass
class Found:
    """A map with what was probed of it.

    rows: of the cells of the grid, missing: cases without a row, boundaries: [(Search, search.Boundary, row of its bad side)].
    """

    name: str
    map: maps.Map
    rows: list
    missing: list
    boundaries: list
    commits: list


class _Missing(Exception):
    pass


def collect(name, results, full):
    """The Found of a map, of the quick or the full grid; ResultError where its file cannot be used."""
    chart = maps.get(name)
    try:
        kept = store.Store(name, Path(results) / "maps")
    except store.StoreError as error:
        raise ResultError(name, str(error), "then run `make charts` again") from None

    def outcome(case):
        row = kept.find(case)
        if row is None:
            raise _Missing
        return kept.outcome(case)

    cells = chart.grid(full)
    found = Found(name, chart, [row for case in cells if (row := kept.find(case))], [case for case in cells if not kept.find(case)], [],
                  sorted({row["commit"] for row in kept.rows}))
    for line in chart.searches(full):
        try:
            boundary = search.bisect(line, outcome)
        except _Missing:
            found.missing.append(line.at | {line.along: "searched"})
            continue
        found.boundaries.append((line, boundary, kept.find(line.case(boundary.bad))))
    return found


def theory(found, line, row):
    """Where theory puts the boundary of a search, NaN if it does not."""
    if found.map.theory_along != line.along:
        return math.nan
    if "theory" in found.map.measures:
        return row["theory"]
    return found.map.theory(line.at) if found.map.theory else math.nan


def boundary_rows(found):
    """The table of boundaries: one row a search."""
    rows = []
    for line, boundary, row in found.boundaries:
        at = " ".join(f"{name}={value if isinstance(value, str) else f'{value:g}'}" for name, value in line.at.items())
        rows.append({tables.STATUS: "", "map": found.name, "at": at, "along": line.along,
                     "from": "instability" if len(line.accepted) > 1 else "first failure",
                     "boundary": boundary.value if not boundary.note else boundary.note, "good": boundary.good, "bad": boundary.bad,
                     "reason": boundary.reason, "theory": theory(found, line, row), "told": (row["told"] if boundary.reason else "")})
    return rows + [{tables.STATUS: NOT_RUN, "map": found.name, "at": " ".join(f"{name}={value}" for name, value in case.items())}
                   for case in found.missing]


def answer(found):
    """What a map shows, by its rows; then what to do about it."""
    counts = {verdict: sum(row["verdict"] == verdict for row in found.rows) for verdict in maps.VERDICTS}
    text = f"{found.map.title}: of {len(found.rows)} cells " + ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    silent = [row for row in found.rows if row["verdict"] != maps.STABLE and not row["told"]]
    if silent:
        reasons = [row["reason"] for row in silent]
        text += "; without a word from the program " + ", ".join(f"{reasons.count(reason)} ({reason})" for reason in dict.fromkeys(reasons))
    errors = [abs(boundary.value / expected - 1) for line, boundary, row in found.boundaries
              if not boundary.note and _compared(found, line) and math.isfinite(expected := theory(found, line, row))]
    if errors:
        text += f"; the boundary is where theory puts it within {100 * max(errors):.1f} % ({len(errors)} searches)"
    return f"{text}. {found.map.remedy}"


def _compared(found, line):
    """Whether the theory is of this search: of instability, where there is one beside the first failure."""
    widest = max(len(other.accepted) for other, _, _ in found.boundaries if other.along == line.along)
    return len(line.accepted) == widest


def publish(name, title, question, names, results, folder, full):
    """Write the figures, the tables of cells and of boundaries, and the JSON file of a group of maps; ResultError if nothing was probed."""
    folder = Path(folder)
    several = [found for found in (collect(one, results, full) for one in names) if found.rows]
    if not several:
        raise ResultError(name, "no case has been probed", "run `make charts`")
    folder.mkdir(parents=True, exist_ok=True)
    figures, origin = [], provenance(several, full)
    for found in several:
        file = f"map_{found.name}.png"
        maps_draw.draw(found, theory, folder / file, style.short(*found.commits) if len(found.commits) == 1 else f"{len(found.commits)} DIFFERENT COMMITS")
        figures.append({"file": file, "title": f"{found.map.title}. {found.map.question}"})
        tables.write_csv(folder / f"map_{found.name}.csv", found.rows)
    tables.write_csv(folder / f"{name}.csv", [row for found in several for row in boundary_rows(found)])
    findings = {"chart": name, "title": title, "question": question, "answer": " ".join(map(answer, several)), "figures": figures}
    (folder / f"{name}.json").write_text(json.dumps(findings | origin, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def provenance(several, full):
    """What was run, as plain data for JSON."""
    rows = [row for found in several for row in found.rows]
    failed = sum(row["reason"] in ("crashed", "timed out") for row in rows)
    return {"extent": "full" if full else "quick", "runs_finished": len(rows) - failed, "runs_failed": failed,
            "runs_missing": sum(len(found.missing) for found in several), "computing_seconds": round(sum(row["seconds"] for row in rows), 1),
            "commits": sorted({commit for found in several for commit in found.commits}), "processor": tables.processor(),
            "yade": sorted({row["yade"] for row in rows} - {""}), "python": platform.python_version(), "numpy": np.__version__,
            "matplotlib": matplotlib.__version__, "run_command": "make charts" + " FULL=1" * full,
            "figure_command": "/usr/bin/python3 -m analysis charts" + " --full" * full}
