"""Charts of speed against accuracy and maps of stability, drawn from the measurements in results/ or from published tables.

A chart is a module with TITLE and QUESTION, and beside it NAME.md.j2, its findings, as in a study. It has

    rows(measured)            returns the rows of its table, from the measured settings (table.py) or maps (maps.py)
    draw(rows, folder, line)  draws its figures and returns {file name: title}. line: where the rows come from, for the caption

It may have quantities(table), as a study, and LACKING: why measurements give no row. The module `maps` draws the measured maps themselves,
since its table has their boundaries only.
Accuracy is a relative error: |measured - exact| over a scale that the scene gives, and the largest over the scene's known quantities.
"""
from pathlib import Path

from analysis import publish
from yade_scripts import declared

# Order in the report.
ORDER = ("by_kind", "profile", "cost_against_size", "work_precision", "maps")
FOLDER = "charts"  # below the folder of the studies' figures


def module(name):
    text = Path(__file__).with_name(f"{name}.md.j2").read_text(encoding="utf-8")
    return declared.load(__name__, name, ("TITLE", "QUESTION", "rows", "draw"),
                         {"ANSWER": text, "quantities": lambda table: {}, "LACKING": "no measurement belongs in it"})


def entries(panels):
    """Return {label: what was drawn} for a legend of several panels."""
    return {label: handle for axes in panels for handle, label in zip(*axes.get_legend_handles_labels())}


def origin_of(facts, full):
    """Return where measurements come from, as plain data. facts: the facts of each measurement."""
    commits, yade, processors = (sorted({one[name] for one in facts if name in one}) for name in ("git_commit", "yade_version", "processor"))
    return {"extent": "full" if full else "quick", "measured": len(facts), "commits": commits, "yade": yade,
            "run_command": "make charts" + " FULL=1" * full} | publish.machine() | {"processor": ", ".join(processors)}
