"""Charts of speed against accuracy and maps of stability, drawn from the measurements in results/ or from published tables.

A chart is a module with TITLE, QUESTION, ANSWER, numbers(table) and GIVEN, as in a study, and

    rows(measured)            returns the rows of its table, from the measured settings (table.py) or, for the maps, from the folder of results
    draw(rows, folder, line)  draws its figures and returns {file name: title}. line: where the rows come from, for the caption

Accuracy is a relative error: |measured - exact| over a scale that the scene gives, and the largest over the scene's known quantities.
"""
import importlib
from pathlib import Path

from analysis import publish
from yade_scripts.results import provenance
from yade_scripts.results.reader import ResultError

# Order in the report.
ORDER = ("by_kind", "profile", "cost_against_size", "work_precision", "maps")
FOLDER = "charts"  # below the folder of the studies' figures


def module(name):
    return importlib.import_module(f"{__name__}.{name}")


def publish_all(results, folder, full):
    """Publish every chart that has measurements. Return {name: message} of those that have none."""
    from analysis.charts import maps, table
    folder, left = Path(folder), {}
    folder.mkdir(parents=True, exist_ok=True)
    try:
        settings, origin = table.measured(results, full)
        for name in ORDER[:-1]:
            if len(rows := module(name).rows(settings)):
                _publish(name, rows, folder, origin)
            else:
                left[name] = f"{name}: no scene was measured by both methods or at several sizes"
    except ResultError as error:
        left |= {name: f"{name}: {error}" for name in ORDER[:-1]}
    try:
        found, origin = maps.measured(results, full)
        _publish("maps", found, folder, origin)
    except ResultError as error:
        left["maps"] = f"maps: {error}"
    return left


def _publish(name, rows, folder, origin):
    chart, line = module(name), source(origin)
    figures = chart.draw(rows, folder, line)
    publish.write_table(folder / f"{name}.csv", chart.boundaries(rows) if hasattr(chart, "boundaries") else rows)
    publish.write_json(folder / f"{name}.json", {"chart": name, "figures": figures} | origin)


def origin_of(facts, full):
    """Return where measurements come from, as plain data. facts: the facts of each measurement."""
    return {"extent": "full" if full else "quick", "measured": len(facts), "commits": sorted({one["git_commit"] for one in facts}),
            "yade": sorted({one["yade_version"] for one in facts if "yade_version" in one}), "run_command": "make charts" + " FULL=1" * full} | publish.machine() | {
                "processor": ", ".join(sorted({one["processor"] for one in facts}))}


def source(origin):
    """Return the same as a line for a caption."""
    return f"{origin['measured']} measurements, {provenance.words(origin['commits'])}, {origin['processor']}"
