"""Where a chart comes from: plain data for its JSON file, and the line at the foot of its figures."""

import json
import platform
from pathlib import Path

import h5py
import matplotlib
import numpy as np

from analysis import style
from analysis.style import plt


def provenance(records, full):
    """What was run, of records that hold status, seconds (a list), git_commit, processor and, unless YADE crashed, yade_version."""
    failed = sum(record["status"] != "finished" for record in records)
    return {
        "extent": "full" if full else "quick", "runs_finished": len(records) - failed, "runs_failed": failed,
        "computing_seconds": round(sum(sum(record.get("seconds") or ()) for record in records), 1),
        "commits": sorted({record["git_commit"] for record in records}), "processor": ", ".join(sorted({record["processor"] for record in records})),
        "yade": sorted({record["yade_version"] for record in records if "yade_version" in record}),
        "python": platform.python_version(), "numpy": np.__version__, "h5py": h5py.__version__, "matplotlib": matplotlib.__version__,
        "run_command": "make charts" + " FULL=1" * full, "figure_command": "/usr/bin/python3 -m analysis charts" + " --full" * full,
    }


def write(name, folder, findings, records, full):
    """The JSON file of a chart: its findings and its provenance."""
    text = json.dumps({"chart": name} | findings | provenance(records, full), indent=1, ensure_ascii=False, allow_nan=False)
    (Path(folder) / f"{name}.json").write_text(text + "\n")


LINE = 0.155  # height of a line of the caption [inch]


def finish(fig, path, note, records):
    """Put the caption under a figure, `note` and what was run, and write it."""
    commits = {record["git_commit"] for record in records}
    code = f"commit {style.short(*commits)}" if len(commits) == 1 else f"{len(commits)} DIFFERENT COMMITS"
    failed = sum(record["status"] != "finished" for record in records)
    missed = sum(bool(record.get("unconverged_steps")) for record in records)
    missed = f"{missed} with steps that missed the tolerance, " if missed else ""
    line = (f"{len(records)} settings, {failed} of them failed, {missed}{sum(len(record.get('seconds') or ()) for record in records)} runs, {code}, "
            f"{', '.join(sorted({record['processor'] for record in records}))}")
    foot = LINE * (2.5 + note.count("\n")) / fig.get_figheight()
    fig.set_layout_engine("constrained", rect=(0, foot, 1, 1 - foot))
    fig.text(0.5, 0.012, f"{note}\n{line}", ha="center", va="bottom", fontsize=7.5, linespacing=1.4)
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    fig.savefig(path, dpi=min(plt.rcParams["savefig.dpi"], 2000 / fig.get_figwidth()),
                metadata={"Description": line} if Path(path).suffix == ".png" else None)
    plt.close(fig)
