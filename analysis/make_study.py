"""Runs the rows of studies and draws each study as soon as the last of its rows has ended: `make study`."""
import sys
from pathlib import Path

from analysis import publish, studies
from yade_scripts import batch, commands, results
from yade_scripts.running import locks


def run(names, full, folder, figures, jobs, hours):
    """Run and draw the studies. Return 0, or 1 if a row failed or a figure could not be drawn."""
    rows = {name: [results.path_of(row, folder) for row in studies.rows(name, full)] for name in names}
    left, drawn, failed_figures = {name: set(paths) for name, paths in rows.items()}, [], []

    def ended(path):
        for name in [name for name, paths in left.items() if path in paths]:
            left[name].discard(path)
            if not left[name]:
                del left[name]
                draw(name)

    def draw(name):
        with locks.held(Path(folder) / f"figure of {name}"):
            fault = publish.publish_all([name], figures, folder, full).get(name)
        if fault:
            print(f"study: no figure of {name}: {fault}", file=sys.stderr)
            failed_figures.append(name)
        else:
            drawn.append(Path(figures) / f"{name}.png")
            print(drawn[-1].resolve(), flush=True)

    try:
        queue = batch.jobs_of([row for name in names for row in studies.module(name).ROWS["full" if full else "quick"]], folder)
        print(f"{', '.join(names)}: ", end="")
        failed = batch.work_off(queue, jobs, ended, hours)
    except OSError as error:
        print(f"study: {error}: finished runs are kept; {commands.cure(error)} and give the same command again.", file=sys.stderr)
        return 1
    if drawn:
        print("Figures:\n  " + "\n  ".join(str(path.resolve()) for path in drawn) + "\nOne page of all: make report" + " FULL=1" * full)
    return 1 if failed or failed_figures else 0
